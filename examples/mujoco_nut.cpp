/// A nut of MuJoCo's world on a bolt of ours: a compliant hand there turns it, and lowers it by a tenth more
/// than its thread allows. Our exact contact takes it down by its pitch of 2 mm a turn all the same. MuJoCo's
/// own contact takes the convex hull of the nut, which has no hole.

#include <mujoco/mujoco.h>
#include <tactum/tactum.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>

namespace {

constexpr double kRate_Hz = 10000.0, kPitch_m = 0.002, kMass_kg = 0.03;

/// The nut in a compliant hand, without a shape: what it touches is not MuJoCo's to know.
mjModel* nut_of_mujoco(double z_m) {
  const std::string z = std::to_string(z_m);
  const std::string text = "<mujoco><option timestep='" + std::to_string(1.0 / kRate_Hz) +
                           "'/><worldbody><body name='hand' mocap='true' pos='0 0 " + z +
                           "'/><body name='nut' pos='0 0 " + z +
                           "'><freejoint/><inertial pos='0 0 0' mass='" + std::to_string(kMass_kg) +
                           "' diaginertia='4e-6 4e-6 6e-6'/></body></worldbody><equality><weld body1='hand' "
                           "body2='nut' solref='0.02 1'/></equality></mujoco>";
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "nut.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  char error[500] = "";
  mjModel* model = mj_loadXML("nut.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr) std::fprintf(stderr, "%s\n", error);
  return model;
}

}  // namespace

int main() {
  using namespace tactum;
  SceneDescription scene;
  scene.bodies = {{.name = "bolt",
                   .part = BoltPart{{.size = "M16", .length_m = 0.03, .facets_per_turn = 32}},
                   .joint = FixedJoint{}},
                  {.name = "nut",
                   .part = NutPart{{.size = "M16", .facets_per_turn = 32}},
                   .X_OP = {Mat3::Identity(), {0, 0, 0.012}}}};
  scene.tool = BodyTool{.body = "nut"};
  Scene built = std::move(*build_scene(scene));
  const Pose start = built.world.bodies[1].X_WB;
  DeviceInfo info;  // MuJoCo's body is no device: no force hurts it
  info.senses_rotation = info.actuates_force = info.actuates_torque = true;
  info.max_force_N = info.max_torque_Nm = info.max_stiffness_N_per_m = info.max_stiffness_Nm_per_rad = 1e6;
  FrameSettings settings = settings_for(info, kRate_Hz);
  settings.tool = built.settings.tool;
  settings.coupling = {1e5, 50.0, 60.0, 0.03};
  const auto contact = std::move(*Simulation::make(std::move(built.world), settings));

  mjModel* model = nut_of_mujoco(start.p.z());
  if (model == nullptr) return 1;
  mjData* data = mj_makeData(model);

  double turned_rad = 0.0, overlap_m = 0.0, off_m = 0.0;
  for (int i = 0; i < static_cast<int>(1.5 * kRate_Hz); ++i) {
    const double angle = -2.0 * std::numbers::pi * i / kRate_Hz;
    data->mocap_pos[2] = start.p.z() + 1.1 * kPitch_m * angle / (2.0 * std::numbers::pi);
    data->mocap_quat[0] = std::cos(0.5 * angle);
    data->mocap_quat[3] = std::sin(0.5 * angle);
    mj_kinematics(model, data);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->xmat + 18);
    contact->step(Pose{R, Eigen::Map<const Vec3>(data->xpos + 6)});
    const Wrench& F = contact->report().coupling;  // on the nut, about its centre of mass, world axes
    Eigen::Map<Vec3>(data->xfrc_applied + 12) = F.f;
    Eigen::Map<Vec3>(data->xfrc_applied + 15) = F.t;
    turned_rad += std::remainder(std::atan2(R(1, 0), R(0, 0)) - turned_rad, 2.0 * std::numbers::pi);
    overlap_m = std::max(overlap_m, -contact->report().min_distance_m);
    off_m = std::max(
        off_m, std::abs(data->xpos[8] - start.p.z() - kPitch_m * turned_rad / (2.0 * std::numbers::pi)));
    mj_step(model, data);
  }
  std::printf(
      "%.2f turns, %.3f mm down, %.3f mm off the thread at most; surfaces overlapped by %g mm at most\n",
      turned_rad / (2.0 * std::numbers::pi), 1e3 * (start.p.z() - data->xpos[8]), 1e3 * off_m,
      1e3 * overlap_m);
  mj_deleteData(data);
  mj_deleteModel(model);
  return turned_rad < -2.0 * std::numbers::pi && off_m < 1e-4 && overlap_m == 0.0 ? 0 : 1;
}
