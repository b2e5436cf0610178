#include "support/allocation_guard.h"

#include <cerrno>
#include <cstdlib>

#ifdef TACTUM_SANITIZED
#include <sanitizer/allocator_interface.h>
#endif

namespace tactum {
namespace {

// Constant-initialised thread-locals of the program itself: touching them allocates nothing.
thread_local int t_guards = 0;
thread_local std::size_t t_allocations = 0;
thread_local std::size_t t_frees = 0;
bool g_abort_on_allocation = false;

void count_allocation() noexcept {
  if (t_guards == 0) return;
  ++t_allocations;
  if (g_abort_on_allocation) std::abort();
}

void count_free(const volatile void* block) noexcept {
  if (t_guards != 0 && block != nullptr) ++t_frees;
}

#ifdef TACTUM_SANITIZED
const int g_installed =
    __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { count_allocation(); },
                                              [](const volatile void* p) { count_free(p); });
#endif

}  // namespace

AllocationGuard::AllocationGuard() noexcept : allocations_before_(t_allocations), frees_before_(t_frees) {
  g_abort_on_allocation = std::getenv("TACTUM_ABORT_ON_ALLOCATION") != nullptr;
  ++t_guards;
}

AllocationGuard::~AllocationGuard() { --t_guards; }

std::size_t AllocationGuard::allocations() const noexcept { return t_allocations - allocations_before_; }

std::size_t AllocationGuard::frees() const noexcept { return t_frees - frees_before_; }

}  // namespace tactum

#ifndef TACTUM_SANITIZED
// glibc keeps its own under these names for whoever replaces the public ones.
extern "C" {

void* __libc_malloc(std::size_t size) noexcept;
void* __libc_calloc(std::size_t count, std::size_t size) noexcept;
void* __libc_realloc(void* block, std::size_t size) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t size) noexcept;
void __libc_free(void* block) noexcept;

void* malloc(std::size_t size) noexcept {
  tactum::count_allocation();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  tactum::count_allocation();
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) noexcept {
  tactum::count_allocation();
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  tactum::count_allocation();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept { return memalign(alignment, size); }

int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  *block = memalign(alignment, size);
  return *block != nullptr ? 0 : ENOMEM;
}

void free(void* block) noexcept {
  tactum::count_free(block);
  __libc_free(block);
}

}  // extern "C"
#endif
