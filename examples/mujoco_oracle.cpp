/// Exact contact for a body of another simulator: a compliant hand in MuJoCo's world puts a peg into a hole
/// that is 7 um wider, 0.4 mm beside its middle. On its own MuJoCo takes the convex hull of the block, which
/// has no hole. With ours, the peg of MuJoCo's world is the hand of a scene, and feels what that feels.

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <tactum/tactum.h>

#include <cstring>

namespace {

using namespace tactum;
constexpr double kRate_Hz = 10000.0;

std::string mesh_text(const Body& body) {
  std::string text = fmt::format("<mesh name='{}' vertex='", body.name);
  for (const Vec3& v : body.part->surface.vertices) text += fmt::format("{} {} {} ", v.x(), v.y(), v.z());
  return text + "'/>";
}

/// The same two bodies there; where `own_contact` is false nothing touches.
mjModel* mujoco_world(const Body& block, const Body& peg, bool own_contact) {
  const Vec3 b = block.X_WB.p, p = peg.X_WB.p, I = peg.inertia_B.diagonal();
  const std::string text = fmt::format(
      "<mujoco><option timestep='{}'/><default><geom type='mesh' contype='{}' conaffinity='{}'/></default>"
      "<asset>{}{}</asset><worldbody><geom mesh='block' pos='{} {} {}'/><body name='hand' mocap='true' "
      "pos='{} {} "
      "{}'/><body name='peg' pos='{} {} {}'><freejoint/><inertial pos='0 0 0' mass='{}' diaginertia='{} {} "
      "{}'/>"
      "<geom mesh='peg'/></body></worldbody><equality><weld body1='hand' body2='peg' solref='0.02 "
      "1'/></equality>"
      "</mujoco>",
      1.0 / kRate_Hz, int(own_contact), int(own_contact), mesh_text(block), mesh_text(peg), b.x(), b.y(),
      b.z(), p.x(), p.y(), p.z(), p.x(), p.y(), p.z(), peg.mass_kg, I.x(), I.y(), I.z());
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "world.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  char error[500] = "";
  mjModel* model = mj_loadXML("world.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr) std::fprintf(stderr, "%s\n", error);
  return model;
}

Scene fit() {
  SceneDescription scene;
  scene.bodies = {
      {.name = "block",
       .part = HoleBlockPart{.block = {0, 0.025, 0.025, 7e-6, 0.025, 0.03, 0.005}},
       .joint = FixedJoint{}},
      {.name = "peg",
       .part = PegPart{.peg = {0, 0.025, 0.025, 0.06, 0.001}},
       .X_OP = {Mat3::Identity(), {0.0003, -0.0002, 0.033}}}};  // 3 mm above the block, beside its hole
  scene.tool = BodyTool{.body = "peg"};
  return std::move(*build_scene(scene));
}

/// The hand goes down by 34 mm in 0.7 s, and waits; returns how deep the tip is below the block's top [m].
double insert(bool own_contact) {
  Scene scene = fit();
  const Body block = scene.world.bodies[0], peg = scene.world.bodies[1];
  DeviceInfo info;  // MuJoCo's body is no device: no force hurts it
  info.senses_rotation = info.actuates_force = info.actuates_torque = true;
  info.max_force_N = info.max_torque_Nm = info.max_stiffness_N_per_m = info.max_stiffness_Nm_per_rad = 1e6;
  FrameSettings settings = settings_for(info, kRate_Hz);
  settings.tool = scene.settings.tool;
  settings.coupling = {1e5, 50.0, 60.0, 0.03};  // 4 um of stretch for its weight
  auto contact = std::move(*Simulation::make(std::move(scene.world), settings));

  mjModel* model = mujoco_world(block, peg, own_contact);
  if (model == nullptr) return 0.0;
  mjData* data = mj_makeData(model);
  mj_forward(model, data);
  double overlap_m = 0.0;
  for (int i = 0; i < static_cast<int>(kRate_Hz); ++i) {
    data->mocap_pos[2] = peg.X_WB.p.z() - std::min(0.034, 0.05 * i / kRate_Hz);
    if (!own_contact) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->xmat + 18);
      contact->step(Pose{R, Eigen::Map<const Vec3>(data->xpos + 6)});
      const Wrench& F = contact->report().coupling;  // on the body, about its centre of mass, world axes
      Eigen::Map<Vec3>(data->xfrc_applied + 12) = F.f;
      Eigen::Map<Vec3>(data->xfrc_applied + 15) = F.t;
      overlap_m = std::max(overlap_m, -contact->report().min_distance_m);
    }
    mj_step(model, data);
    for (int c = 0; c < data->ncon; ++c) overlap_m = std::max(overlap_m, -data->contact[c].dist);
  }
  const double deep_m = 0.03 - (data->xpos[8] - (peg.X_WB.p.z() - 0.033));
  std::printf("%-22s the tip is %.3f mm deep; surfaces overlapped by %.3f mm at most\n",
              own_contact ? "MuJoCo's own contact:" : "Tactum's contact:", 1e3 * deep_m, 1e3 * overlap_m);
  mj_deleteData(data);
  mj_deleteModel(model);
  return own_contact || overlap_m == 0.0 ? deep_m : 0.0;
}

}  // namespace

int main() {
  const double alone_m = insert(true), with_ours_m = insert(false);
  return alone_m < 0.02 && std::abs(with_ours_m - 0.03) < 5e-5 ? 0 : 1;  // pressed on by the hand
}
