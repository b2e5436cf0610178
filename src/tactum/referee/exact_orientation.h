#pragma once
/// On which side of a plane through three points a fourth one lies: the sign of a determinant, exact for any
/// doubles [Shewchuk 1997]. A floating-point value decides where it exceeds its error bound; else the
/// determinant is summed up without rounding.

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// 1 where a, b, c run counter-clockwise as seen from d, that is (a - d) . ((b - d) x (c - d)) > 0; -1 where
/// they run clockwise; 0 where the four lie in one plane. Coordinates beyond 1e70 overflow.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace tactum::inline v0_1
