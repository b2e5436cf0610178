#include "tactum/base/cpu_dispatch.h"

namespace tactum::inline v0_1 {

bool cpu_has_avx2() noexcept {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace tactum::inline v0_1
