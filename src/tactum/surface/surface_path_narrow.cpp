/// The tests of surface_path_lanes.h for any processor, and the table of both builds.

#include "tactum/surface/surface_path_kernels.h"

namespace tactum::inline v0_1::lanes {

extern const PathKernels* const kWidePath;  // surface_path_wide.cpp

namespace {

constexpr PathKernels kNarrowPath = PathKernelsOf<4>::table();

}  // namespace

CpuBuilds<PathKernels> path_builds() noexcept { return {&kNarrowPath, kWidePath}; }

}  // namespace tactum::inline v0_1::lanes
