/// What hangs in something, lies in it or sticks in it is pulled, dropped, shaken and thrown at random, held
/// and free: nothing crosses, no link is lost or made. The judge knows triangles and topology only.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/judged.h"
#include "support/sample_meshes.h"
#include "support/solid_box.h"
#include "support/surface_shapes.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::entangled_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]
constexpr double kDensity_kg_per_m3 = 7800.0;

enum class Kind { kRings, kHooks, kChain, kCup, kSheet, kCombs };
enum class Deed { kPull, kDrop, kShake, kThrow };

constexpr std::array<const char*, 6> kKinds{"Rings", "Hooks", "Chain", "Cup", "Sheet", "Combs"};
constexpr std::array<const char*, 4> kDeeds{"pulled", "dropped", "shaken", "thrown"};

Vec3 some_vector(Random& random, double length) {
  Vec3 v;
  do v = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  while (v.norm() > 1.0);
  return length * v;
}

/// A wire along a line, closed by a corner at either end.
TriangleMesh wire_mesh(const std::vector<Vec3>& line, double radius, int sides) {
  TriangleMesh mesh;
  const int rows = static_cast<int>(line.size());
  const auto at = [&](int row, int k) { return row * sides + k % sides; };
  for (int row = 0; row < rows; ++row) {
    const Vec3 along = (line[std::min(row + 1, rows - 1)] - line[std::max(row - 1, 0)]).normalized();
    const Vec3 across = Vec3::UnitY();  // the lines lie in the plane y = 0
    const Vec3 out = across.cross(along);
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * kPi * k / sides;
      mesh.vertices.push_back(line[row] + radius * (std::cos(angle) * out + std::sin(angle) * across));
    }
  }
  for (int row = 0; row + 1 < rows; ++row)
    for (int k = 0; k < sides; ++k) {
      mesh.triangles.push_back({at(row, k), at(row, k + 1), at(row + 1, k + 1)});
      mesh.triangles.push_back({at(row, k), at(row + 1, k + 1), at(row + 1, k)});
    }
  for (const int row : {0, rows - 1}) {
    const int tip = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(line[row]);
    for (int k = 0; k < sides; ++k) {
      Triangle t{at(row, k + 1), at(row, k), tip};
      if (row > 0) std::swap(t[0], t[1]);
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

/// Three quarters of a circle about y, open above on one side, on a straight shank.
TriangleMesh hook_mesh() {
  constexpr double kRadius = 0.015;
  std::vector<Vec3> line{{0, 0, kRadius + 0.03}, {0, 0, kRadius + 0.015}};
  for (int i = 0; i <= 14; ++i) {
    const double angle = 0.5 * kPi - 1.5 * kPi * i / 14.0;  // from above, by +x, down, to -x
    line.push_back(kRadius * Vec3(std::cos(angle), 0, std::sin(angle)));
  }
  return wire_mesh(line, 0.003, 8);
}

/// The cells of a grid that are filled, as one surface: x varies fastest.
struct Blocks {
  std::vector<double> x, y, z;  // where the grid's planes are [m]
  std::vector<char> filled;

  TriangleMesh mesh() const {
    const int n[3] = {int(x.size()) - 1, int(y.size()) - 1, int(z.size()) - 1};
    const auto is_filled = [&](std::array<int, 3> c) {
      for (int axis = 0; axis < 3; ++axis)
        if (c[axis] < 0 || c[axis] >= n[axis]) return false;
      return filled[c[0] + n[0] * (c[1] + n[1] * c[2])] != 0;
    };
    TriangleMesh mesh;
    std::vector<int> number((n[0] + 1) * (n[1] + 1) * (n[2] + 1), -1);
    const auto corner = [&](std::array<int, 3> c) {
      int& known = number[c[0] + (n[0] + 1) * (c[1] + (n[1] + 1) * c[2])];
      if (known < 0) {
        known = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back({x[c[0]], y[c[1]], z[c[2]]});
      }
      return known;
    };
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i)
          for (int axis = 0; is_filled({i, j, k}) && axis < 3; ++axis)
            for (const int side : {0, 1}) {
              std::array<int, 3> beside{i, j, k};
              beside[axis] += side == 1 ? 1 : -1;
              if (is_filled(beside)) continue;
              std::array<int, 3> a{i, j, k};
              a[axis] += side;
              std::array<int, 3> b = a, c = a, d = a;
              const int u = (axis + 1) % 3, v = (axis + 2) % 3;
              ++b[u], ++c[u], ++c[v], ++d[v];
              if (side == 0) std::swap(b, d);
              mesh.triangles.push_back({corner(a), corner(b), corner(c)});
              mesh.triangles.push_back({corner(a), corner(c), corner(d)});
            }
    return mesh;
  }
};

constexpr double kCupInner = 0.01, kCupWall = 0.0005, kCupHeight = 0.02;  // [m]
constexpr double kBall = 0.003;                                           // radius [m]

/// A square cup, open above, that stands on z = 0 with its floor below.
TriangleMesh cup_mesh() {
  const std::vector<double> side{-kCupInner - kCupWall, -kCupInner, kCupInner, kCupInner + kCupWall};
  Blocks cup{side, side, {-kCupWall, 0.0, kCupHeight}, std::vector<char>(18, 1)};
  cup.filled[9 + 4] = 0;
  return cup.mesh();
}

/// Five teeth of 2 mm on a back, 3 mm of room between them.
TriangleMesh comb_mesh() {
  Blocks comb;
  for (int i = 0; i <= 9; ++i) comb.x.push_back(0.005 * (i / 2) + 0.002 * (i % 2) - 0.011);
  comb.y = {-0.002, 0.002};
  comb.z = {-0.004, 0.0, 0.015};
  comb.filled.assign(18, 1);
  for (int i = 1; i < 9; i += 2) comb.filled[9 + i] = 0;
  return comb.mesh();
}

std::shared_ptr<const Part> surface_part(const TriangleMesh& mesh) {
  Result<Part> part = part_from_mesh(mesh, {.pieces = PieceSource::kSurface, .about_center_of_mass = true});
  EXPECT_TRUE(part) << part.error().message();
  return std::make_shared<const Part>(std::move(*part));
}

std::shared_ptr<const Part> ball_part() {
  const Polytope sphere = make_icosphere(1, kBall);
  return std::make_shared<const Part>(
      *part_from_clouds({std::vector<Vec3>(sphere.vertices.begin(), sphere.vertices.end())}));
}

struct Entangled : testing::Judged {
  Kind kind;
  int moved = -1;               // the body that is pulled, dropped, shaken or thrown
  std::vector<int> balls;       // in the cup, whose frame C is that of the world at the start
  std::vector<Vec3> ball_at_C;  // after the last frame [m]

  int add(const std::shared_ptr<const Part>& part, const Pose& X_WP, bool fixed) {
    BodySpec spec{.part = part, .density_kg_per_m3 = kDensity_kg_per_m3, .X_WP = X_WP};
    if (fixed) spec.joint.kind = JointKind::kFixed;
    return add_body(world, spec);
  }

  Entangled(Kind of, Random& random) : kind(of) {
    static const std::shared_ptr<const Part> ring = surface_part(testing::torus(24, 10, 0.02, 0.003));
    static const std::shared_ptr<const Part> hook = surface_part(hook_mesh());
    static const std::shared_ptr<const Part> comb = surface_part(comb_mesh());
    static const std::shared_ptr<const Part> cup = surface_part(cup_mesh());
    static const std::shared_ptr<const Part> ball = ball_part();
    const Mat3 upright = exp_rotation({0.5 * kPi, 0, 0});
    const auto about = [&](const Mat3& R, const Vec3& p, double turn, double shift) {
      return Pose{exp_rotation(some_vector(random, turn)) * R, p + some_vector(random, shift)};
    };
    const Mat3 across = upright * exp_rotation({0, 0.5 * kPi, 0});
    switch (kind) {
      case Kind::kRings:
        add(ring, {upright, Vec3::Zero()}, true);
        moved = add(ring, about(across, {0, 0, -0.026}, 0.2, 0.003), false);
        break;
      case Kind::kChain:
        add(ring, {upright, Vec3::Zero()}, true);
        add(ring, about(across, {0, 0, -0.03}, 0.05, 0.001), false);
        moved = add(ring, about(upright, {0, 0, -0.06}, 0.05, 0.001), false);
        break;
      case Kind::kHooks: {  // upside down, turned by a quarter, each round the other
        const Mat3 over = exp_rotation({0, kPi, 0});
        add(hook, {over, {0, 0, 0}}, true);
        moved = add(hook, about(exp_rotation({0, 0, 0.5 * kPi}), {0, 0, 0.022}, 0.1, 0.001), false);
        break;
      }
      case Kind::kCup:
        moved = add(cup, {}, false);
        for (int i = random.index(9); i >= 0; --i)
          balls.push_back(
              add(ball, about(Mat3::Identity(), 0.0065 * Vec3(i % 3 - 1, i / 3 - 1, 1), 1.0, 0.0002), false));
        break;
      case Kind::kSheet: {
        TriangleMesh sheet;
        sheet.vertices = {{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}};
        sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
        if (random.unit() < 0.5)
          for (Triangle& t : sheet.triangles) std::swap(t[1], t[2]);
        add(surface_part(sheet), {}, true);
        moved = add(random.unit() < 0.5 ? ring : ball, about(upright, {0, 0, 0.03}, 1.0, 0.002), false);
        break;
      }
      case Kind::kCombs:
        add(comb, {}, true);
        moved = add(comb, about(exp_rotation({0, kPi, 0}), {0.0025, 0, 0.017}, 0.01, 0.0003), false);
        break;
    }
  }

  /// Whether a ball that was in the cup has left it otherwise than over the rim; between frames it goes
  /// straight.
  bool left_through_a_wall(const Vec3& from_C, const Vec3& to_C) const {
    const auto in = [](const Vec3& p) {
      return std::max(std::abs(p.x()), std::abs(p.y())) < kCupInner && p.z() > 0.0 && p.z() < kCupHeight;
    };
    if (!in(from_C) || in(to_C)) return false;
    double leaves = 1.0;  // the part of the way at which it passes the first wall, or the rim
    int through = -1;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = to_C[axis] - from_C[axis];
      const double high = axis == 2 ? kCupHeight : kCupInner, low = axis == 2 ? 0.0 : -kCupInner;
      const double share = along > 0.0   ? (high - from_C[axis]) / along
                           : along < 0.0 ? (low - from_C[axis]) / along
                                         : 2.0;
      if (share > leaves) continue;
      leaves = share;
      through = axis == 2 && along > 0.0 ? -1 : axis;
    }
    return through >= 0 && from_C.z() + leaves * (to_C.z() - from_C.z()) < kCupHeight - kBall;
  }
};

