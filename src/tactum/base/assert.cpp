#include "tactum/base/assert.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace tactum::inline v0_1 {
namespace {

std::atomic<ZeroWrenchHook> g_hook{nullptr};
std::atomic<void*> g_context{nullptr};

}  // namespace

void set_zero_wrench_hook(ZeroWrenchHook hook, void* context) noexcept {
  g_hook.store(nullptr);  // never the new hook with the old context
  g_context.store(context);
  g_hook.store(hook);
}

void assertion_failed(const char* condition, const char* file, int line) noexcept {
  if (ZeroWrenchHook hook = g_hook.exchange(nullptr)) hook(g_context.load());
  std::fprintf(stderr, "tactum: assertion failed: %s (%s:%d)\n", condition, file, line);
  std::abort();
}

}  // namespace tactum::inline v0_1
