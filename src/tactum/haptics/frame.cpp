#include "tactum/haptics/frame.h"

#include "tactum/haptics/energy.h"
#include "tactum/haptics/picking.h"
#include "tactum/haptics/response.h"

namespace tactum {
namespace {

std::uint32_t flags_of(const ContactWork& work) {
  return (work.unchecked > 0 ? frame_flag::kBudgetShort : 0u) |
         (work.rooms_full ? frame_flag::kRoomsFull : 0u) |
         (work.uncertified > 0 ? frame_flag::kUncertified : 0u);
}

}  // namespace

Wrench haptic_frame(const World& world, const FrameSettings& settings, const DeviceSample& sample,
                    const FrameTick& tick, FrameState& state, FrameReport& report) noexcept {
  report = {};
  report.index = tick.index;
  const double dt = settings.dt_s;
  Wrench raw;
  // Where is the hand?
  const bool was_known = state.hand.known;
  follow_hand(settings.workspace, sample, dt, state.hand);
  if (!was_known && state.hand.known) grasp(settings, state);
  if (sample.valid) pick_or_let_go(world, settings.tool, sample.buttons, state);
  report.held = state.tool.body;
  if (!state.hand.known) report.flags |= frame_flag::kNoHand;
  state.ended(Stage::kHand);

  if (state.hand.known) {
    // What do force fields do? How fast does everything move, and how far may it come: delta = v_c dt.
    pull_by_fields(world, state);
    wanted_velocities(world, settings, dt, state);
    tolerances_from_speed(world, settings, dt, state);
    set_urgency(state);
    state.ended(Stage::kVelocities);

    // Which pairs could touch, and where do they?
    state.finder.find_near_pairs(state.world.X_WB, state.reach, settings.penalty.min_tolerance_m);
    state.ended(Stage::kNearPairs);
    state.finder.find_patches(state.world.X_WB, settings.budget.max_exact_tests, points_wanted(settings),
                              state.waiting.urgency);
    report.work = state.finder.work();
    report.flags |= flags_of(report.work);
    state.ended(Stage::kExactTests);

    // How do the proxy and the world answer?
    respond(world, settings, dt, state, report);
    state.ended(Stage::kResponse);

    // What does the hand feel?
    raw = felt_wrench(settings, state, report);
  }
  report.coupling = raw;
  report.smoothed = smooth_wrench(settings.smoothing, dt, state.smoothing, to_device(state.hand, raw));

  // Does it make energy? Is it safe to send?
  const PortInput port = port_input(world, settings, state, report);
  const Wrench passive = passive_wrench(settings.port, state.port, sample, port, report.port);
  const SafetyInput input{.wanted = passive,
                          .X_DH = sample.X_DH,
                          .sample_valid = sample.valid,
                          .sample_age_s = tick.now_s - sample.time_s,
                          .motors_on = sample.motors_on,
                          .refused = tick.refused,
                          .now_s = tick.now_s,
                          .period_s = tick.period_s,
                          .late = tick.late,
                          .stop = tick.stop};
  SafetyReport safety;
  report.shown = safe_wrench(settings.safety, state.safety, input, safety);
  report.safety = safety.flags;
  state.ended(Stage::kShow);
  return report.shown;
}

}  // namespace tactum
