#include "tactum/response/momentum.h"

#include "tactum/response/constraint_rows.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Adds the impulses of contacts and friction on the bodies of the grasped part's island.
void give_by_island(ConstraintStep& step) {
  const ConstraintState& c = step.own.constraint;
  Momentum& momentum = step.own.free.momentum;
  const RowsInProblem contacts{own_rows(step), c.rows.first};
  for (const QpActive& active : c.problem.answer().active)
    if (const ContactRow* const row = contacts.row(active.row))
      momentum.give(row->body_a, row->body_b, active.multiplier * step.dt_s * row->n_BA_W);
  c.friction.for_each_force(c.problem, [&](Index patch, const Push& push, double multiplier) {
    const SurfacePair& bodies = c.friction.patches()[patch].surfaces;
    momentum.give(bodies.body_a, bodies.body_b, multiplier * step.dt_s * push.force);
  });
}

}  // namespace

void begin_balance(ConstraintStep& step) noexcept {
  if (!step.own.free.others) return;
  Momentum& momentum = step.own.free.momentum;
  momentum.due_Ns.setZero();
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    const Body& body = step.world.bodies[i];
    const int number = static_cast<int>(i);
    const bool counts = body.moves() && body.joint.kind == JointKind::kFree && !body.load.damps() &&
                        !step.own.free.joined[i] && !is_grasped(step, i) &&
                        step.own.free.islands.moves(number);
    momentum.counts[i] = counts ? 1 : 0;
    if (counts)
      momentum.due_Ns += body.mass_kg * (step.bodies.V_WB[i].v + 0.5 * step.dt_s * step.world.gravity_W) +
                         0.5 * step.dt_s * body.load.constant.f;
  }
}

void end_balance(bool as_forced, ConstraintStep& step) noexcept {
  if (!step.own.free.others) return;
  Momentum& momentum = step.own.free.momentum;
  bool near_grasped = false;
  if (step.own.free.grasped_island >= 0 && !step.grasped_yields) {
    give_by_island(step);
    for (Index i = 0; i < step.world.bodies.size(); ++i)
      near_grasped |= momentum.counts[i] && step.own.free.near_grasped[i];
  }
  for (const Vec3& given_Ns : step.own.free.given_Ns) momentum.due_Ns += given_Ns;
  Vec3 now = Vec3::Zero();
  for (Index i = 0; i < step.world.bodies.size(); ++i)
    if (momentum.counts[i]) now += step.world.bodies[i].mass_kg * step.bodies.V_WB[i].v;
  step.report.momentum_off_Ns = (now - momentum.due_Ns).norm();
  step.report.forced_short = step.report.cut_short > 0 || (near_grasped && !as_forced);
}

}  // namespace tactum::inline v0_1
