/// The loops of column_kernels.h for processors with AVX2; compiled for them where the program is built for
/// x86-64 (CMakeLists.txt), empty elsewhere.

#include "tactum/math/column_kernels_of.h"

#ifdef __AVX2__

namespace tactum::columns {

extern const Kernels kWide;
constinit const Kernels kWide = KernelsOf<4>::table();

}  // namespace tactum::columns

#endif
