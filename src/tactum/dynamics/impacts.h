#pragma once
/// Impacts: what bodies do to each other in no time at all [Mirtich 1996b]. One pair of bodies after
/// the other, the fastest approach first, until none approaches faster than what rests does. So an impact
/// travels through a row of touching balls as it does through Newton's cradle, where all contacts at once
/// would share it.
///
/// Within a pair all its corners are hit together:  vn after >= -e vn before,  impulses >= 0, with Coulomb's
/// friction at each; a box that falls flat on its face leaves flat.

#include <span>

#include "tactum/dynamics/contact_row.h"
#include "tactum/dynamics/joint.h"

namespace tactum {

/// Approach slower than this is rest, not impact: a few frames' worth of gravity [m/s].
inline constexpr double kImpactSpeed = 0.03;

/// Told of every pair that is hit: `impulse` [N s] at `p_W` acts on body_a, its opposite on body_b.
class ImpactObserver {
 public:
  virtual ~ImpactObserver() = default;
  virtual void hit(int body_a, int body_b, const Vec3& impulse, const Vec3& p_W) noexcept = 0;
};

/// Changes the twists of what is hit within the next `h` seconds, from rows with distances at their start;
/// leaves the rows' impulses as they were and marks the fastest corner of every pair that was hit. At most
/// `most` pairs are hit; returns how many were. `observer` may be null.
int resolve_impacts(std::span<ContactRow> rows, std::span<const Pose> X_WB, std::span<const Mobility> W,
                    double h, int most, std::span<Twist> V, ImpactObserver* observer) noexcept;

}  // namespace tactum
