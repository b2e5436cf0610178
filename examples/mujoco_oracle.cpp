/// Exact contact for a body of another simulator: a compliant hand in MuJoCo's world puts a peg into a hole
/// that is 7 um wider, 0.4 mm beside its middle. On its own MuJoCo takes the convex hull of the block, which
/// has no hole. With ours, the peg of MuJoCo's world is the hand of a scene, and feels what that feels.

#include "mujoco_contact.h"

using namespace tactum;

static std::string mesh_text(const Body& body) {
  std::string text = fmt::format("<mesh name='{}' vertex='", body.name);
  for (const Vec3& v : body.part->surface.vertices) text += fmt::format("{} {} {} ", v.x(), v.y(), v.z());
  return text + "'/>";
}

static Scene fit() {
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
static double insert(bool own_contact) {
  Scene scene = fit();
  const Body block = scene.world.bodies[0], peg = scene.world.bodies[1];
  const double start_m = peg.X_WB.p.z();
  const std::string asset = fmt::format("<asset>{}{}</asset>", mesh_text(block), mesh_text(peg));
  const Vec3 b = block.X_WB.p;
  const std::string touches = own_contact ? "1" : "0";
  const std::string classes =
      fmt::format("<default><geom type='mesh' contype='{0}' conaffinity='{0}'/></default>", touches);
  const std::string still =
      fmt::format("<worldbody><geom mesh='block' pos='{} {} {}'/></worldbody>", b.x(), b.y(), b.z());
  MujocoWorld world(classes + asset + still, peg, "<geom mesh='peg'/>");
  ExactContact contact(std::move(scene));
  double overlap_m = 0.0;
  for (int i = 0; i < static_cast<int>(kRate_Hz); ++i) {
    world.data->mocap_pos[2] = start_m - std::min(0.034, 0.05 * i / kRate_Hz);
    if (!own_contact) world.push(contact.wrench_at(world.pose()));
    mj_step(world.model, world.data);
    for (int c = 0; c < world.data->ncon; ++c) overlap_m = std::max(overlap_m, -world.data->contact[c].dist);
  }
  overlap_m = std::max(overlap_m, contact.overlap_m);
  const double deep_m = 0.03 - (world.pose().p.z() - (start_m - 0.033));
  std::printf("%-22s the tip is %.3f mm deep; surfaces overlapped by %.3f mm at most\n",
              own_contact ? "MuJoCo's own contact:" : "Tactum's contact:", 1e3 * deep_m, 1e3 * overlap_m);
  return own_contact || overlap_m == 0.0 ? deep_m : 0.0;
}

int main() {
  const double alone_m = insert(true), with_ours_m = insert(false);
  return alone_m < 0.02 && std::abs(with_ours_m - 0.03) < 5e-5 ? 0 : 1;  // pressed on by the hand
}