struct Motion {
  Deed deed;
  double speed = 1.0;  // [m/s]
  Vec3 far, turn;      // of the hand: where it goes [m], and by how much it turns [rad]

  bool by_hand() const { return deed == Deed::kPull || deed == Deed::kShake; }
  Pose at(double time_s) const {
    const double length = far.norm();
    const double share =
        deed == Deed::kPull ? std::min(1.0, speed * time_s / length) : std::sin(speed * time_s / length);
    return {exp_rotation(turn * share), far * share};
  }
};

/// What the variants of a test have seen.
struct Seen {
  int touched = 0;       // frames in which something did
  double fastest = 0.0;  // of the balls in a cup in the hand [m/s]
};

/// How the body is moved: with its settings and those of the world, at random.
Motion draw_motion(Deed deed, Random& random, Entangled& e) {
  Motion motion{deed, 0.05 * std::pow(200.0, random.unit()),  // up to 10 m/s
                some_vector(random, 1.0).normalized() * random.uniform(0.02, 0.08), some_vector(random, 1.5)};
  if (deed == Deed::kShake) motion.far *= 0.25;
  e.settings.dt_s = std::array{2e-3, 1e-3, 1e-3, 0.5e-3}[static_cast<std::size_t>(random.index(4))];
  const std::size_t n = e.world.bodies.size();
  if (random.unit() < 0.5) e.settings.friction = {std::vector<double>(n * n, 0.3), int(n)};
  if (random.unit() < 0.3) e.settings.impacts.restitution = {std::vector<double>(n * n, 0.5), int(n)};
  if (random.unit() < 0.7) e.world.gravity_W = {0, 0, -kGravity};
  if (motion.by_hand()) e.settings.tool.body = e.moved;
  if (deed == Deed::kThrow)
    e.world.bodies[static_cast<std::size_t>(e.moved)].V_WB = {some_vector(random, motion.speed),
                                                              some_vector(random, 50.0)};
  return motion;
}

