#include "tactum/response/sleep.h"

#include <algorithm>
#include <limits>

#include "tactum/base/frame_rate.h"
#include "tactum/dynamics/body_load.h"
#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

constexpr double kStill_s = 0.06;
/// No point has moved farther in that time than this fraction of the skin: some nanometres.
constexpr double kStillShare = 0.01;

/// A body that touches nothing is in balance when weight and load give it less than this fraction of the
/// speed of free fall: a hundred times what rounding leaves of an arm that hangs.
constexpr double kBalanced = 100.0 * std::numeric_limits<double>::epsilon();

void count_touches(ConstraintStep& step) {
  Sleep& s = step.own.sleep;
  s.touches.swap(s.touched);
  std::fill(s.touches.begin(), s.touches.end(), 0);
  for (const ContactPatch& patch : step.patches) {
    ++s.touches[Index(patch.body_a)];
    ++s.touches[Index(patch.body_b)];
    s.islands.join(patch.body_a, patch.body_b);
  }
  for (const PairJoint& pair : step.world.pair_joints) s.islands.join(pair.body, pair.parent);
}

/// Whether a body that touches nothing is in balance: the velocities of a frame have half a frame's weight
/// and load so far. What gains speed slowly has hardly moved in the time that decides about sleep.
bool is_balanced(const ConstraintStep& step, Index body) {
  if (step.world.bodies[body].joint.friction > 0.0) return true;  // that holds it, or it would have moved
  const Twist& V = step.bodies.V_WB[body];
  const Twist by_load = most_by_load(step.world.bodies[body], step.bodies.X_WB[body], step.dt_s);
  const double gained = step.world.gravity_W.norm() * step.dt_s + by_load.v.norm();
  return V.v.norm() + V.w.norm() * step.radius_m[body] <= kBalanced * gained;
}

/// Whether the body is where it was, with as many contacts, or, without any, in balance.
bool is_still(const ConstraintStep& step, Index body) {
  const Sleep& s = step.own.sleep;
  if (s.touches[body] != s.touched[body] || is_grasped(step, body)) return false;
  if (step.own.free.unconverged[body] != 0) return false;
  if (s.touches[body] == 0 && !is_balanced(step, body)) return false;
  const double most = kStillShare * step.own.constraint.skin_m[body];
  const Pose& was = s.X_still[body];
  const Pose& is = step.bodies.X_WB[body];
  const double distance = (is.p - was.p).norm();
  if (distance > most) return false;
  if (distance == 0.0 && is.R == was.R) return true;  // as for all bodies that sleep
  const Twist moved = twist_between(was, is, 1.0);
  return moved.v.norm() + moved.w.norm() * step.radius_m[body] <= most;
}

}  // namespace

void let_sleep(ConstraintStep& step) noexcept {
  Sleep& s = step.own.sleep;
  const int still_frames = frames_in(kStill_s, step.dt_s);
  std::vector<char>& waits = step.own.waiting.waits;  // no body is deferred so far
  s.islands.clear(step.world, waits);
  count_touches(step);
  std::fill(s.restless.begin(), s.restless.end(), 0);
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    if (!step.world.bodies[i].moves()) continue;
    if (is_still(step, i)) {
      s.still[i] = std::min(s.still[i] + 1, still_frames);
    } else {
      s.X_still[i] = step.bodies.X_WB[i];
      s.still[i] = 0;
    }
    if (s.still[i] < still_frames) s.restless[Index(s.islands.of(static_cast<int>(i)))] = 1;
  }
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    if (!step.world.bodies[i].moves() || s.restless[Index(s.islands.of(static_cast<int>(i)))]) continue;
    waits[i] = 1;
    step.own.waiting.V_kept[i] = step.bodies.V_WB[i] = {};
    ++step.report.asleep;
  }
}

void wake(Sleep& sleep) noexcept { std::fill(sleep.still.begin(), sleep.still.end(), 0); }

}  // namespace tactum::inline v0_1
