#include "bench/mechanics_scene.h"

#include "tactum/mesh/make_part.h"

namespace tactum::bench {

int MechanicsScene::add(const Polytope& shape, const Pose& X_WB, const Twist& V_WB, const Joint& joint,
                        double ball_radius_m) {
  auto part = std::make_shared<const Part>(
      *part_from_clouds({{shape.vertices.begin(), shape.vertices.end()}}, {.about_center_of_mass = true}));
  motion.shapes.push_back({"", part->pieces.front(), {}});
  motion.ball_radius_m.push_back(ball_radius_m);
  return *motion.world.add({.part = std::move(part), .X_WP = X_WB, .V_WB = V_WB, .joint = joint});
}

int MechanicsScene::add_box(const Vec3& half_m, const Pose& X_WB, const Twist& V_WB, const Joint& joint) {
  const int body = add(make_box(half_m), X_WB, V_WB, joint);
  motion.shapes.back().box_half_m = half_m;
  return body;
}

int MechanicsScene::add_fixed_box(const Vec3& half_m, const Pose& X_WB) {
  return add_box(half_m, X_WB, {}, {.kind = JointKind::kFixed});
}

void MechanicsScene::incline(double slope_rad) {
  motion.world.gravity_W = kGravity * Vec3(std::sin(slope_rad), 0, -std::cos(slope_rad));
}

void run(MotionEngine& engine, double seconds) {
  for (long i = std::lround(seconds / kMechanicsStep_s); i > 0; --i) engine.step();
}

double mean_load_N(MotionEngine& engine, int fixed_body) {
  constexpr int kSteps = 100;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    engine.step();
    sum += engine.load_N(fixed_body);
  }
  return sum / kSteps;
}

double kinetic_energy(const Body& body, const Pose& X_WB, const Twist& V_WB) {
  return 0.5 * body.mass_kg * V_WB.v.squaredNorm() + 0.5 * V_WB.w.dot(angular_momentum(body, X_WB, V_WB));
}

Vec3 angular_momentum(const Body& body, const Pose& X_WB, const Twist& V_WB) {
  return X_WB.R * body.inertia_B * X_WB.R.transpose() * V_WB.w;
}

std::span<const MechanicsCase> mechanics_cases() {
  static const std::vector<MechanicsCase> cases = [] {
    std::vector<MechanicsCase> all;
    for (auto* of_kind : {contact_cases, impact_cases, turning_cases, grasped_cases})
      for (MechanicsCase& at : of_kind()) all.push_back(std::move(at));
    return all;
  }();
  return cases;
}

}  // namespace tactum::bench
