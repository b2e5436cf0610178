#include "tactum/response/response.h"

namespace tactum::inline v0_1 {
namespace {

using Model = std::variant<PenaltyResponse, ConstraintResponse>;

Model make_model(const World& world, const FrameSettings& settings, WorldState& bodies) {
  if (settings.response == ResponseModel::kConstraint)
    return Model(std::in_place_type<ConstraintResponse>, world, settings, bodies);
  return Model(std::in_place_type<PenaltyResponse>, world, settings, bodies);
}

/// A body whose motion is not a number stays where it was, at rest: one bad frame must not be the last good
/// one.
void undo_non_finite(const World& world, std::span<const Pose> X_WB_start, WorldState& bodies,
                     FrameReport& report) {
  for (std::size_t i = 0; i < bodies.X_WB.size(); ++i) {
    if (!world.bodies[i].moves() || (bodies.X_WB[i].finite() && bodies.V_WB[i].finite())) continue;
    bodies.X_WB[i] = X_WB_start[i];
    bodies.V_WB[i] = {};
    report.flags |= frame_flag::kMotionUndone;
  }
}

}  // namespace

Response::Response(const World& world, const FrameSettings& settings, WorldState& bodies)
    : model_(make_model(world, settings, bodies)) {}

PatchPoints Response::points() const noexcept {
  return std::visit([](const auto& model) { return model.kPoints; }, model_);
}

std::span<const double> Response::bound_motion(const MotionInput& input, WorldState& bodies) noexcept {
  return std::visit([&](auto& model) { return model.bound_motion(input, bodies); }, model_);
}

void Response::step(const StepInput& input, GapOracle& gaps, WorldState& bodies, FrameReport& report,
                    std::span<HandReport> others) noexcept {
  std::visit(
      [&](auto& model) {
        model.step(input, gaps, bodies, report, others);
        if (model.rows_full()) report.flags |= frame_flag::kPointsFull;
        if (gaps.capacity_reached()) report.flags |= frame_flag::kCapacityReached;
      },
      model_);
  undo_non_finite(input.world, input.X_WB_start, bodies, report);
  follow_joints(input.world, bodies);
}

Wrench Response::felt(const StepInput& input, const PlacedHandle& handle, std::size_t hand) noexcept {
  return std::visit([&](auto& model) { return model.felt(input, handle, hand); }, model_);
}

Wrench Response::coupled(std::size_t hand) const noexcept {
  return std::visit([hand](const auto& model) { return model.coupled(hand); }, model_);
}

std::span<const ContactRow> Response::rows() const noexcept {
  return std::visit([](const auto& model) { return model.rows(); }, model_);
}

std::span<const FrictionUse> Response::friction_uses() const noexcept {
  const ConstraintResponse* const model = constraint();
  return model != nullptr ? model->friction_uses() : std::span<const FrictionUse>{};
}

double Response::stored_J(std::size_t hand) const noexcept {
  return std::visit([hand](const auto& model) { return model.stored_J(hand); }, model_);
}

}  // namespace tactum::inline v0_1
