#include "tactum/haptics/frame.h"

#include "tactum/dynamics/body_load.h"
#include "tactum/response/energy.h"

namespace tactum::inline v0_1 {
namespace {

/// The handle where the step has left it; none while nothing is grasped.
PlacedHandle report_grasp(const GraspedPart& grasped, const WorldState& bodies, FrameReport& report) {
  report.X_WH = grasped.X_WH;
  if (grasped.body < 0) return {};
  const PlacedHandle handle = handle_at(grasped, bodies.X_WB[static_cast<std::size_t>(grasped.body)]);
  report.X_WH_proxy = handle.X_WH_proxy;
  report.X_WH_proxy.p += grasped.beside_W;
  report.field = grasped.field.at_centre;
  return handle;
}

}  // namespace

Wrench haptic_frame(const World& world, const FrameSettings& settings, const DeviceSample& sample,
                    const FrameTick& tick, FrameState& state, FrameReport& report) noexcept {
  report = {};
  report.index = tick.index;
  WorldState& bodies = state.world;
  ContactStage& contacts = state.contacts;
  PlacedHandle handle;
  Wrench felt;
  // The pose of the probe, the grasped part, and the load of force fields on it.
  const GraspedPart grasped = track_hand(world, settings, sample, bodies.X_WB, state.hand);
  report.grasped_body = grasped.body;
  if (!grasped.hand_known) report.flags |= frame_flag::kNoHand;
  state.ended(Stage::kHand);

  if (grasped.hand_known) {
    // The motion bounds of this frame.
    const MotionInput motion = motion_input(world, settings, grasped, contacts.finder.radii());
    const std::span<const double> motion_bound = state.response.bound_motion(motion, bodies);
    state.ended(Stage::kVelocities);

    // The pairs that could touch, and their contact patches.
    find_near_pairs(settings, bodies.X_WB, motion_bound, grasped.body, contacts);
    state.ended(Stage::kNearPairs);
    const std::span<const ContactPatch> patches =
        find_patches(world, settings, bodies.X_WB, state.response.points(), contacts, report);
    state.ended(Stage::kExactTests);

    // The response of the grasped part and the world.
    state.X_WB_start = bodies.X_WB;  // same size: nothing is allocated
    const StepInput step{motion, patches, contacts.priority, report.work, contacts.shading, state.X_WB_start};
    state.response.step(step, contacts.finder, bodies, report);
    add_field_work(bodies.X_WB, state.hand.field);
    state.load_work_J += work_of_loads(world, state.X_WB_start, bodies.X_WB, settings.dt_s);
    state.ended(Stage::kResponse);

    // The wrench that the hand feels, at the handle, world axes.
    handle = report_grasp(grasped, bodies, report);
    felt = state.response.felt(step, handle);
  }
  report.coupling = felt;
  report.smoothed = smooth_wrench(settings.smoothing, settings.dt_s, state.smoothing,
                                  to_device(settings.workspace, state.hand, felt));

  // The caller's own wrench, then passivity, then safety: all at the handle, device axes.
  PortInput port{.wanted = report.smoothed, .sent = state.safety.sent, .dt_s = settings.dt_s};
  const double outside_work_J = state.hand.field.given_J + state.load_work_J;
  add_stored_energy(world, settings, bodies, grasped.body, handle.to_hand, outside_work_J,
                    state.response.pending_J(), port);
  if (state.force_stage != nullptr) port.wanted = state.force_stage->apply(port.wanted, sample, report);
  const Wrench passive = passive_wrench(settings.port, state.port, sample, port, report.port);
  SafetyReport safety;
  report.shown = safe_wrench(settings.safety, state.safety, safety_input(sample, tick, passive), safety);
  report.safety = safety.flags;
  state.ended(Stage::kShow);
  return report.shown;
}

}  // namespace tactum::inline v0_1
