/// The tests of surface_minima_lanes.h for processors with AVX2; compiled for them where the program is built
/// for x86-64 (CMakeLists.txt), empty elsewhere.

#include "tactum/surface/surface_minima_kernels.h"

#ifdef __AVX2__

namespace tactum::lanes {

extern const Kernels kWide;
constinit const Kernels kWide = KernelsOf<8>::table();

}  // namespace tactum::lanes

#endif
