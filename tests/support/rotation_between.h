#pragma once
/// A rotation between two directions. It is compiled once: Eigen's function has a singular value
/// decomposition behind it, which takes two seconds to compile in every file that calls it.

#include "tactum/math/types.h"

namespace tactum::testing {

/// The smallest rotation that takes unit `from` to unit `to`.
Mat3 rotation_between(const Vec3& from, const Vec3& to);

}  // namespace tactum::testing
