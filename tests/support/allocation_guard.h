#pragma once
/// Counts the allocations of this thread while the guard lives, whoever makes them: new, malloc, a library.
///
///   AllocationGuard guard;
///   for (int i = 0; i < 10000; ++i) run_frame(...);
///   EXPECT_EQ(guard.allocations(), 0u);
///
/// Do not let a test macro run between the guard and the question: a failing one allocates. To find the
/// place, run the test in a debugger with TACTUM_ABORT_ON_ALLOCATION=1: the first counted allocation aborts.
/// Plain builds replace malloc and its kin in the test program, sanitized ones use the sanitizer's hooks.

#include <cstddef>

namespace tactum {

class AllocationGuard {
 public:
  AllocationGuard() noexcept;
  ~AllocationGuard();
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;

  std::size_t allocations() const noexcept;  ///< by this thread since construction
  std::size_t frees() const noexcept;        ///< by this thread since construction; free(nullptr) is none

 private:
  std::size_t allocations_before_;
  std::size_t frees_before_;
};

}  // namespace tactum
