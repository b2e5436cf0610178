/// The loops of column_kernels.h for processors with AVX2; compiled for them where the program is built for
/// x86-64 (CMakeLists.txt), none elsewhere.

#include "tactum/math/column_kernels_of.h"

namespace tactum::inline v0_1::columns {

extern const Kernels* const kWide;

#ifdef __AVX2__
namespace {

constexpr Kernels kTable = KernelsOf<4>::table();

}  // namespace

constinit const Kernels* const kWide = &kTable;
#else
constinit const Kernels* const kWide = nullptr;
#endif

}  // namespace tactum::inline v0_1::columns
