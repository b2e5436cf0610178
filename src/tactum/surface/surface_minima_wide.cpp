/// The tests of surface_minima_lanes.h for processors with AVX2; compiled for them where the program is built
/// for x86-64 (CMakeLists.txt), none elsewhere.

#include "tactum/surface/surface_minima_kernels.h"

namespace tactum::inline v0_1::lanes {

extern const Kernels* const kWide;

#ifdef __AVX2__
namespace {

constexpr Kernels kTable = KernelsOf<8>::table();

}  // namespace

constinit const Kernels* const kWide = &kTable;
#else
constinit const Kernels* const kWide = nullptr;
#endif

}  // namespace tactum::inline v0_1::lanes
