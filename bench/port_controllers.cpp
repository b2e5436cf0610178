#include "bench/port_controllers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tactum/haptics/coupling_gains.h"

namespace tactum::bench {
namespace {

constexpr double kStep_s = 1e-3;

/// What a controller makes of the spring's force, along one axis.
class Controller {
 public:
  virtual ~Controller() = default;
  /// The force to send at position x, when `sent` has acted since the last one.
  virtual double force(double stiffness, double x, double sent, const DeviceSample& sample) = 0;
};

double spring(double stiffness, double x, double most) { return std::clamp(-stiffness * x, -most, most); }
double stored(double stiffness, double x, double most) {
  const double load = std::abs(spring(stiffness, x, most));
  return load * (std::abs(x) - 0.5 * load / stiffness);
}

class Plain final : public Controller {
 public:
  explicit Plain(const SimulatedDeviceModel& model) : most_(model.max_force_N) {}
  double force(double stiffness, double x, double, const DeviceSample&) override {
    return spring(stiffness, x, most_);
  }

 private:
  double most_;
};

class Damping final : public Controller {
 public:
  /// `filter_s` 0: the damper's force is not filtered; `follows`: the balance follows a passive spring's.
  Damping(const SimulatedDeviceModel& model, bool follows, double filter_s)
      : model_(model), follows_(follows), filter_s_(filter_s) {
    const double by_noise =
        model.encoder_step_m > 0.0 ? 0.05 * model.max_force_N * kStep_s / model.encoder_step_m : 1e9;
    most_damping_ = std::min(0.1 * model.mass_kg / kStep_s, by_noise);
  }
  double force(double stiffness, double x, double sent, const DeviceSample&) override {
    const double dx = known_ ? x - x_ : 0.0;
    const double kept = stored(stiffness, x, model_.max_force_N);
    balance_ += -sent * dx + model_.damping_Ns_per_m * dx * dx / kStep_s;
    if (follows_) balance_ -= kept - kept_;
    balance_ = std::clamp(balance_, -1e-3, follows_ ? 0.0 : 1e-3 + kept);
    kept_ = kept;
    x_ = x;
    known_ = true;
    double damping = 0.0;
    if (balance_ < 0.0 && dx != 0.0) damping = std::min(-balance_ * kStep_s / (dx * dx), most_damping_);
    const double wanted = -damping * dx / kStep_s;
    damper_ += filter_s_ > 0.0 ? (wanted - damper_) * kStep_s / (filter_s_ + kStep_s) : wanted - damper_;
    return spring(stiffness, x, model_.max_force_N) + damper_;
  }

 private:
  SimulatedDeviceModel model_;
  bool follows_;
  double filter_s_;
  double most_damping_ = 0.0, balance_ = 0.0, kept_ = 0.0, x_ = 0.0, damper_ = 0.0;
  bool known_ = false;
};

class Bounding final : public Controller {
 public:
  explicit Bounding(const SimulatedDeviceModel& model) : model_(model) {}
  double force(double stiffness, double x, double sent, const DeviceSample&) override {
    const double dx = known_ ? x - x_ : 0.0;
    x_ = x;
    known_ = true;
    // With f' = f + beta dx a frame generates at most -beta dx^2 / 2, which b dx^2 / dt can dissipate.
    const double wanted = spring(stiffness, x, model_.max_force_N) - sent;
    const double most = 2.0 * model_.damping_Ns_per_m / kStep_s * std::abs(dx);
    return sent + std::clamp(wanted, -most, most);
  }

 private:
  SimulatedDeviceModel model_;
  double x_ = 0.0;
  bool known_ = false;
};

class Softening final : public Controller {
 public:
  explicit Softening(const SimulatedDevice& device)
      : settings_(port_settings(device.info())), most_(device.info().max_force_N) {}
  double force(double stiffness, double x, double sent, const DeviceSample& sample) override {
    const double k = stiffness * state_.booked.stiffness_share;
    PortInput input;
    input.felt.f.x() = input.wanted.f.x() = spring(k, x, most_);
    input.sent.f.x() = sent;
    input.stored = {stored(k, x, most_), stored(k, x, most_), std::abs(input.felt.f.x()), 0.0};
    input.dt_s = kStep_s;
    PortReport report;
    return passive_wrench(settings_, state_, handle_motion(state_, sample), input, report).f.x();
  }

