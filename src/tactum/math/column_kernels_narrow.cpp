/// The loops of column_kernels.h for any processor, and the table of both builds.

#include "tactum/math/column_kernels_of.h"

namespace tactum::inline v0_1::columns {

extern const Kernels* const kWide;  // column_kernels_wide.cpp

namespace {

constexpr Kernels kNarrow = KernelsOf<2>::table();

}  // namespace

CpuBuilds<Kernels> builds() noexcept { return {&kNarrow, kWide}; }

}  // namespace tactum::inline v0_1::columns
