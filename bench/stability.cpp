#include "bench/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/haptics/coupling_gains.h"
#include "tactum/math/screw.h"

namespace tactum::bench {
namespace {

constexpr double kTap_s = 0.4;          // a tap, there and back
constexpr double kPressed_s = 1.0;      // from here on the hand presses and stays
constexpr double kOut_m = 0.002;        // the hand starts so far before the wall,
constexpr double kIn_m = 0.005;         // and wants to get so far behind it
constexpr double kLever_m = 0.05;       // the same on the rim of a turning handle
constexpr double kMade_J = 1e-5;        // [J] energy beyond what the spring holds: a tenth of a light tap
constexpr double kFelt_m_per_s = 1e-3;  // a vibration of 1 um at 160 Hz

/// The hand's motion through the wall at the origin, along x or about z.
std::shared_ptr<const HandMotion> tapping_hand(bool turning) {
  const auto at = [&](double x) {
    return turning ? Pose{exp_rotation({0, 0, x / kLever_m}), Vec3::Zero()}
                   : Pose{Mat3::Identity(), {x, 0, 0}};
  };
  auto motion = std::make_shared<ScriptedMotion>(at(-kOut_m));
  for (int i = 0; i < 2; ++i) motion->move_to(kTap_s / 2, at(kIn_m)).move_to(kTap_s / 2, at(-kOut_m));
  motion->move_to(kPressed_s - 2 * kTap_s, at(kIn_m));
  return motion;
}

double damping(const WallSetup& setup, bool with_hand) {
  return setup.turning ? setup.device.damping_Nms_per_rad + with_hand * setup.hand.damping_Nms_per_rad
                       : setup.device.damping_Ns_per_m + with_hand * setup.hand.damping_Ns_per_m;
}

/// The wall as the device's wrench, at most what the motors give: more would only be cut.
Wrench wall(const WallSetup& setup, double stiffness, const Pose& X_DH) {
  Wrench F;
  if (setup.turning)
    F.t.z() = -std::min(setup.device.max_torque_Nm, stiffness * std::max(0.0, log_rotation(X_DH.R).z()));
  else
    F.f.x() = -std::min(setup.device.max_force_N, stiffness * std::max(0.0, X_DH.p.x()));
  return F;
}

/// The energy that the wall gives back during retreat [J]: that of a spring, and beyond the motors' limit
/// that of a constant force.
double stored(const WallSetup& setup, double stiffness, const Pose& X_DH, const Wrench& F) {
  const double load = setup.turning ? -F.t.z() : -F.f.x();
  const double depth = setup.turning ? log_rotation(X_DH.R).z() : X_DH.p.x();
  return load * (depth - 0.5 * load / stiffness);
}

/// Largest stiffness in (0, high] of which `good` holds, to 1 %, searched from `high` down in factors.
double largest(double high, const std::function<bool(double)>& good) {
  double bad = high;
  double known = high;
  while (!good(known)) {
    bad = known;
    known *= 0.5;
    if (known < high * 0x1p-20) return 0.0;
  }
  if (known == high) return high;
  while (bad > 1.01 * known) {
    const double middle = std::sqrt(bad * known);
    (good(middle) ? known : bad) = middle;
  }
  return known;
}

}  // namespace

double wall_bound(const WallSetup& setup) {
  return stiffness_allowed(damping(setup, true), 0.0, 1.0 / setup.rate_Hz, setup.device.command_delay_s);
}

double wall_bound_alone(const WallSetup& setup) {
  return stiffness_allowed(damping(setup, false), 0.0, 1.0 / setup.rate_Hz, setup.device.command_delay_s);
}

WallTrial try_wall(const WallSetup& setup, double stiffness, double seconds) {
  SimulatedDevice device(setup.device, setup.hand, tapping_hand(setup.turning));
  WallTrial trial;
  if (!device.open()) return trial;
  PortSettings port;  // only watches
  port.damping_Ns_per_m = setup.turning ? 0.0 : damping(setup, true);
  port.damping_Nms_per_rad = setup.turning ? damping(setup, true) : 0.0;
  port.credit_J = kMade_J;
  PortState state;
  PortReport report;
  PortInput input;
  input.dt_s = 1.0 / setup.rate_Hz;
  std::array<double, 3> fastest{};  // in the thirds of the pressing
  std::array<double, 3> frames{};
  const auto count = static_cast<long>(seconds * setup.rate_Hz);
  for (long i = 0; i < count; ++i) {
    DeviceSample sample;
    const double now_s = static_cast<double>(i) / setup.rate_Hz;
    device.read(now_s, sample);
    // The wrench that acted over the last step, after the delay: the hand received this one.
    input.sent = device.motor_wrench();
    input.felt = input.wanted = wall(setup, stiffness, sample.X_DH);
    input.stored.total_J = stored(setup, stiffness, sample.X_DH, input.wanted);
    device.write(passive_wrench(port, state, handle_motion(state, sample), input, report));
    trial.lowest_J = std::min(trial.lowest_J, report.balance_J);
    if (now_s < kPressed_s) continue;
    const auto third = static_cast<std::size_t>(3.0 * (now_s - kPressed_s) / (seconds - kPressed_s));
    const double speed = setup.turning ? device.true_twist().w.norm() : device.true_twist().v.norm();
    fastest[third] = std::max(fastest[third], speed);
    frames[third] += 1.0;
    if (third == 2) trial.pressed += setup.turning ? -input.wanted.t.z() : -input.wanted.f.x();
  }
  const double felt = setup.turning ? kFelt_m_per_s / kLever_m : kFelt_m_per_s;
  trial.pressed /= std::max(1.0, frames[2]);
  trial.rest_speed = fastest[2];
  trial.at_rest = fastest[2] < felt || fastest[2] < 0.9 * fastest[1];
  trial.passive = trial.lowest_J > -kMade_J;
  return trial;
}

WallRow stiffest_wall(const WallSetup& setup) {
  WallRow row;
  row.device = setup.device.name;
  row.hand = setup.hand.name;
  row.turning = setup.turning;
  row.rate_Hz = setup.rate_Hz;
  row.delay_s = setup.device.command_delay_s;
  row.alone = wall_bound_alone(setup);
  row.bound = wall_bound(setup);
  constexpr double kHighest = 4.0;  // times the bound: the end of the search
  row.at_rest = largest(kHighest * row.bound, [&](double k) { return try_wall(setup, k).at_rest; });
  row.passive = largest(kHighest * row.bound, [&](double k) { return try_wall(setup, k).passive; });
  return row;
}

Result<std::vector<WallRow>> bench_stability(const StabilityOptions& options,
                                             const std::function<void(const std::string&)>& progress) {
  std::vector<SimulatedDeviceModel> models;
  for (const std::string& name : options.devices) {
    Result<SimulatedDeviceModel> model = simulated_device_preset(name);
    if (!model) return model.error();
    models.push_back(*model);
  }
  if (models.empty()) models = simulated_device_presets();
  std::vector<WallRow> rows;
  for (const SimulatedDeviceModel& model : models) {
    progress(model.name);
    for (const char* grip : {"loose", "medium", "firm"})
      for (const bool turning : {false, true}) {
        if (turning && !(model.max_torque_Nm > 0.0)) continue;
        for (const double rate_Hz : options.rates_Hz)
          for (const double delay_s : options.delays_s) {
            WallSetup setup{model, *hand_model(grip), rate_Hz, turning};
            setup.device.command_delay_s = delay_s;
            rows.push_back(stiffest_wall(setup));
          }
      }
  }
  return rows;
}

nlohmann::ordered_json to_json(const WallRow& row) {
  return {{"device", row.device},
          {"hand", row.hand},
          {"wall", row.turning ? "turning" : "plane"},
          {"unit", row.turning ? "N m/rad" : "N/m"},
          {"rate_Hz", row.rate_Hz},
          {"delay_s", row.delay_s},
          {"bound_alone", row.alone},
          {"bound", row.bound},
          {"passive", row.passive},
          {"at_rest", row.at_rest}};
}

}  // namespace tactum::bench
