#include "tactum/haptics/frame.h"

#include "tactum/dynamics/body_load.h"
#include "tactum/haptics/show_stage.h"

namespace tactum::inline v0_1 {

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
  report_hand(grasped, report);
  state.ended(Stage::kHand);

  if (grasped.hand_known) {
    // The motion bounds of this frame.
    const double stiffness_share = state.port.booked.stiffness_share;
    const MotionInput motion =
        motion_input(world, settings, grasped, contacts.finder.radii(), stiffness_share);
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

  // What the device can exert of it, smoothed, then the caller's own wrench: device axes from here on.
  const Wrench at_handle = to_device(settings.workspace, state.hand, felt);
  const HandleMotion handle_moved = handle_motion(state.port, sample);
  const WrenchStep by_hand =
      explained_by_hand(settings, grasped, contacts.finder.radii(), handle_moved.moved);
  report.smoothed = smooth_for_device(settings, by_hand, at_handle, state.smoothing, report.safety);
  Wrench wanted = report.smoothed;
  if (state.force_stage) wanted = state.force_stage->apply(wanted, sample, report);

  // The energy balance of the port, then safety.
  const StoredEnergy stored = stored_in_scene(world, settings, grasped, handle, at_handle, state);
  const PortInput port = port_input(settings, wanted, report.smoothed, stored, state.smoothing, state.safety);
  report.passive = passive_wrench(settings.port, state.port, handle_moved, port, report.port);
  const SafetyInput input = safety_input(sample, tick, report.passive);
  report.shown = safe_wrench(settings.safety, state.safety, input, report.safety);
  state.ended(Stage::kShow);
  return report.shown;
}

}  // namespace tactum::inline v0_1
