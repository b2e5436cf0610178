#pragma once
/// Bodies that touch, as a contact problem of the iterative solvers, from frame to frame.

#include <vector>

#include "tactum/dynamics/friction_anchors.h"
#include "tactum/dynamics/island_forces.h"

namespace tactum::testing {

inline constexpr double kStep = 1e-3;
inline constexpr double kSkin = 1e-7;

/// Bodies of 10 g, or of a mass each; the last one does not move. With the memory from frame to frame.
struct Pile {
  std::vector<Body> bodies;
  std::vector<Pose> X_WB;
  std::vector<Twist> V;
  std::vector<ContactRow> rows;
  ContactProblem problem;
  IslandForces forces;
  RowMemory memory;
  FrictionAnchors anchors;

  explicit Pile(std::size_t moving)
      : bodies(moving + 1),
        X_WB(moving + 1),
        V(moving + 1),
        problem(64, moving + 1),
        forces(64, moving + 1),
        memory(64),
        anchors(64) {
    for (Body& body : bodies) {
      body.mass_kg = 0.01;
      body.inertia_B = 1e-6 * Mat3::Identity();
    }
    bodies.back().joint.kind = JointKind::kFixed;
  }
  /// A contact of two bodies, open by `gap_m` beyond the skin.
  void touch(int a, int b, const Vec3& p_W, const Vec3& n_BA_W, double gap_m, double friction = 0.3) {
    ContactRow row;
    row.body_a = a;
    row.body_b = b;
    row.p_W = p_W;
    row.n_BA_W = n_BA_W;
    row.distance = kSkin + gap_m;
    row.skin_m = kSkin;
    row.asked = asked_of(row, opening_share(kStep));
    row.friction = friction;
    rows.push_back(row);
  }
  RowsInProblem set(bool exact) {
    problem.clear();
    for (std::size_t i = 0; i + 1 < bodies.size(); ++i)
      problem.add_body({static_cast<int>(i), bodies[i], X_WB[i]}, X_WB[i].p,
                       inertial_metric(bodies[i], X_WB[i], kStep), to_vector(V[i] * kStep), kStep);
    problem.add_joint_rows(exact);
    const RowsInProblem contacts{rows, problem.rows()};
    for (const ContactRow& row : rows) problem.add_row(row.body_a, row.body_b, push_of(row), row.asked);
    return contacts;
  }
  RowsInProblem begin() {
    const RowsInProblem contacts = set(false);
    memory.begin();
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].state = memory.recall(i);
    forces.begin(contacts, X_WB, anchors, memory, kStep, problem);
    return contacts;
  }
  void end(const RowsInProblem& contacts) {
    forces.keep_anchors(contacts, X_WB, problem, anchors);
    anchors.end_frame([](int) { return true; });
    forces.end(rows, memory);
  }
  /// A frame whose forces `solve` finds.
  template <class Solve>
  auto frame(Solve&& solve) {
    const RowsInProblem contacts = begin();
    const auto result = solve(*this);
    end(contacts);
    return result;
  }
  Vec3 speed(int body) const { return Vec3(problem.displacement(body).head<3>()) / kStep; }
};

/// A stack of boxes of 20 x 20 x 10 mm on a floor that leans, with what weight does to them in a step. The
/// body behind the last box is the floor.
inline Pile leaning_stack(std::size_t boxes, double lean_rad, double friction) {
  Pile pile(boxes);
  const Vec3 gravity(9.81 * std::sin(lean_rad), 0.0, -9.81 * std::cos(lean_rad));
  for (std::size_t i = 0; i < boxes; ++i) {
    pile.X_WB[i].p = Vec3(0, 0, 0.005 + 0.01 * static_cast<double>(i));
    pile.V[i].v = gravity * kStep;
    const int below = i == 0 ? static_cast<int>(boxes) : static_cast<int>(i) - 1;
    for (const double x : {-0.01, 0.01})
      for (const double y : {-0.01, 0.01})
        pile.touch(static_cast<int>(i), below, Vec3(x, y, 0.01 * static_cast<double>(i)), Vec3::UnitZ(), 0.0,
                   friction);
  }
  return pile;
}

}  // namespace tactum::testing
