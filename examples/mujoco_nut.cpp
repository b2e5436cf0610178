/// A nut of MuJoCo's world on a bolt of ours: a compliant hand there turns it, and lowers it by a tenth more
/// than its thread allows. Our exact contact takes it down by its pitch of 2 mm a turn all the same. MuJoCo's
/// own contact takes the convex hull of the nut, which has no hole.

#include <cmath>
#include <numbers>

#include "mujoco_contact.h"

int main() {
  using namespace tactum;
  constexpr double kPitch_m = 0.002, kTurn_rad = 2.0 * std::numbers::pi;
  SceneDescription description;
  description.bodies = {{.name = "bolt",
                         .part = BoltPart{{.size = "M16", .length_m = 0.03, .facets_per_turn = 32}},
                         .joint = FixedJoint{}},
                        {.name = "nut",
                         .part = NutPart{{.size = "M16", .facets_per_turn = 32}},
                         .X_OP = {Mat3::Identity(), {0, 0, 0.012}}}};
  description.tool = BodyTool{.body = "nut"};
  Scene scene = std::move(*build_scene(description));
  const double start_m = scene.world.bodies[1].X_WB.p.z();
  MujocoWorld world("", scene.world.bodies[1],
                    "");  // without a shape: what it touches is not MuJoCo's to know
  ExactContact contact(std::move(scene));

  double turned_rad = 0.0, off_m = 0.0;
  for (int i = 0; i < static_cast<int>(1.5 * kRate_Hz); ++i) {
    const double angle_rad = -kTurn_rad * i / kRate_Hz;
    world.data->mocap_pos[2] = start_m + 1.1 * kPitch_m * angle_rad / kTurn_rad;
    world.data->mocap_quat[0] = std::cos(0.5 * angle_rad);
    world.data->mocap_quat[3] = std::sin(0.5 * angle_rad);
    mj_kinematics(world.model, world.data);
    const Pose X = world.pose();
    world.push(contact.wrench_at(X));
    turned_rad += std::remainder(std::atan2(X.R(1, 0), X.R(0, 0)) - turned_rad, kTurn_rad);
    off_m = std::max(off_m, std::abs(X.p.z() - start_m - kPitch_m * turned_rad / kTurn_rad));
    mj_step(world.model, world.data);
  }
  std::printf(
      "%.2f turns, %.3f mm down, %.3f mm off the thread at most; surfaces overlapped by %g mm at most\n",
      turned_rad / kTurn_rad, 1e3 * (start_m - world.pose().p.z()), 1e3 * off_m, 1e3 * contact.overlap_m);
  return turned_rad < -kTurn_rad && off_m < 1e-4 && contact.overlap_m == 0.0 ? 0 : 1;
}
