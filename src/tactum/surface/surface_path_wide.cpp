/// The tests of surface_path_lanes.h for processors with AVX2; compiled for them where the program is built
/// for x86-64 (CMakeLists.txt), none elsewhere.

#include "tactum/surface/surface_path_kernels.h"

namespace tactum::inline v0_1::lanes {

extern const PathKernels* const kWidePath;

#ifdef __AVX2__
namespace {

constexpr PathKernels kPathTable = PathKernelsOf<8>::table();

}  // namespace

constinit const PathKernels* const kWidePath = &kPathTable;
#else
constinit const PathKernels* const kWidePath = nullptr;
#endif

}  // namespace tactum::inline v0_1::lanes
