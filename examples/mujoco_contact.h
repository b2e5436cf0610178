#pragma once
/// What the examples with MuJoCo have in common: a compliant hand in its world leads a body, which our exact
/// contact pushes.

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <tactum/tactum.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

inline constexpr double kRate_Hz = 10000.0;
inline constexpr int kLed = 2;  // number of the led body in MuJoCo's world, behind the hand

/// A world of MuJoCo with its own `elements`, the hand, and the body that a yielding weld holds in it.
class MujocoWorld {
 public:
  MujocoWorld(const std::string& elements, const tactum::Body& led, const std::string& geoms) {
    const tactum::Vec3 p = led.X_WB.p, I = led.inertia_B.diagonal();
    const std::string text = fmt::format(
        "<mujoco><option timestep='{}'/>{}<worldbody><body name='hand' mocap='true' pos='{} {} {}'/>"
        "<body name='led' pos='{} {} {}'><freejoint/><inertial pos='0 0 0' mass='{}' diaginertia='{} {} "
        "{}'/>{}"
        "</body></worldbody><equality><weld body1='hand' body2='led' solref='0.02 1'/></equality></mujoco>",
        1.0 / kRate_Hz, elements, p.x(), p.y(), p.z(), p.x(), p.y(), p.z(), led.mass_kg, I.x(), I.y(), I.z(),
        geoms);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "world.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
    char error[500] = "";
    model = mj_loadXML("world.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model == nullptr) throw std::runtime_error(error);
    data = mj_makeData(model);
    mj_forward(model, data);
  }
  ~MujocoWorld() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  MujocoWorld(const MujocoWorld&) = delete;
  MujocoWorld& operator=(const MujocoWorld&) = delete;

  /// Where the led body is.
  tactum::Pose pose() const {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->xmat + 9 * kLed);
    return {R, Eigen::Map<const tactum::Vec3>(data->xpos + 3 * kLed)};
  }
  void push(const tactum::Wrench& F) {
    Eigen::Map<tactum::Vec3>(data->xfrc_applied + 6 * kLed) = F.f;
    Eigen::Map<tactum::Vec3>(data->xfrc_applied + 6 * kLed + 3) = F.t;
  }

  mjModel* model = nullptr;
  mjData* data = nullptr;
};

/// A scene of ours, whose hand is MuJoCo's body. It is stiff, since no force hurts that: 1 N stretches the
/// coupling by 10 um.
class ExactContact {
 public:
  explicit ExactContact(tactum::Scene scene) {
    tactum::DeviceInfo info;
    info.senses_rotation = info.actuates_force = info.actuates_torque = true;
    info.max_force_N = info.max_torque_Nm = 1e6;
    info.max_stiffness_N_per_m = info.max_stiffness_Nm_per_rad = 1e6;
    tactum::FrameSettings settings = tactum::settings_for(info, kRate_Hz);
    settings.tool = scene.settings.tool;
    settings.coupling = {1e5, 50.0, 60.0, 0.03};
    simulation_ = std::move(*tactum::Simulation::make(std::move(scene.world), settings));
  }
  /// The wrench on the body at this pose, about its centre of mass, in the axes of the world.
  const tactum::Wrench& wrench_at(const tactum::Pose& X_WB) {
    simulation_->step(X_WB);
    overlap_m = std::max(overlap_m, -simulation_->report().min_distance_m);
    return simulation_->report().coupling;
  }

  double overlap_m = 0.0;  ///< of surfaces, the most so far

 private:
  std::unique_ptr<tactum::Simulation> simulation_;
};
