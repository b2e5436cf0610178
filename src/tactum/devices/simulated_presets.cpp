/// The presets of simulated_device.h.
///
/// Force, torque, stiffness and workspace radius are those of CHAI3D's device tables where it has the device
/// (premium, touch, omega.6, sigma.7). Marked M: manufacturers' figures from memory, to be confirmed against
/// data sheets before anyone is quoted on them; this is all there is for the Virtuose, whose 450 mm is taken
/// as a diameter. Marked T: chosen by us as plausible, no source: all inertias, dampings and frictions, and
/// the angular steps of devices that are not marked M. They make a device of that class, not that device.

#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/nearest_word.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/math/types.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double degrees(double angle) { return angle * kPi / 180.0; }

SimulatedDeviceModel premium() {
  SimulatedDeviceModel m;
  m.name = "premium-1.5-6dof";
  m.max_force_N = 8.5;
  m.max_torque_Nm = 0.188;
  m.max_stiffness_N_per_m = 800.0;
  m.max_stiffness_Nm_per_rad = 0.3;
  m.workspace_radius_m = 0.12;
  m.encoder_step_m = 0.03e-3;          // M
  m.encoder_step_rad = degrees(0.02);  // T
  m.mass_kg = 0.10;                    // T
  m.inertia_kg_m2 = 1.0e-4;            // T
  m.damping_Ns_per_m = 0.05;           // T
  m.damping_Nms_per_rad = 1.0e-4;      // T
  m.friction_N = 0.04;                 // T
  m.friction_Nm = 1.0e-3;              // T
  return m;
}

SimulatedDeviceModel touch() {
  SimulatedDeviceModel m;
  m.name = "touch";
  m.max_force_N = 3.3;
  m.max_stiffness_N_per_m = 400.0;
  m.workspace_radius_m = 0.075;
  m.encoder_step_m = 0.055e-3;        // M
  m.encoder_step_rad = degrees(0.1);  // T
  m.mass_kg = 0.045;                  // T
  m.inertia_kg_m2 = 2.0e-5;           // T
  m.damping_Ns_per_m = 0.10;          // T
  m.damping_Nms_per_rad = 1.0e-4;     // T
  m.friction_N = 0.20;                // T
  m.friction_Nm = 1.0e-3;             // T
  return m;
}

SimulatedDeviceModel omega6() {
  SimulatedDeviceModel m;
  m.name = "omega.6";
  m.max_force_N = 12.0;
  m.max_stiffness_N_per_m = 5000.0;
  m.workspace_radius_m = 0.075;
  m.encoder_step_m = 0.01e-3;          // M
  m.encoder_step_rad = degrees(0.09);  // M
  m.mass_kg = 0.20;                    // T
  m.inertia_kg_m2 = 5.0e-5;            // T
  m.damping_Ns_per_m = 0.5;            // T
  m.damping_Nms_per_rad = 1.0e-4;      // T
  m.friction_N = 0.10;                 // T
  m.friction_Nm = 1.0e-3;              // T
  return m;
}

SimulatedDeviceModel sigma7() {
  SimulatedDeviceModel m;
  m.name = "sigma.7";
  m.max_force_N = 12.0;
  m.max_torque_Nm = 0.2;
  m.max_stiffness_N_per_m = 4000.0;
  m.max_stiffness_Nm_per_rad = 1.0;
  m.workspace_radius_m = 0.075;
  m.encoder_step_m = 0.0015e-3;         // M
  m.encoder_step_rad = degrees(0.013);  // M
  m.mass_kg = 0.30;                     // T
  m.inertia_kg_m2 = 2.0e-4;             // T
  m.damping_Ns_per_m = 0.5;             // T
  m.damping_Nms_per_rad = 5.0e-4;       // T
  m.friction_N = 0.10;                  // T
  m.friction_Nm = 1.0e-3;               // T
  return m;
}

SimulatedDeviceModel virtuose() {
  SimulatedDeviceModel m;
  m.name = "virtuose-6d";
  m.max_force_N = 35.0;                // M; also the saturation in a public wrapper
  m.max_torque_Nm = 3.0;               // M; 3.3 in the same wrapper
  m.max_stiffness_N_per_m = 2000.0;    // M
  m.max_stiffness_Nm_per_rad = 30.0;   // M
  m.workspace_radius_m = 0.225;        // M
  m.encoder_step_m = 0.01e-3;          // T
  m.encoder_step_rad = degrees(0.01);  // T
  m.mass_kg = 0.80;                    // T
  m.inertia_kg_m2 = 3.0e-3;            // T
  m.damping_Ns_per_m = 2.0;            // T
  m.damping_Nms_per_rad = 0.01;        // T
  m.friction_N = 0.50;                 // T
  m.friction_Nm = 0.02;                // T
  return m;
}

}  // namespace

const std::vector<SimulatedDeviceModel>& simulated_device_presets() {
  static const std::vector<SimulatedDeviceModel> table = {premium(), touch(), omega6(), sigma7(), virtuose()};
  return table;
}

Result<SimulatedDeviceModel> simulated_device_preset(const std::string& name) {
  constexpr std::string_view kKind = "simulated:";
  const std::string preset = name.starts_with(kKind) ? name.substr(kKind.size()) : name;
  std::vector<std::string> known;
  std::string names;
  for (const SimulatedDeviceModel& model : simulated_device_presets()) {
    if (model.name == preset) return model;
    known.push_back(model.name);
    names += (names.empty() ? "" : ", ") + model.name;
  }
  const std::string nearest = nearest_word(preset, known);
  return Error{"unknown simulated device", "'" + name + "'",
               nearest.empty() ? "one of " + names : "'" + nearest + "' (of " + names + ")", ""};
}

}  // namespace tactum::inline v0_1
