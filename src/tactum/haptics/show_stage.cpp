#include "tactum/haptics/show_stage.h"

#include <algorithm>

#include "tactum/dynamics/body_load.h"
#include "tactum/math/screw.h"
#include "tactum/response/energy.h"

namespace tactum::inline v0_1 {

void begin_reports(const FrameTick& tick, FrameState& state, FrameReport& report) noexcept {
  report = {};
  report.index = tick.index;
  std::fill(state.other_reports.begin(), state.other_reports.end(), HandReport{});
}

void report_hands(std::span<const HandInput> hands, FrameState& state, FrameReport& report) noexcept {
  for (std::size_t h = 0; h < hands.size(); ++h) {
    HandReport& own_report = report_of(h, state, report);
    own_report.grasped_body = hands[h].grasped.body;
    own_report.hold = static_cast<int>(hands[h].grasped.hold);
  }
  if (!some_known(hands)) report.flags |= frame_flag::kNoHand;
}

void add_work(const World& world, const FrameSettings& settings, std::span<const HandInput> hands,
              FrameState& state) noexcept {
  const WorldState& bodies = state.world;
  for (std::size_t h = 0; h < hands.size(); ++h) {
    HandFrameState& own = state.of_hand(h);
    add_field_work(bodies.X_WB, own.hand.field);
    const GraspedPart& grasped = hands[h].grasped;
    if (hands.size() == 1 || grasped.body < 0) continue;
    const auto body = static_cast<std::size_t>(grasped.body);
    const Twist moved =
        twist_between(state.X_WB_start[body] * grasped.X_BH, bodies.X_WB[body] * grasped.X_BH, 1.0);
    own.coupling_work_J -= power(state.response.coupled(h), moved);
  }
  state.load_work_J += work_of_loads(world, state.X_WB_start, bodies.X_WB, settings.dt_s);
}

void feel_grasp(const StepInput& step, std::size_t hand, FrameState& state, FrameReport& report) noexcept {
  const GraspedPart& grasped = step.hands[hand].grasped;
  HandReport& own_report = report_of(hand, state, report);
  HandFrameState& own = state.of_hand(hand);
  if (grasped.hand_known) own_report.X_WH = grasped.X_WH;
  if (grasped.hand_known && grasped.body >= 0) {
    own.handle = handle_at(grasped, state.world.X_WB[static_cast<std::size_t>(grasped.body)]);
    own_report.X_WH_proxy = own.handle.X_WH_proxy;
    own_report.X_WH_proxy.p += grasped.beside_W;
    own_report.field = grasped.field.at_centre;
  }
  const Wrench felt = state.response.felt(step, own.handle, hand);
  if (grasped.hand_known) own_report.coupling = felt;
}

WrenchStep explained_by_hands(const FrameSettings& settings, std::span<const double> radius_m,
                              const FrameState& state) noexcept {
  WrenchStep explained;
  for (std::size_t h = 0; h < state.hand_inputs.size(); ++h) {
    const HandSettings& own = settings.hand(h);
    const GraspedPart& grasped = state.hand_inputs[h].grasped;
    double lever_m = 0.0;  // of the farthest point that is grasped
    if (grasped.body >= 0) lever_m = radius_m[static_cast<std::size_t>(grasped.body)] + grasped.X_BH.p.norm();
    const WrenchStep by_this =
        explained_by(state.of_hand(h).handle_moved.moved, own.coupling.stiffness_N_per_m,
                     own.coupling.stiffness_Nm_per_rad, lever_m / own.workspace.scale);
    explained.force_N += by_this.force_N;
    explained.torque_Nm += by_this.torque_Nm;
  }
  return explained;
}

Wrench smooth_for_device(const HandSettings& settings, double dt_s, const WrenchStep& by_hands,
                         const Wrench& at_handle, SmoothingState& state,
                         std::uint32_t& safety_flags) noexcept {
  const Wrench within = within_limits(settings.safety, at_handle, safety_flags);
  const Wrench smoothed = smooth_wrench(settings.smoothing, dt_s, by_hands, state, within);
  return settings.port.actuates_torque ? smoothed : Wrench{smoothed.f, Vec3::Zero()};
}

StoredEnergy stored_in_scene(const World& world, const FrameSettings& settings, std::size_t hand,
                             const Wrench& felt, const FrameState& state) noexcept {
  const HandFrameState& own = state.of_hand(hand);
  const GraspedPart& grasped = state.hand_inputs[hand].grasped;
  double outside_J = 0.0;
  for (std::size_t h = 0; h < settings.hands(); ++h) {
    outside_J += state.of_hand(h).hand.field.given_J;
    if (h != hand) outside_J += state.of_hand(h).coupling_work_J;
  }
  return stored_energy({.world = world,
                        .settings = settings.hand(hand),
                        .X_WB_start = state.X_WB_start,
                        .bodies = state.world,
                        .hands = state.hand_inputs,
                        .grasped = grasped.body,
                        .to_hand = own.handle.to_hand,
                        .V_WH = grasped.V_WH,
                        .felt = felt,
                        .smoothed = own.smoothing.shown,
                        .share = own.port.booked.stiffness_share * state.hand_inputs[hand].left,
                        .outside_work_J = outside_J + state.load_work_J,
                        .response_J = state.response.stored_J(hand)});
}

PortInput port_input(double dt_s, const Wrench& wanted, const Wrench& smoothed, const StoredEnergy& stored,
                     const HandFrameState& state) noexcept {
  return {.felt = smoothed,
          .wanted = wanted,
          .sent = state.safety.sent,
          .unfelt_Nm = state.smoothing.shown.t - smoothed.t,
          .stored = stored,
          .ramp = state.safety.gain,
          .dt_s = dt_s};
}

}  // namespace tactum::inline v0_1
