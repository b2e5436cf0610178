#include "tactum/embedding/step_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactum::inline v0_1 {
namespace {

/// How far the point of a body that is at p_W at the start of the step has moved.
Vec3 moved_by(const FrameState& state, int body, const Vec3& p_W) {
  const auto b = static_cast<std::size_t>(body);
  const Pose& X_start = state.X_WB_start[b];
  return state.world.X_WB[b] * rotated_back(X_start.R, p_W - X_start.p) - p_W;
}

double residual_of(const FrameState& state, const ContactRow& row, bool pushes) {
  if (state.response.constraint() == nullptr) return std::numeric_limits<double>::quiet_NaN();
  const double opened =
      row.n_BA_W.dot(moved_by(state, row.body_a, row.p_W) - moved_by(state, row.body_b, row.p_W));
  return pushes ? std::abs(opened - row.asked) : std::max(0.0, row.asked - opened);
}

}  // namespace

void StepContacts::take(const FrameSource& frame) {
  const std::span<const ContactRow> rows = frame.state.response.rows();
  const std::span<const FrictionUse> uses = frame.state.response.friction_uses();
  shown_.reserve(rows.size());
  show_contacts(frame, rows.size(), shown_);
  contacts_.clear();
  contacts_.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ContactRow& row = rows[i];
    StepContact contact{};
    static_cast<ShownContact&>(contact) = shown_[i];
    if (row.friction_patch >= 0)
      contact.friction_N = uses[static_cast<std::size_t>(row.friction_patch)].sideways_N;
    contact.friction_coefficient = row.friction;
    contact.residual_m = residual_of(frame.state, row, row.impulse > 0.0);
    contacts_.push_back(contact);
  }
}

}  // namespace tactum::inline v0_1
