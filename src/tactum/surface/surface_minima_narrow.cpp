/// The tests of surface_minima_lanes.h for any processor, and the table of both builds.

#include "tactum/surface/surface_minima_kernels.h"

namespace tactum::inline v0_1::lanes {

extern const Kernels* const kWide;  // surface_minima_wide.cpp

namespace {

constexpr Kernels kNarrow = KernelsOf<4>::table();

}  // namespace

CpuBuilds<Kernels> builds() noexcept { return {&kNarrow, kWide}; }

}  // namespace tactum::inline v0_1::lanes
