/// The tests of surface_minima_lanes.h for any processor, and the choice among them.

#include "tactum/surface/surface_minima_kernels.h"

namespace tactum::lanes {
namespace {

constexpr Kernels kNarrow = KernelsOf<4>::table();

}  // namespace

const Kernels& narrow_kernels() noexcept { return kNarrow; }

#if defined(__x86_64__)
extern const Kernels kWide;  // surface_minima_wide.cpp

const Kernels* wide_kernels() noexcept { return __builtin_cpu_supports("avx2") ? &kWide : nullptr; }
#else
const Kernels* wide_kernels() noexcept { return nullptr; }
#endif

}  // namespace tactum::lanes
