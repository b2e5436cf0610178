#include "tactum/telemetry/channels.h"

#include "tactum/math/screw.h"

namespace tactum {
namespace {

using Source = const FrameSource&;

Wrench from_device_axes(Source frame, const Wrench& F_D) { return rotated(frame.state.hand.X_WD.R, F_D); }

/// The contact forces act at the held part's centre of mass; the hand feels them at the handle.
Wrench contact_at_handle(Source frame) noexcept {
  const int held = frame.state.hand.grasp.body;
  if (held < 0) return {};
  const Vec3& p_WB = frame.state.world.X_WB[static_cast<std::size_t>(held)].p;
  return moved(frame.report.restoring, frame.report.X_WH_proxy.p - p_WB);
}

// clang-format off
constexpr WrenchStage kStages[] = {
  {"contact", "Contact forces", "what the touched parts do to the held one, told at the handle", contact_at_handle},
  {"coupling", "Raw: the coupling", "spring and damper from the hand to the held part; joints and free motion take their share",
   [](Source f) noexcept -> Wrench { return f.report.coupling; }},
  {"smoothed", "After smoothing", "no step larger than the smoothing settings allow",
   [](Source f) noexcept -> Wrench { return from_device_axes(f, f.report.smoothed); }},
  {"shown", "Shown: after safety", "limits, slew, ramps and stop; this was sent to the device",
   [](Source f) noexcept -> Wrench { return from_device_axes(f, f.report.shown); }},
};

constexpr Channel kChannels[] = {
  {"stretch_m", "Stretch", "m", "stretch", "from the hand to where the held part would have it",
   [](Source f) noexcept { return (f.report.X_WH_proxy.p - f.report.X_WH.p).norm(); }},
  {"stretch_rad", "Twist", "rad", "twist", "the same as an angle",
   [](Source f) noexcept { return log_rotation(f.report.X_WH_proxy.R * f.report.X_WH.R.transpose()).norm(); }},
  {"contact_points", "Contact points", "", "contacts", "rows of the contact problem",
   [](Source f) noexcept -> double { return f.report.contact_points; }},
  {"held_contact_points", "... that push the held part", "", "contacts", "those that you can feel",
   [](Source f) noexcept -> double { return f.report.held_contact_points; }},
  {"patches", "Contact patches", "", "contacts", "pairs of pieces that touch",
   [](Source f) noexcept -> double { return f.report.work.patches; }},
  {"min_distance_m", "Smallest distance", "m", "distance", "of the pairs in contact; negative is overlap, 0 without contact",
   [](Source f) noexcept { return f.report.min_distance_m; }},
  {"tolerance_m", "Tolerance", "m", "distance", "distance below which a pair pushes, largest of the pairs in contact",
   [](Source f) noexcept { return f.report.tolerance_m; }},
  {"hand_speed_m_per_s", "Hand speed", "m/s", "speed", "of the handle in the world",
   [](Source f) noexcept { return f.state.hand.V_WH.v.norm(); }},
  {"hand_turn_rad_per_s", "Hand turning", "rad/s", "turning", "of the handle in the world",
   [](Source f) noexcept { return f.state.hand.V_WH.w.norm(); }},
  {"near_pairs", "Near pairs", "", "work", "pairs of pieces on the lists",
   [](Source f) noexcept -> double { return f.report.work.near_pairs; }},
  {"exact_tests", "Exact tests", "", "work", "pairs of pieces whose distance was computed",
   [](Source f) noexcept -> double { return f.report.work.exact_tests; }},
  {"feature_steps", "Feature steps", "", "work", "feature pairs those tests visited",
   [](Source f) noexcept -> double { return f.report.work.feature_steps; }},
  {"solver_iterations", "Solver rounds", "", "work", "of the contact solver",
   [](Source f) noexcept -> double { return f.report.solver_iterations; }},
  {"time_of_impact_s", "Time of impact", "s", "impact", "smallest, from the start of the frame",
   [](Source f) noexcept { return f.report.time_of_impact_s; }},
  {"friction_used", "Friction in use", "", "friction", "largest share of a friction cone that forces use; at 1 it slips",
   [](Source f) noexcept { return f.report.friction.cone_used; }},
  {"sticking_patches", "Sticking surfaces", "", "friction", "pairs of surfaces that push, rub and do not slide",
   [](Source f) noexcept -> double { return f.report.friction.sticking; }},
  {"slipping_patches", "Slipping surfaces", "", "friction", "the same that slide",
   [](Source f) noexcept -> double { return f.report.friction.slipping; }},
  {"energy_from_hand_J", "From the hand", "J", "energy", "work the hand has put in, moving against the force",
   [](Source f) noexcept { return f.report.port.total.from_hand_J; }},
  {"energy_to_hand_J", "To the hand", "J", "energy", "work the hand was given, moved along by the force",
   [](Source f) noexcept { return f.report.port.total.to_hand_J; }},
  {"energy_damped_J", "Taken out by the controller", "J", "energy", "by the damping it added, before limits and ramps",
   [](Source f) noexcept { return f.report.port.total.damped_J; }},
  {"port_ledger_J", "Ledger now", "J", "energy", "taken in by the scene, within the credit; negative: energy was made",
   [](Source f) noexcept { return f.report.port.ledger_J; }},
  {"energy_from_hand_turning_J", "From the hand, turning", "J", "energy of turning", "work of the hand's turns against the torque",
   [](Source f) noexcept { return f.report.port.total_turning.from_hand_J; }},
  {"energy_to_hand_turning_J", "To the hand, turning", "J", "energy of turning", "work of the torque on the hand",
   [](Source f) noexcept { return f.report.port.total_turning.to_hand_J; }},
  {"energy_damped_turning_J", "Taken out by the controller, turning", "J", "energy of turning", "by the turning damping it added",
   [](Source f) noexcept { return f.report.port.total_turning.damped_J; }},
  {"port_ledger_turning_J", "Ledger now, turning", "J", "energy of turning", "the same ledger for the hand's turns",
   [](Source f) noexcept { return f.report.port.ledger_turning_J; }},
  {"injected_Ns_per_m", "Damping added", "N s/m", "added damping", "by the passivity controller, to take made energy out",
   [](Source f) noexcept { return f.report.port.injected_Ns_per_m; }},
  {"injected_Nms_per_rad", "Turning damping added", "N m s/rad", "added turning damping", "the same against turning",
   [](Source f) noexcept { return f.report.port.injected_Nms_per_rad; }},
  {"field_N", "Force fields", "N", "force fields", "on the held part, all together",
   [](Source f) noexcept { return f.report.field.f.norm(); }},
  {"field_Nm", "Force fields, torque", "N m", "torque of force fields", "the same about its centre of mass",
   [](Source f) noexcept { return f.report.field.t.norm(); }},
  {"field_given_J", "From force fields", "J", "energy", "work they have done on what was held, of either sign",
   [](Source f) noexcept { return f.state.hand.field.given_J; }},
  {"safety_gain", "Ramp", "", "ramp", "of the start and stop ramps, 0 to 1",
   [](Source f) noexcept { return f.state.safety.gain; }},
  {"safety_flags", "Safety flags", "", "flags", "which limit acted, as bits",
   [](Source f) noexcept -> double { return f.report.safety; }},
  {"frame_flags", "Frame flags", "", "flags", "what the frame could not do in full, as bits",
   [](Source f) noexcept -> double { return f.report.flags; }},
};

constexpr FlagName kFrameFlags[] = {
  {frame_flag::kBudgetShort, "pairs left unchecked: raise max_exact_tests"},
  {frame_flag::kCapacityReached, "pairs or patches dropped: capacity reached"},
  {frame_flag::kPointsFull, "contact points dropped: raise max_contact_points"},
  {frame_flag::kSolverBounded, "contact solver not converged: raise solver_iterations"},
  {frame_flag::kUncertified, "a distance without its certificate was used"},
  {frame_flag::kMotionUndone, "a motion was no number and was undone"},
  {frame_flag::kNoHand, "no valid sample of the hand yet"},
};
// clang-format on

}  // namespace

std::span<const WrenchStage> wrench_stages() noexcept { return kStages; }
std::span<const Channel> channels() noexcept { return kChannels; }
std::span<const FlagName> frame_flag_table() noexcept { return kFrameFlags; }

}  // namespace tactum
