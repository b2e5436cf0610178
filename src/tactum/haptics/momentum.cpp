#include "tactum/haptics/momentum.h"

#include "tactum/haptics/frame_state.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// What contacts and friction gave the bodies of the held part's island.
void give_by_island(double dt_s, FrameState& state) {
  const ConstraintState& c = state.constraint;
  for (const QpActive& active : c.problem.answer().active) {
    const Index row = Index(active.row);
    if (row < c.first_row) continue;
    const double impulse = active.multiplier * dt_s;
    if (row - c.first_row < c.own_rows) {
      const ContactRow& contact = state.contacts.rows[row - c.first_row];
      state.free.momentum.give(contact.body_a, contact.body_b, impulse * contact.n_BA_W);
      continue;
    }
    for (const FrictionPatch& patch : c.friction.patches())
      if (row >= patch.first_row && row < patch.first_row + Friction::kRowsAPatch)
        state.free.momentum.give(patch.key.body_a, patch.key.body_b,
                                 impulse * cone_edge(patch, row - patch.first_row).force);
  }
}

}  // namespace

void begin_balance(const World& world, double dt_s, FrameState& state) noexcept {
  if (!state.free.others) return;
  Momentum& momentum = state.free.momentum;
  momentum.due_Ns.setZero();
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    const int number = static_cast<int>(i);
    const bool counts = body.moves() && body.joint.kind == JointKind::kFree && number != state.tool.body &&
                        state.free.islands.moves(number);
    momentum.counts[i] = counts ? 1 : 0;
    if (counts) momentum.due_Ns += body.mass_kg * (state.world.V_WB[i].v + 0.5 * dt_s * world.gravity_W);
  }
}

void end_balance(const World& world, double dt_s, bool as_forced, FrameState& state,
                 FrameReport& report) noexcept {
  if (!state.free.others) return;
  Momentum& momentum = state.free.momentum;
  bool near_held = false;
  if (state.free.held_island >= 0) {
    give_by_island(dt_s, state);
    for (Index i = 0; i < world.bodies.size(); ++i)
      near_held |= momentum.counts[i] && state.free.near_held[i];
  }
  Vec3 now = Vec3::Zero();
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (momentum.counts[i]) now += world.bodies[i].mass_kg * state.world.V_WB[i].v;
  report.momentum_off_Ns = (now - momentum.due_Ns).norm();
  report.forced_short = report.cut_short > 0 || (near_held && !as_forced);
}

}  // namespace tactum
