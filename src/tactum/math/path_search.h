#pragma once
/// How far along a motion two convex things surely stay apart: the search that convex_path.h and
/// surface_path.h share.
///
///   Fix a direction n in A's frame. A point of B that turns about its pivot has the height h(s) along n with
///   |h''| <= c (relative_motion.h), so between two fractions s and e of the motion it is no lower than the
///   chord less c (e - s)^2 / 8. If the gap along n is larger than that at both ends, nothing touches between
///   them. The normals at s and at e are tried; where neither proves it, e is halved towards s.
///
/// Where B hardly turns, gaps above zero at both ends are enough: the motion on lines is only one of those
/// that lead from the one pose to the other, and one that rises along n on its way touches nothing. The
/// direction may then be one that turns with B as well, as the normal of a face of B does, or another one at
/// the end than at the start, as where an edge is passed, as long as both rise: what is passed through is
/// left on the other side.

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// So little turns a body that its motion may rise instead of going on a line [rad].
inline constexpr double kHardlyTurns = 0.05;

/// Directions whose cosine is larger lie on one side.
inline constexpr double kOneSide = 0.5;

/// A fraction of a motion up to which, from its start, a pair is apart; `most` where it is so up to there. It
/// is 0 for a pair that touches at the start. In at most `tests` tests of an interval. Of `Pair`:
///   Vec3 direction(double s)            unit n_BA in A's frame, along which they are apart; zero: they touch
///   double gap(const Vec3& n, double s) the gap along n
///   double turn()                       how far B turns in the whole motion [rad]
///   Vec3 turned(const Vec3& n, double from, double to) n after it has turned with B
///   double curving(const Vec3& n)       a bound of |h''| along n for every point
template <class Pair>
double path_free_until(Pair& pair, double most, int tests) noexcept {
  // Along a direction of the pair at `here`, on the stretch to `there`, which may lie before it.
  const auto apart = [&](const Vec3& n, double here, double there) {
    const double length = std::abs(there - here);
    const bool hardly_turns = pair.turn() * length <= kHardlyTurns;
    const double needed = hardly_turns ? 0.0 : pair.curving(n) * length * length / 8.0;
    if (!(pair.gap(n, here) > needed)) return false;
    return pair.gap(n, there) > needed ||
           (hardly_turns && pair.gap(pair.turned(n, here, there), there) > 0.0);
  };
  double free = 0.0;
  double step = most;
  Vec3 n = pair.direction(free);
  while (!n.isZero(0.0) && step >= tolerances::kPathEnd * most && tests-- > 0) {
    const double to = std::min(free + step, most);
    if (!apart(n, free, to)) {
      const Vec3 before = n;
      n = pair.direction(to);
      const bool one_side = pair.turn() * step <= kHardlyTurns && before.dot(n) > kOneSide;
      if (n.isZero(0.0) || !(one_side || apart(n, to, free))) {
        step = 0.5 * (to - free);
        n = pair.direction(free);
        continue;
      }
    }
    if (to == most) return most;
    free = to;
    step *= 2.0;
    n = pair.direction(free);
  }
  return free;
}

}  // namespace tactum::inline v0_1