 private:
  PortSettings settings_;
  double most_;
  PortState state_;
};

struct Maker {
  const char* name;
  std::unique_ptr<Controller> (*make)(const SimulatedDevice&, const SimulatedDeviceModel&);
};
const Maker kMakers[] = {
    {"none",
     [](const SimulatedDevice&, const SimulatedDeviceModel& m) -> std::unique_ptr<Controller> {
       return std::make_unique<Plain>(m);
     }},
    {"damping",
     [](const SimulatedDevice&, const SimulatedDeviceModel& m) -> std::unique_ptr<Controller> {
       return std::make_unique<Damping>(m, false, 0.0);
     }},
    {"reference",
     [](const SimulatedDevice&, const SimulatedDeviceModel& m) -> std::unique_ptr<Controller> {
       return std::make_unique<Damping>(m, true, 0.003);
     }},
    {"bounding",
     [](const SimulatedDevice&, const SimulatedDeviceModel& m) -> std::unique_ptr<Controller> {
       return std::make_unique<Bounding>(m);
     }},
    {"stiffness",
     [](const SimulatedDevice& d, const SimulatedDeviceModel&) -> std::unique_ptr<Controller> {
       return std::make_unique<Softening>(d);
     }},
};

/// Knocked at first; from 1.5 s on the hand presses by 5 mm, and what it then feels is compared.
ControllerRow run_controller(const Maker& maker, SimulatedDeviceModel model, const std::string& grip,
                             double bounds) {
  ControllerRow row{maker.name, model.name, grip, bounds, model.command_delay_s};
  const HandModel hand = *hand_model(grip);
  const double stiffness = bounds * stiffness_allowed(model.damping_Ns_per_m + hand.damping_Ns_per_m, 0.0,
                                                      kStep_s, model.command_delay_s);
  auto motion = std::make_shared<ScriptedMotion>();
  motion->hold(1.5).move_to(0.5, {Mat3::Identity(), {0.005, 0, 0}}).hold(1.0);
  SimulatedDevice device(model, hand, motion);
  if (!device.open()) return row;
  device.place({}, {{0.02, 0, 0}, Vec3::Zero()});
  const std::unique_ptr<Controller> controller = maker.make(device, model);
  double sent = 0.0, step = 0.0, added = 0.0, force_sum = 0.0, wanted_sum = 0.0;
  for (int i = 0; i < 3000; ++i) {
    DeviceSample sample;
    device.read(i * kStep_s, sample);
    const double x = sample.X_DH.p.x();
    const double next = controller->force(stiffness, x, sent, sample);
    const double now_added = next - spring(stiffness, x, model.max_force_N);
    if (i >= 1000 && i < 1500) {
      row.late_m_per_s = std::max(row.late_m_per_s, device.true_twist().v.norm());
      row.added_N_per_s = std::max(row.added_N_per_s, std::abs(now_added - added) / kStep_s);
      if ((next - sent) * step < 0.0)
        row.to_and_fro_N = std::max(row.to_and_fro_N, std::min(std::abs(next - sent), std::abs(step)));
    }
    if (i >= 2500) {
      force_sum += std::abs(next);
      // Where the hand's spring and the wall's would balance.
      wanted_sum += 0.005 * stiffness * hand.stiffness_N_per_m / (stiffness + hand.stiffness_N_per_m);
    }
    step = next - sent;
    sent = next;
    added = now_added;
    Wrench F;
    F.f.x() = next;
    device.write(F);
  }
  row.felt_share = force_sum / wanted_sum;
  return row;
}

}  // namespace

std::vector<ControllerRow> bench_controllers(const std::function<void(const std::string&)>& progress) {
  std::vector<ControllerRow> rows;
  for (const char* name : {"premium-1.5-6dof", "sigma.7"})
    for (const double bounds : {0.2, 2.0})
      for (const double delay_s : {0.0, 1e-3}) {
        progress(fmt::format("{}, {:g} times the bound, delay {:g} ms", name, bounds, 1e3 * delay_s));
        for (const Maker& maker : kMakers) {
          SimulatedDeviceModel model = *simulated_device_preset(name);
          model.friction_N = 0.0;
          model.command_delay_s = delay_s;
          rows.push_back(run_controller(maker, model, "loose", bounds));
        }
      }
  return rows;
}

Table table_of(const std::vector<ControllerRow>& rows) {
  Table table;
  table.left = 3;
  table.rows.push_back({"controller", "device", "hand", "bounds", "delay ms", "still moves mm/s", "added N/s",
                        "to and fro N", "felt %"});
  for (const ControllerRow& row : rows)
    table.rows.push_back({row.controller, row.device, row.hand, fmt::format("{:g}", row.bounds),
                          fmt::format("{:g}", 1e3 * row.delay_s),
                          fmt::format("{:.2f}", 1e3 * row.late_m_per_s),
                          fmt::format("{:.1f}", row.added_N_per_s), fmt::format("{:.3f}", row.to_and_fro_N),
                          fmt::format("{:.0f}", 100.0 * row.felt_share)});
  return table;
}

nlohmann::ordered_json to_json(const ControllerRow& row) {
  return {{"controller", row.controller},
          {"device", row.device},
          {"hand", row.hand},
          {"bounds", row.bounds},
          {"delay_s", row.delay_s},
          {"late_m_per_s", row.late_m_per_s},
          {"added_N_per_s", row.added_N_per_s},
          {"to_and_fro_N", row.to_and_fro_N},
          {"felt_share", row.felt_share}};
}

}  // namespace tactum::bench
