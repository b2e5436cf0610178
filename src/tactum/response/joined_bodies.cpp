#include "tactum/response/joined_bodies.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tactum/dynamics/spin.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Calls visit(body, parent) from the ends of all chains to their beginnings, then back.
template <class Visit>
void there_and_back(const World& world, const Visit& visit) {
  const std::vector<PairJoint>& pairs = world.pair_joints;
  for (Index i = pairs.size(); i-- > 0;) visit(Index(pairs[i].body), Index(pairs[i].parent));
  for (const PairJoint& pair : pairs) visit(Index(pair.body), Index(pair.parent));
}

/// The body at the beginning of a chain.
Index root_of(const World& world, Index body) {
  while (world.bodies[body].pair_joint >= 0)
    body = Index(world.pair_joints[Index(world.bodies[body].pair_joint)].parent);
  return body;
}

/// The farthest that the spring of a joint alone moves one of its bodies in a frame [m]. A turn moves the
/// centre of mass, too, about the joint.
double most_by_pair_spring(const MotionInput& input, const PairJoint& pair, int body,
                           const JointPosition& at) {
  const Joint& joint = pair.joint;
  if (joint.stiffness == 0.0 || (joint.kind != JointKind::kHinge && joint.kind != JointKind::kSlider))
    return 0.0;
  const double stretch = std::max(std::abs(at.now - joint.rest), std::abs(at.before - joint.rest));
  const Body& what = input.world.bodies[Index(body)];
  const double h = input.dt_s;
  if (joint.kind == JointKind::kSlider) return h * h * joint.stiffness * stretch / what.mass_kg;
  const double mobile = what.inertia_B.inverse().cwiseAbs().rowwise().sum().maxCoeff();
  return 2.0 * h * h * joint.stiffness * stretch * mobile * input.radius_m[Index(body)];
}

void begin_tree(const World& world, Index root, double dt_s, WorldState& state) {
  ContactProblem problem(0, world.bodies.size());
  for (Index i = 0; i < world.bodies.size(); ++i) {
    if (root_of(world, i) != root) continue;
    const Body& body = world.bodies[i];
    problem.add_body_and_joint(world, placed(world, state, static_cast<int>(i)), body.X_WB.p,
                               inertial_metric(body, body.X_WB, dt_s), to_vector(state.V_WB[i] * dt_s), 0.0);
  }
  if (problem.unknowns() > kMostUnknowns) return;
  problem.add_pair_joints(world, state, 0.0);
  problem.begin({});
  problem.solve_on(1);
  for (const ProblemBody& body : problem.bodies())
    state.V_WB[Index(body.body)] = to_twist(problem.displacement(body.body) / dt_s);
}

}  // namespace

void begin_joined(const World& world, double dt_s, WorldState& state) {
  for (const PairJoint& pair : world.pair_joints)
    if (world.bodies[Index(pair.parent)].pair_joint < 0) begin_tree(world, Index(pair.parent), dt_s, state);
  for (const PairJoint& pair : world.pair_joints) {
    const Vec6 rate = pair_rate(world, pair, state.X_WB);
    const Pose& X_WB = state.X_WB[Index(pair.body)];
    const Pose& X_parent = state.X_WB[Index(pair.parent)];
    const Twist& V_parent = state.V_WB[Index(pair.parent)];
    const Twist& V = state.V_WB[Index(pair.body)];
    const Twist apart{V.v - velocity_at(V_parent, X_WB.p - X_parent.p), V.w - V_parent.w};
    JointPosition& joint = state.joints[Index(pair.body)];
    joint.before = joint.now - dt_s * rate.dot(to_vector(apart));
  }
}

Vec3 change_of_axis(const ConstraintStep& step, std::size_t body) noexcept {
  const Body& what = step.world.bodies[body];
  if (what.joint.kind != JointKind::kFree || is_grasped(step, body)) return Vec3::Zero();
  const FreeBodies& f = step.own.free;
  const Vec3 pushed = step.bodies.V_WB[body].w - f.w_free[body];
  const Mat3& R_WB = step.X_WB_start[body].R;
  const auto midway = [&](const Vec3& w) { return rate_midway(what.inertia_B, R_WB, w, step.dt_s); };
  return midway(f.w_start[body] + pushed) - midway(f.w_start[body]) - pushed;
}

void join_trial(ConstraintStep& step) noexcept {
  std::vector<Pose>& X_WB = step.own.constraint.trial.X_WB;
  for (const PairJoint& pair : step.world.pair_joints) {
    const Index body = Index(pair.body);
    const Pose& before = step.bodies.X_WB[body];
    const Pose& parent = X_WB[Index(pair.parent)];
    const Pose& parent_before = step.bodies.X_WB[Index(pair.parent)];
    const bool stays = X_WB[body].p == before.p && X_WB[body].R == before.R && parent.p == parent_before.p &&
                       parent.R == parent_before.R;
    if (stays) continue;
    const Pose joined = joined_pose(step.world, pair, X_WB);
    if (joined.finite()) X_WB[body] = joined;
  }
}

void cut_together(ConstraintStep& step) noexcept {
  FreeBodies& f = step.own.free;
  there_and_back(step.world, [&](Index body, Index parent) {
    f.share[body] = f.share[parent] = std::min(f.share[body], f.share[parent]);
    f.cut[body] = f.cut[parent] = f.cut[body] != 0 || f.cut[parent] != 0 ? 1 : 0;
  });
}

void bound_joined(const MotionInput& input, const WorldState& bodies,
                  std::vector<double>& motion_bound) noexcept {
  const World& world = input.world;
  if (world.pair_joints.empty()) return;
  for (const PairJoint& pair : world.pair_joints)
    for (const int body : {pair.body, pair.parent})
      motion_bound[Index(body)] += most_by_pair_spring(input, pair, body, bodies.joints[Index(pair.body)]);
  there_and_back(world, [&](Index body, Index parent) {
    motion_bound[body] = motion_bound[parent] = std::max(motion_bound[body], motion_bound[parent]);
  });
  for (Index i = 0; i < motion_bound.size(); ++i) {
    const auto is_parent = [&](const PairJoint& pair) { return pair.parent == static_cast<int>(i); };
    if (world.bodies[i].pair_joint >= 0 ||
        std::any_of(world.pair_joints.begin(), world.pair_joints.end(), is_parent))
      motion_bound[i] *= 2.0;
  }
}

void wait_together(ConstraintStep& step) noexcept {
  std::vector<char>& waits = step.own.waiting.waits;
  there_and_back(step.world, [&](Index body, Index parent) {
    const char both = waits[body] != 0 || waits[parent] != 0 ? 1 : 0;
    waits[body] = waits[parent] = both;
  });
  if (step.world.pair_joints.empty()) return;
  for (const HandInput& hand : step.hands) {
    if (hand.grasped.body < 0) continue;
    const Index root = root_of(step.world, Index(hand.grasped.body));
    for (Index i = 0; i < waits.size(); ++i)
      if (step.own.free.joined[i] && root_of(step.world, i) == root) waits[i] = 0;
  }
}

}  // namespace tactum::inline v0_1
