#include "tactum/haptics/show_stage.h"

#include "tactum/math/screw.h"
#include "tactum/response/energy.h"

namespace tactum::inline v0_1 {

namespace {

/// By how much the displacement of the handle since the last good sample can change the felt wrench, as the
/// device has it.
WrenchStep explained_by_hand(const FrameSettings& settings, const GraspedPart& grasped,
                             const DeviceSample& sample, const FrameState& state) {
  if (!state.port.known || !sample.valid || !plausible(sample.X_DH)) return {};
  double lever_m = 0.0;  // of the farthest point that is grasped
  if (grasped.body >= 0)
    lever_m = state.contacts.finder.radii()[static_cast<std::size_t>(grasped.body)] + grasped.X_BH.p.norm();
  return explained_by(twist_between(state.port.X_DH, sample.X_DH, 1.0), settings.coupling.stiffness_N_per_m,
                      settings.coupling.stiffness_Nm_per_rad, lever_m / settings.workspace.scale);
}

}  // namespace

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

Wrench smooth_for_device(const FrameSettings& settings, const GraspedPart& grasped,
                         const DeviceSample& sample, const Wrench& at_handle, FrameState& state,
                         std::uint32_t& safety_flags) noexcept {
  const Wrench within = within_limits(settings.safety, at_handle, safety_flags);
  const WrenchStep explained = explained_by_hand(settings, grasped, sample, state);
  const Wrench smoothed =
      smooth_wrench(settings.smoothing, settings.dt_s, explained, state.smoothing, within);
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
                        .share = state.port.booked.share,
                        .outside_work_J = state.hand.field.given_J + state.load_work_J,
                        .response_J = state.response.stored_J()});
}

PortInput port_input(const FrameSettings& settings, const Wrench& wanted, const Wrench& smoothed,
                     const StoredEnergy& stored, const FrameState& state) noexcept {
  return {.felt = smoothed,
          .wanted = wanted,
          .sent = state.safety.sent,
          .unfelt_Nm = state.smoothing.shown.t - smoothed.t,
          .stored = stored,
          .ramp = state.safety.gain,
          .dt_s = settings.dt_s};
}

}  // namespace tactum::inline v0_1
