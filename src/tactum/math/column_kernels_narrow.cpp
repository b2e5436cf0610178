/// The loops of column_kernels.h for any processor, and the choice among them.

#include "tactum/math/column_kernels_of.h"

namespace tactum::columns {
namespace {

constexpr Kernels kNarrow = KernelsOf<2>::table();

}  // namespace

const Kernels& narrow_kernels() noexcept { return kNarrow; }

#if defined(__x86_64__)
extern const Kernels kWide;  // column_kernels_wide.cpp

const Kernels* wide_kernels() noexcept { return __builtin_cpu_supports("avx2") ? &kWide : nullptr; }
#else
const Kernels* wide_kernels() noexcept { return nullptr; }
#endif

}  // namespace tactum::columns
