#include "tactum/haptics/frame.h"

#include "tactum/base/assert.h"
#include "tactum/haptics/show_stage.h"

namespace tactum::inline v0_1 {

void haptic_frame(const World& world, const FrameSettings& settings, std::span<const HandSample> samples,
                  const FrameTick& tick, FrameState& state, FrameReport& report,
                  std::span<Wrench> wrenches) noexcept {
  begin_reports(tick, state, report);
  WorldState& bodies = state.world;
  ContactStage& contacts = state.contacts;
  // The poses of the probes, the grasped parts, and the loads of force fields on them.
  const std::span<const HandInput> hands = track_hands(world, settings, samples, state);
  report_hands(hands, state, report);
  state.ended(Stage::kHand);

  if (some_known(hands)) {
    // The motion bounds of this frame.
    const MotionInput motion = motion_input(world, settings, hands, contacts.finder.radii());
    const std::span<const double> motion_bound = state.response.bound_motion(motion, bodies);
    state.ended(Stage::kVelocities);

    // The pairs that could touch, and their contact patches.
    find_near_pairs(settings, bodies.X_WB, motion_bound, hands, contacts);
    state.ended(Stage::kNearPairs);
    const std::span<const ContactPatch> patches =
        find_patches(world, settings, bodies.X_WB, state.response.points(), contacts, report);
    state.ended(Stage::kExactTests);

    // The response of the grasped parts and the world.
    state.X_WB_start = bodies.X_WB;  // same size: nothing is allocated
    const StepInput step{motion, patches, contacts.priority, report.work, contacts.shading, state.X_WB_start};
    state.response.step(step, contacts.finder, bodies, report, state.other_reports);
    add_work(world, settings, hands, state);
    state.ended(Stage::kResponse);

    // The wrenches that the hands feel, at the handles, world axes.
    for (std::size_t h = 0; h < hands.size(); ++h) feel_grasp(step, h, state, report);
  }

  const WrenchStep by_hands = explained_by_hands(settings, contacts.finder.radii(), state);
  for (std::size_t h = 0; h < hands.size(); ++h) {
    const HandSettings& own = settings.hand(h);
    HandFrameState& hand = state.of_hand(h);
    HandReport& own_report = report_of(h, state, report);
    // What the device can exert of it, smoothed, then the caller's own wrench: device axes from here on.
    const Wrench at_handle = to_device(own.workspace, hand.hand, own_report.coupling);
    own_report.smoothed =
        smooth_for_device(own, settings.dt_s, by_hands, at_handle, hand.smoothing, own_report.safety);
    Wrench wanted = own_report.smoothed;
    if (h == 0 && state.force_stage) wanted = state.force_stage->apply(wanted, samples[h], report);

    // The energy balance of the port, then safety.
    const StoredEnergy stored = stored_in_scene(world, settings, h, at_handle, state);
    const PortInput port = port_input(settings.dt_s, wanted, own_report.smoothed, stored, hand);
    own_report.passive = passive_wrench(own.port, hand.port, hand.handle_moved, port, own_report.port);
    SafetyInput input = safety_input(samples[h], tick, own_report.passive);
    input.refused = samples[h].refused;
    own_report.shown = safe_wrench(own.safety, hand.safety, input, own_report.safety);
    wrenches[h] = own_report.shown;
  }
  state.ended(Stage::kShow);
}

Wrench haptic_frame(const World& world, const FrameSettings& settings, const DeviceSample& sample,
                    const FrameTick& tick, FrameState& state, FrameReport& report) noexcept {
  TACTUM_ASSERT(settings.hands() == 1);
  const HandSample one{sample, tick.refused};
  Wrench wrench;
  haptic_frame(world, settings, {&one, 1}, tick, state, report, {&wrench, 1});
  return wrench;
}

}  // namespace tactum::inline v0_1