/// What is wrong after a frame; nothing: empty.
std::string fault_of(Entangled& e) {
  const auto faults = e.referee->judge(e.simulation->state().world.X_WB);
  if (!faults.empty())
    return "bodies " + std::to_string(faults[0].body_a) + " and " + std::to_string(faults[0].body_b) +
           (faults[0].surfaces_cross ? " cross"
            : faults[0].inside       ? " are within each other"
                                     : " are linked otherwise");
  bool out = e.kind == Kind::kSheet && e.X_WB(e.moved).p.z() < 0.0;
  const bool first = e.ball_at_C.empty();
  e.ball_at_C.resize(e.balls.size());
  for (std::size_t i = 0; i < e.balls.size(); ++i) {
    const Vec3 at_C =
        e.world.bodies[std::size_t(e.moved)].X_WB * (e.X_WB(e.moved).inverse() * e.X_WB(e.balls[i]).p);
    out |= !first && e.left_through_a_wall(e.ball_at_C[i], at_C);
    e.ball_at_C[i] = at_C;
  }
  return out ? "it is on the other side of a wall" : "";
}

void expect_intact(Kind kind, int variant, Seen& seen) {
  Random random(1000 * static_cast<std::uint64_t>(kind) + 7 + static_cast<std::uint64_t>(variant) * 104729);
  const Deed deed = static_cast<Deed>(variant % 4);
  Entangled e(kind, random);
  const Motion motion = draw_motion(deed, random, e);
  SCOPED_TRACE(std::string(kKinds[static_cast<std::size_t>(kind)]) + " " +
               kDeeds[static_cast<std::size_t>(deed)] + ", variant " + std::to_string(variant) + ", " +
               std::to_string(motion.speed) + " m/s");
  ASSERT_NO_FATAL_FAILURE(e.begin());
  for (int frame = 0; frame < 300; ++frame) {
    e.simulation->step(motion.by_hand() ? motion.at(frame * e.settings.dt_s) : Pose());
    seen.touched += e.simulation->report().contact_points > 0 ? 1 : 0;
    for (std::size_t i = 0; motion.by_hand() && i < e.balls.size(); ++i)
      seen.fastest =
          std::max(seen.fastest, e.simulation->state().world.V_WB[std::size_t(e.balls[i])].v.norm());
    ASSERT_EQ(fault_of(e), "") << "frame " << frame;
  }
}

