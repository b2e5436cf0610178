#include "tactum/response/momentum.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// What contacts and friction gave the bodies of the held part's island.
void give_by_island(ConstraintStep& step) {
  const ConstraintState& c = step.own.constraint;
  for (const QpActive& active : c.problem.answer().active) {
    const Index row = Index(active.row);
    if (row < c.rows.first) continue;
    const double impulse = active.multiplier * step.dt_s;
    if (row - c.rows.first < c.rows.own) {
      const ContactRow& contact = step.own.contact_rows.rows[row - c.rows.first];
      step.own.free.momentum.give(contact.body_a, contact.body_b, impulse * contact.n_BA_W);
      continue;
    }
    for (const FrictionPatch& patch : c.friction.patches())
      if (row >= patch.first_row && row < patch.first_row + Friction::kRowsAPatch)
        step.own.free.momentum.give(patch.key.body_a, patch.key.body_b,
                                    impulse * cone_edge(patch, row - patch.first_row).force);
  }
}

}  // namespace

void begin_balance(ConstraintStep& step) noexcept {
  if (!step.own.free.others) return;
  Momentum& momentum = step.own.free.momentum;
  momentum.due_Ns.setZero();
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    const Body& body = step.world.bodies[i];
    const int number = static_cast<int>(i);
    const bool counts = body.moves() && body.joint.kind == JointKind::kFree && number != step.grasped.body &&
                        step.own.free.islands.moves(number);
    momentum.counts[i] = counts ? 1 : 0;
    if (counts)
      momentum.due_Ns += body.mass_kg * (step.bodies.V_WB[i].v + 0.5 * step.dt_s * step.world.gravity_W);
  }
}

void end_balance(bool as_forced, ConstraintStep& step) noexcept {
  if (!step.own.free.others) return;
  Momentum& momentum = step.own.free.momentum;
  bool near_grasped = false;
  if (step.own.free.grasped_island >= 0) {
    give_by_island(step);
    for (Index i = 0; i < step.world.bodies.size(); ++i)
      near_grasped |= momentum.counts[i] && step.own.free.near_grasped[i];
  }
  Vec3 now = Vec3::Zero();
  for (Index i = 0; i < step.world.bodies.size(); ++i)
    if (momentum.counts[i]) now += step.world.bodies[i].mass_kg * step.bodies.V_WB[i].v;
  step.report.momentum_off_Ns = (now - momentum.due_Ns).norm();
  step.report.forced_short = step.report.cut_short > 0 || (near_grasped && !as_forced);
}

}  // namespace tactum
