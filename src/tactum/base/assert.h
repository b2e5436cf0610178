#pragma once
/// Assertions for our own mistakes. A failed assertion first calls the zero-wrench hook, so that a device in
/// a hand goes limp before the program stops.
///
///   TACTUM_DEMAND(cond)   checked in every build: cheap, and wrong forces would follow if it failed
///   TACTUM_ASSERT(cond)   checked in debug builds only: on the frame's path

namespace tactum::inline v0_1 {

/// Called once, with `context`, before the program stops on a failed assertion. Must not allocate or throw.
using ZeroWrenchHook = void (*)(void* context) noexcept;

/// Sets the hook and returns nothing; pass nullptr to remove it. The loop sets it while a device is open.
void set_zero_wrench_hook(ZeroWrenchHook hook, void* context) noexcept;

/// Calls the hook (if any), writes the place to stderr and aborts.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line) noexcept;

}  // namespace tactum::inline v0_1

#define TACTUM_DEMAND(condition) \
  ((condition) ? static_cast<void>(0) : ::tactum::assertion_failed(#condition, __FILE__, __LINE__))

#ifdef NDEBUG
#define TACTUM_ASSERT(condition) static_cast<void>(0)
#else
#define TACTUM_ASSERT(condition) TACTUM_DEMAND(condition)
#endif
