#include "tactum/haptics/coupling_gains.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "tactum/devices/simulated_device.h"

namespace tactum::coupling_gains_test {
namespace {

DeviceInfo info_of(const std::string& preset) {
  return SimulatedDevice(*simulated_device_preset(preset), no_hand(), nullptr).info();
}

/// The damping that [Colgate and Schenkel 1994] require, frequency by frequency:
///   b > T/2 / (1 - cos wT)  Re{ (1 - z^-1) H(z) },   z = exp(j w T),   H = (K + B (1 - z^-1) / T) z^-d
double damping_by_frequencies(double K, double B, double T, int delay_periods) {
  double most = 0.0;
  for (int i = 1; i <= 20000; ++i) {
    const double angle = kPi * i / 20000;
    const std::complex<double> z = std::polar(1.0, angle);
    const std::complex<double> H = (K + B * (1.0 - 1.0 / z) / T) * std::pow(z, -delay_periods);
    most = std::max(most, 0.5 * T / (1.0 - std::cos(angle)) * ((1.0 - 1.0 / z) * H).real());
  }
  return most;
}

TEST(CouplingGains, TheBoundIsThatOfEveryFrequency) {
  for (const double T : {1e-3, 2.5e-4})
    for (const int delay : {0, 1, 2, 8}) {
      const double bound = damping_needed(800.0, 0.0, T, delay * T);
      EXPECT_NEAR(damping_by_frequencies(800.0, 0.0, T, delay), bound, 1e-3 * bound) << T << " " << delay;
      for (const double B : {0.2, 1.0, 5.0}) {
        const double needed = damping_by_frequencies(800.0, B, T, delay);
        EXPECT_LE(needed, damping_needed(800.0, B, T, delay * T) * (1 + 1e-12))
            << T << " " << delay << " " << B;
        if (delay == 0) {
          EXPECT_NEAR(needed, damping_needed(800.0, B, T, 0.0), 1e-3 * needed) << T << " " << B;
        }
      }
    }
}

TEST(CouplingGains, TheStiffestSpringNeedsAllTheDampingThereIs) {
  EXPECT_DOUBLE_EQ(stiffness_allowed(0.05, 0.0, 1e-3, 0.0), 100.0);
  EXPECT_DOUBLE_EQ(stiffness_allowed(0.05, 0.0, 1e-3, 0.5e-3), 50.0);
  EXPECT_DOUBLE_EQ(damping_needed(stiffness_allowed(3.0, -0.5, 1e-3, 2e-3), 0.5, 1e-3, 2e-3), 3.0);
  EXPECT_EQ(stiffness_allowed(0.05, 0.06, 1e-3, 0.0), 0.0);
}

TEST(CouplingGains, EveryPresetGetsWhatALooseHandAllows) {
  for (const SimulatedDeviceModel& model : simulated_device_presets())
    for (const double rate_Hz : {1000.0, 4000.0}) {
      const DeviceInfo info = info_of(model.name);
      const CouplingGains gains = coupling_gains(info, rate_Hz);
      const Coupling& c = gains.coupling;
      SCOPED_TRACE(model.name + " " + std::to_string(rate_Hz));
      const double hand = hand_model("loose")->damping_Ns_per_m;
      EXPECT_LE(2.0 * c.stiffness_N_per_m,
                (model.damping_Ns_per_m + hand - c.damping_Ns_per_m) * 2 * rate_Hz);
      EXPECT_LE(c.stiffness_N_per_m, model.max_stiffness_N_per_m);
      EXPECT_LE(c.stiffness_N_per_m * model.encoder_step_m / 2, model.friction_N);
      EXPECT_DOUBLE_EQ(gains.translation.alone, model.damping_Ns_per_m * 2 * rate_Hz);
      EXPECT_GE(c.stiffness_N_per_m, 400.0) << "something to feel";
      if (model.max_torque_Nm > 0.0) {
        EXPECT_LE(c.stiffness_Nm_per_rad, model.max_stiffness_Nm_per_rad);
        EXPECT_LE(c.stiffness_Nm_per_rad, gains.rotation.loose_hand);
      } else {
        EXPECT_TRUE(std::isinf(gains.rotation.alone)) << "there is no loop around it";
        EXPECT_EQ(c.damping_Nms_per_rad, 0.0);
        EXPECT_GT(c.stiffness_Nm_per_rad, 0.03 * c.stiffness_N_per_m);
      }
    }
}

TEST(CouplingGains, DelayCostsStiffness) {
  DeviceInfo info = info_of("virtuose-6d");
  info.max_stiffness_N_per_m = info.max_stiffness_Nm_per_rad = 0.0;  // not given
  const CouplingGains prompt = coupling_gains(info, 1000.0);
  info.handle.delay_s = 0.5e-3;
  const CouplingGains delayed = coupling_gains(info, 1000.0);
  EXPECT_NEAR(prompt.coupling.stiffness_N_per_m, 2 * delayed.coupling.stiffness_N_per_m, 1e-9);
  EXPECT_NEAR(prompt.coupling.stiffness_Nm_per_rad, 2 * delayed.coupling.stiffness_Nm_per_rad, 1e-9);
}

/// How a free handle of a mass swings on a coupling whose other end is fixed, in steps of a period: the
/// motors' force stands still meanwhile and is that of some periods before. Its size in the last tenth of the
/// run beside that in the first; above 1 it grows.
double growth_of_free_handle(double mass, double K, double B, double T, int delay_periods) {
  std::vector<double> forces(static_cast<std::size_t>(delay_periods) + 1, 0.0);
  double x = 0.0, v = 1.0, first = 0.0, last = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    forces[static_cast<std::size_t>(i) % forces.size()] = -K * x - B * v;
    const double a = forces[static_cast<std::size_t>(i + 1) % forces.size()] / mass;  // the oldest
    x += v * T + 0.5 * a * T * T;
    v += a * T;
    const double size = K * x * x + mass * v * v;
    if (i < kSteps / 10) first = std::max(first, size);
    if (i >= kSteps - kSteps / 10) last = std::max(last, size);
    if (!(size < 1e100)) return size;
  }
  return last / first;
}

TEST(CouplingGains, TheDamperIsWhatTheMassOfAFreeHandleAllows) {
  for (const double mass : {0.001, 0.05, 0.8})
    for (const double T : {1e-3, 2.5e-4})
      for (const int delay : {0, 1, 2, 5, 20}) {
        const double most = damper_allowed(mass, T, delay * T);
        EXPECT_LT(growth_of_free_handle(mass, 0.0, 0.98 * most, T, delay), 1.0) << mass << " " << delay;
        EXPECT_GT(growth_of_free_handle(mass, 0.0, 1.02 * most, T, delay), 1.0) << mass << " " << delay;
      }
  EXPECT_TRUE(std::isinf(damper_allowed(0.0, 1e-3, 0.0))) << "an unknown mass bounds nothing";
}

TEST(CouplingGains, TheDamperChosenForALightHandleIsWeaker) {
  DeviceInfo info = info_of("virtuose-6d");
  const Coupling heavy = coupling_gains(info, 1000.0).coupling;
  EXPECT_DOUBLE_EQ(heavy.damping_Ns_per_m, 0.1 * hand_model("loose")->damping_Ns_per_m);
  for (const double delay_s : {0.0, 0.002, 0.020})
    for (const double mass_kg : {0.001, 0.003, 0.010}) {
      info.handle.delay_s = delay_s;
      info.handle.mass_kg = mass_kg;
      info.handle.inertia_kg_m2 = 0.001 * mass_kg;
      const CouplingGains gains = coupling_gains(info, 1000.0);
      const Coupling& light = gains.coupling;
      EXPECT_LE(light.damping_Ns_per_m, 0.5 * gains.translation.damper * (1 + 1e-12));
      EXPECT_LE(light.damping_Nms_per_rad, 0.5 * gains.rotation.damper * (1 + 1e-12));
      const int delay = static_cast<int>(std::lround(1000.0 * delay_s));
      EXPECT_LT(growth_of_free_handle(mass_kg, 0.0, light.damping_Ns_per_m, 1e-3, delay), 1.0);
      EXPECT_LT(growth_of_free_handle(info.handle.inertia_kg_m2, 0.0, light.damping_Nms_per_rad, 1e-3, delay),
                1.0);
    }
  EXPECT_LT(coupling_gains(info, 1000.0).coupling.damping_Nms_per_rad, heavy.damping_Nms_per_rad);
}

TEST(CouplingGains, ADamperThatSwingsIsTold) {
  DeviceInfo info = info_of("virtuose-6d");
  const Coupling coupling{.damping_Ns_per_m = 1.0};
  EXPECT_NE(stability_of(coupling, info, 1000.0), Stability::kUncertain);
  info.handle.mass_kg = 0.0004;
  EXPECT_EQ(stability_of(coupling, info, 1000.0), Stability::kUncertain);
  const std::string sentence = margin_sentence(coupling, info, 1000.0);
  EXPECT_NE(sentence.find("Its damper is not weak enough for the handle: 1 N s/m on 0.0004 kg (limit 0.8)"),
            std::string::npos)
      << sentence;
  EXPECT_NE(sentence.find("may swing on this device when it is let go"), std::string::npos) << sentence;
  info.handle.mass_kg = info.handle.inertia_kg_m2 = 0.0;
  EXPECT_EQ(margin_sentence(coupling, info, 1000.0).find("damper"), std::string::npos);
}

TEST(CouplingGains, ADeviceNobodyKnowsAnythingOfGetsWhatTheHandAloneAllows) {
  DeviceInfo info;
  info.actuates_force = info.actuates_torque = true;
  info.max_force_N = 10.0;
  const CouplingGains gains = coupling_gains(info, 1000.0);
  EXPECT_EQ(gains.translation.alone, 0.0);
  EXPECT_NEAR(gains.coupling.stiffness_N_per_m, 0.5 * (3.0 - 0.3) * 2000, 1e-9);
}

TEST(CouplingGains, TheMarginIsToldInWords) {
  const std::string premium = margin_sentence(Coupling{}, info_of("premium-1.5-6dof"), 1000.0);
  EXPECT_EQ(
      premium,
      "The coupling of 600 N/m and 0.3 N m/rad is stable in any hand that holds the device; let go, it may "
      "buzz (limit 100 N/m and 0.2 N m/rad); its stiffness is lowered where it does. Its "
      "damper is weak enough for the handle: 1 N s/m on 0.1 kg (limit 200) and 0.0005 N m s/rad on 0.0001 kg "
      "m^2 (limit 0.2). See docs/algorithms/stability.md.");
  const std::string strong = margin_sentence(Coupling{}, info_of("virtuose-6d"), 1000.0);
  EXPECT_NE(strong.find("stable in any hand that holds the device, and when it is let go."),
            std::string::npos)
      << strong;
  const std::string stiff =
      margin_sentence({.stiffness_N_per_m = 5000.0}, info_of("premium-1.5-6dof"), 1000.0);
  EXPECT_NE(stiff.find("too stiff for this device: in a loose hand it may buzz (limit 4100 N/m"),
            std::string::npos)
      << stiff;
  for (const std::string& text : {premium, strong, stiff})
    EXPECT_EQ(text.find('%'), std::string::npos) << text;
  const std::string touch = margin_sentence(Coupling{}, info_of("touch"), 1000.0);
  EXPECT_NE(touch.find("sends no torque"), std::string::npos) << touch;
}

TEST(CouplingGains, StabilityIsWhatTheMarginSays) {
  const auto stability = [](const char* device, double stiffness_N_per_m) {
    return stability_of({.stiffness_N_per_m = stiffness_N_per_m}, info_of(device), 1000.0);
  };
  EXPECT_EQ(stability("virtuose-6d", 600.0), Stability::kAlways);
  EXPECT_EQ(stability("premium-1.5-6dof", 600.0), Stability::kInHand);
  EXPECT_EQ(stability("premium-1.5-6dof", 5000.0), Stability::kUncertain);
  EXPECT_EQ(stability("touch", 600.0), Stability::kInHand);  // what it cannot turn has no bound there
}

TEST(PortSettings, AreWhatTheDeviceTellsOfItself) {
  for (const SimulatedDeviceModel& model : simulated_device_presets()) {
    const PortSettings port = port_settings(info_of(model.name));
    EXPECT_TRUE(port.keeps_balance);
    EXPECT_EQ(port.actuates_torque, model.max_torque_Nm > 0.0);
    EXPECT_EQ(port.damping_Ns_per_m, model.damping_Ns_per_m);
    EXPECT_EQ(port.friction_Nm, model.friction_Nm);
    EXPECT_EQ(port.delay_s, model.command_delay_s);
  }
}

}  // namespace
}  // namespace tactum::coupling_gains_test
