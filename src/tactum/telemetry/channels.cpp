#include "tactum/telemetry/channels.h"

#include <array>

#include "tactum/haptics/report_fields.h"
#include "tactum/math/screw.h"
#include "tactum/response/workspace_scale.h"

namespace tactum::inline v0_1 {
namespace {

using Source = const FrameSource&;

Wrench from_device_axes(Source frame, const Wrench& F_D) { return rotated(frame.state.hand.X_WD.R, F_D); }

/// The contact forces act at the grasped part's centre of mass; the hand feels them at the handle.
Wrench contact_at_handle(Source frame) noexcept {
  const int grasped = frame.state.hand.grasp.body;
  if (grasped < 0) return {};
  const Vec3& p_WB = frame.state.world.X_WB[static_cast<std::size_t>(grasped)].p;
  return moved(frame.report.restoring, frame.report.X_WH_proxy.p - p_WB);
}

/// So that all stages of the wrench can be compared.
Wrench felt_at_device(Source frame, const Wrench& in_scene) noexcept {
  return at_device(in_scene, frame.settings.workspace.scale);
}

// clang-format off
constexpr WrenchStage kStages[] = {
  {"contact", "Contact forces", "what the touched parts do to the held one, told at the handle",
   [](Source f) noexcept -> Wrench { return felt_at_device(f, contact_at_handle(f)); }},
  {"coupling", "Raw: the coupling", "spring and damper from the hand to the held part; joints and free motion take their share",
   [](Source f) noexcept -> Wrench { return felt_at_device(f, f.report.coupling); }},
  {"smoothed", "After smoothing", "no step larger than the smoothing settings allow",
   [](Source f) noexcept -> Wrench { return from_device_axes(f, f.report.smoothed); }},
  {"shown", "Shown: after safety", "limits, slew, ramps and stop; this was sent to the device",
   [](Source f) noexcept -> Wrench { return from_device_axes(f, f.report.shown); }},
};

Vec3 place_of_hand(Source f) noexcept { return f.report.X_WH.p; }
Vec3 place_of_proxy(Source f) noexcept { return f.report.X_WH_proxy.p; }
Vec3 place_in_device(Source f) noexcept { return f.state.port.X_DH.p; }
const Mat3& turn_of_hand(Source f) noexcept { return f.report.X_WH.R; }
const Mat3& turn_of_proxy(Source f) noexcept { return f.report.X_WH_proxy.R; }

template <auto Place, int Axis>
double coordinate(Source frame) noexcept {
  return Place(frame)[Axis];
}
/// A component of the quaternion w, x, y, z.
template <auto Turn, int Component>
double component(Source frame) noexcept {
  const Quat q(Turn(frame));
  return Component == 0 ? q.w() : q.vec()[Component - 1];
}

// Values that are no field of the report, but made from some or from the state.
constexpr Channel kMadeChannels[] = {
  {"stretch_m", "Stretch", "m", "stretch", "from the hand to where the held part would have it",
   [](Source f) noexcept { return (f.report.X_WH_proxy.p - f.report.X_WH.p).norm(); }},
  {"stretch_rad", "Twist", "rad", "twist", "the same as an angle",
   [](Source f) noexcept { return log_rotation(f.report.X_WH_proxy.R * f.report.X_WH.R.transpose()).norm(); }},
  {"hand_speed_m_per_s", "Hand speed", "m/s", "speed", "of the handle in the world",
   [](Source f) noexcept { return f.state.hand.V_WH.v.norm(); }},
  {"hand_turn_rad_per_s", "Hand turning", "rad/s", "turning", "of the handle in the world",
   [](Source f) noexcept { return f.state.hand.V_WH.w.norm(); }},
  {"field_N", "Force fields", "N", "force fields", "on the held part, all together",
   [](Source f) noexcept { return f.report.field.f.norm(); }},
  {"field_Nm", "Force fields, torque", "N m", "torque of force fields", "the same about its centre of mass",
   [](Source f) noexcept { return f.report.field.t.norm(); }},
  {"field_given_J", "From force fields", "J", "energy", "work they have done on what was held, of either sign",
   [](Source f) noexcept { return f.state.hand.field.given_J / f.settings.workspace.scale; }},
  {"hand_px_m", "Hand x", "m", "place of the hand", "the handle in the world", coordinate<place_of_hand, 0>},
  {"hand_py_m", "Hand y", "m", "place of the hand", "the handle in the world", coordinate<place_of_hand, 1>},
  {"hand_pz_m", "Hand z", "m", "place of the hand", "the handle in the world", coordinate<place_of_hand, 2>},
  {"hand_qw", "Hand qw", "", "orientation of the hand", "the handle in the world", component<turn_of_hand, 0>},
  {"hand_qx", "Hand qx", "", "orientation of the hand", "the handle in the world", component<turn_of_hand, 1>},
  {"hand_qy", "Hand qy", "", "orientation of the hand", "the handle in the world", component<turn_of_hand, 2>},
  {"hand_qz", "Hand qz", "", "orientation of the hand", "the handle in the world", component<turn_of_hand, 3>},
  {"device_px_m", "Device x", "m", "place in the device", "the handle in the frame of the device", coordinate<place_in_device, 0>},
  {"device_py_m", "Device y", "m", "place in the device", "the handle in the frame of the device", coordinate<place_in_device, 1>},
  {"device_pz_m", "Device z", "m", "place in the device", "the handle in the frame of the device", coordinate<place_in_device, 2>},
  {"proxy_px_m", "Proxy x", "m", "place of the proxy", "the handle on the held part, in the world", coordinate<place_of_proxy, 0>},
  {"proxy_py_m", "Proxy y", "m", "place of the proxy", "the handle on the held part, in the world", coordinate<place_of_proxy, 1>},
  {"proxy_pz_m", "Proxy z", "m", "place of the proxy", "the handle on the held part, in the world", coordinate<place_of_proxy, 2>},
  {"proxy_qw", "Proxy qw", "", "orientation of the proxy", "the handle on the held part, in the world", component<turn_of_proxy, 0>},
  {"proxy_qx", "Proxy qx", "", "orientation of the proxy", "the handle on the held part, in the world", component<turn_of_proxy, 1>},
  {"proxy_qy", "Proxy qy", "", "orientation of the proxy", "the handle on the held part, in the world", component<turn_of_proxy, 2>},
  {"proxy_qz", "Proxy qz", "", "orientation of the proxy", "the handle on the held part, in the world", component<turn_of_proxy, 3>},
  {"safety_gain", "Ramp", "", "ramp", "of the start and stop ramps, 0 to 1",
   [](Source f) noexcept { return f.state.safety.gain; }},
};

constexpr FlagName kFrameFlags[] = {
  {frame_flag::kBudgetShort, "pairs left unchecked: raise max_exact_tests"},
  {frame_flag::kCapacityReached, "pairs, patches or their friction dropped: capacity reached"},
  {frame_flag::kPointsFull, "contact points dropped: raise max_contact_points"},
  {frame_flag::kSolverBounded, "contact solver not converged: raise solver_iterations"},
  {frame_flag::kUncertified, "a distance without its certificate was used"},
  {frame_flag::kMotionUndone, "a motion was no number and was undone"},
  {frame_flag::kNoHand, "no valid sample of the hand yet"},
  {frame_flag::kStepLimited, "the held part lags behind the hand: raise max_step_m"},
  {frame_flag::kPathUnproven, "a step of two surfaces was tested at its end only: raise max_path_tests"},
  {frame_flag::kTurnLimited, "the held part lags behind the hand: raise max_turn_deg"},
};
// clang-format on

constexpr std::size_t kFieldChannels = [] {
  std::size_t count = 0;
  for_each_report_field([&](auto field) { count += decltype(field)::kInfo.channel.key != nullptr ? 1 : 0; });
  return count;
}();

/// The channels that are made, then those that are fields of the report.
constexpr auto kChannels = [] {
  std::array<Channel, std::size(kMadeChannels) + kFieldChannels> all{};
  std::size_t count = 0;
  for (const Channel& channel : kMadeChannels) all[count++] = channel;
  for_each_report_field([&](auto field) {
    using Field = decltype(field);
    if constexpr (Field::kInfo.channel.key != nullptr) {
      const FieldChannel& shown = Field::kInfo.channel;
      all[count++] = {shown.key,
                      shown.label,
                      Field::kInfo.unit,
                      shown.group,
                      Field::kInfo.meaning,
                      [](Source f) noexcept { return static_cast<double>(Field::of(f.report)); }};
    }
  });
  return all;
}();

}  // namespace

std::span<const WrenchStage> wrench_stages() noexcept { return kStages; }
std::span<const Channel> channels() noexcept { return kChannels; }
std::span<const FlagName> frame_flag_table() noexcept { return kFrameFlags; }

}  // namespace tactum::inline v0_1
