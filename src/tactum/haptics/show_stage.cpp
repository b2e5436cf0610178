#include "tactum/haptics/show_stage.h"

#include "tactum/math/screw.h"
#include "tactum/response/energy.h"

namespace tactum::inline v0_1 {

void report_hand(const GraspedPart& grasped, FrameReport& report) noexcept {
  report.grasped_body = grasped.body;
  report.hold = static_cast<int>(grasped.hold);
  if (!grasped.hand_known) report.flags |= frame_flag::kNoHand;
}

PlacedHandle report_grasp(const GraspedPart& grasped, const WorldState& bodies,
                          FrameReport& report) noexcept {
  report.X_WH = grasped.X_WH;
  if (grasped.body < 0) return {};
  const PlacedHandle handle = handle_at(grasped, bodies.X_WB[static_cast<std::size_t>(grasped.body)]);
  report.X_WH_proxy = handle.X_WH_proxy;
  report.X_WH_proxy.p += grasped.beside_W;
  report.field = grasped.field.at_centre;
  return handle;
}

WrenchStep explained_by_hand(const FrameSettings& settings, const GraspedPart& grasped,
                             std::span<const double> radius_m, const Twist& moved) noexcept {
  double lever_m = 0.0;  // of the farthest point that is grasped
  if (grasped.body >= 0) lever_m = radius_m[static_cast<std::size_t>(grasped.body)] + grasped.X_BH.p.norm();
  return explained_by(moved, settings.coupling.stiffness_N_per_m, settings.coupling.stiffness_Nm_per_rad,
                      lever_m / settings.workspace.scale);
}

Wrench smooth_for_device(const FrameSettings& settings, const WrenchStep& by_hand, const Wrench& at_handle,
                         SmoothingState& state, std::uint32_t& safety_flags) noexcept {
  const Wrench within = within_limits(settings.safety, at_handle, safety_flags);
  const Wrench smoothed = smooth_wrench(settings.smoothing, settings.dt_s, by_hand, state, within);
  return settings.port.actuates_torque ? smoothed : Wrench{smoothed.f, Vec3::Zero()};
}

StoredEnergy stored_in_scene(const World& world, const FrameSettings& settings, const GraspedPart& grasped,
                             const PlacedHandle& handle, const Wrench& felt,
                             const FrameState& state) noexcept {
  return stored_energy({.world = world,
                        .settings = settings,
                        .X_WB_start = state.X_WB_start,
                        .bodies = state.world,
                        .grasped = grasped.body,
                        .to_hand = handle.to_hand,
                        .V_WH = grasped.V_WH,
                        .felt = felt,
                        .smoothed = state.smoothing.shown,
                        .share = state.port.booked.stiffness_share,
                        .outside_work_J = state.hand.field.given_J + state.load_work_J,
                        .response_J = state.response.stored_J()});
}

PortInput port_input(const FrameSettings& settings, const Wrench& wanted, const Wrench& smoothed,
                     const StoredEnergy& stored, const SmoothingState& smoothing,
                     const SafetyState& safety) noexcept {
  return {.felt = smoothed,
          .wanted = wanted,
          .sent = safety.sent,
          .unfelt_Nm = smoothing.shown.t - smoothed.t,
          .stored = stored,
          .ramp = safety.gain,
          .dt_s = settings.dt_s};
}

}  // namespace tactum::inline v0_1