class Entanglement : public ::testing::TestWithParam<Kind> {};

TEST_P(Entanglement, IsNeitherLostNorMade) {
  const int variants = testing::full_run() ? 1668 : testing::effort(16, 4);  // 10 008 of all kinds
  Seen seen;
  for (int variant = 0; variant < variants; ++variant) expect_intact(GetParam(), variant, seen);
  EXPECT_GT(seen.touched, 10 * variants);
}

/// A cup follows the hand at 1 m/s at most. What lies in it is not thrown by the step that it does not make.
TEST(BallsInACup, AreNotFasterThanTheirImpactsOnTheCupMakeThem) {
  const int variants = testing::full_run() ? 400 : testing::effort(16, 4);
  Seen seen;
  for (int variant = 0; variant < variants; ++variant) expect_intact(Kind::kCup, 2 * variant, seen);
  EXPECT_LT(seen.fastest, testing::full_run() ? 8.0 : 4.0);
}

INSTANTIATE_TEST_SUITE_P(Crossing, Entanglement,
                         ::testing::Values(Kind::kRings, Kind::kHooks, Kind::kChain, Kind::kCup, Kind::kSheet,
                                           Kind::kCombs),
                         [](const ::testing::TestParamInfo<Kind>& run) {
                           return std::string(kKinds[static_cast<std::size_t>(run.param)]);
                         });

}  // namespace
}  // namespace tactum::entangled_test
