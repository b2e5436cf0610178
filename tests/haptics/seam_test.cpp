/// A part cut into pieces feels like the part uncut, frame by frame.

#include <gtest/gtest.h>

#include <cstdio>

#include "support/real_data.h"
#include "tactum/base/random.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/polygon_clip.h"
#include "tactum/geometry/primitives.h"
#include "tactum/haptics/frame.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

using Clouds = std::vector<std::vector<Vec3>>;
using SharedPart = std::shared_ptr<const Part>;

SharedPart part_of(const Clouds& clouds) {
  Result<Part> part = part_from_clouds(clouds);
  EXPECT_TRUE(part) << (part ? "" : part.error().message());
  return std::make_shared<const Part>(std::move(*part));
}

/// A point cloud (of a convex piece) below and above a plane.
void cut_cloud(const std::vector<Vec3>& cloud, const Vec3& normal, double offset, Clouds& out) {
  const Result<Polytope> whole = convex_hull(cloud);
  for (double sign : {1.0, -1.0}) {
    std::vector<Vec3> half;
    for (int face = 0; face < whole->counts[2]; ++face) {
      std::vector<Vec3> polygon = face_corners(*whole, face);
      keep_below(polygon, sign * normal, sign * offset);
      half.insert(half.end(), polygon.begin(), polygon.end());
    }
    if (half.size() < 4) continue;
    const Result<Polytope> piece = convex_hull(half);
    if (piece && !piece->flat) out.push_back(piece->vertices);
  }
}

/// Half edge lengths of the plate that is felt [m].
const Vec3 kPlate(0.05, 0.05, 0.01);

Clouds cut_by(const Clouds& whole, const std::vector<std::pair<Vec3, double>>& planes) {
  Clouds pieces = whole;
  for (const auto& [normal, offset] : planes) {
    Clouds next;
    for (const auto& cloud : pieces) cut_cloud(cloud, normal, offset, next);
    pieces = std::move(next);
  }
  return pieces;
}

/// The plate in n x n cells.
SharedPart grid_plate(int n) {
  std::vector<std::pair<Vec3, double>> planes;
  for (int i = 1; i < n; ++i)
    for (const Vec3& axis : {Vec3::UnitX().eval(), Vec3::UnitY().eval()})
      planes.emplace_back(axis, -0.05 + 0.1 * i / n);
  return part_of(cut_by({make_box(kPlate).vertices}, planes));
}

/// The plate cut by random planes.
SharedPart random_plate(std::uint64_t seed, int cuts) {
  Random random(seed);
  std::vector<std::pair<Vec3, double>> planes;
  for (int i = 0; i < cuts; ++i) {
    const Vec3 normal =
        Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    planes.emplace_back(normal,
                        normal.dot(Vec3(random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), 0.0)));
  }
  return part_of(cut_by({make_box(kPlate).vertices}, planes));
}

/// Where the handle is at a time, and how it lies.
using Motion = Pose (*)(double t);

struct Felt {
  std::vector<Wrench> wrench;
  double largest_force = 0.0;
  int frames_in_contact = 0;
};

/// Moves `probe` over `part`, both as given, and tells what is felt in every frame.
Felt slide(const SharedPart& part, const SharedPart& probe, Motion motion, ResponseModel response,
           int frames) {
  World world;
  world.bodies.resize(2);
  world.bodies[0].part = probe;
  world.bodies[0].mass_kg = 0.05;
  world.bodies[0].inertia_B = 1e-5 * Mat3::Identity();
  world.bodies[0].X_WB = motion(0.0);
  world.bodies[1].part = part;
  world.bodies[1].joint.kind = JointKind::kFixed;
  FrameSettings settings;
  settings.tool.body = 0;
  settings.response = response;
  settings.penalty.stiffness_N_per_m = 1200.0;
  FrameState state(world, settings);
  Felt felt;
  const Pose start = motion(0.0);
  for (int i = 0; i < frames; ++i) {
    const Pose wanted = motion(i * 1e-3);
    DeviceSample sample;
    sample.valid = true;
    sample.time_s = i * 1e-3;
    sample.X_DH = {wanted.R * start.R.transpose(), wanted.p - start.p};
    FrameTick tick;
    tick.index = static_cast<std::uint64_t>(i);
    tick.now_s = i * 1e-3;
    FrameReport report;
    haptic_frame(world, settings, sample, tick, state, report);
    felt.wrench.push_back(report.coupling);
    felt.largest_force = std::max(felt.largest_force, report.coupling.f.norm());
    felt.frames_in_contact += report.contact_points > 0;
  }
  return felt;
}

/// The largest difference of force and of torque (over a lever of 10 mm), as a share of the largest force.
double ripple(const Felt& cut, const Felt& whole) {
  double worst = 0.0;
  for (std::size_t i = 0; i < whole.wrench.size(); ++i) {
    worst = std::max(worst, (cut.wrench[i].f - whole.wrench[i].f).norm());
    worst = std::max(worst, (cut.wrench[i].t - whole.wrench[i].t).norm() / 0.01);
  }
  return worst / whole.largest_force;
}

SharedPart block() { return part_of({make_box({0.010, 0.007, 0.005}).vertices}); }
SharedPart ball() { return part_of({make_icosphere(2, 0.008).vertices}); }

/// Down in a fifth of a second, then along a curve over the plate; `low` is where the part's origin goes.
Pose over_the_plate(double t, const Mat3& R, double height, double low) {
  const double down = std::min(1.0, t / 0.2);
  const double along = std::max(0.0, t - 0.2);
  return {R,
          {-0.03 + 0.05 * along, 0.02 * std::sin(4.0 * along),
           kPlate.z() + height + 0.001 - (0.001 + low) * down}};
}
Pose block_flat(double t) { return over_the_plate(t, Mat3::Identity(), 0.005, 0.0015); }
Pose block_turning(double t) { return over_the_plate(t, exp_rotation({0, 0, 1.5 * t}), 0.005, 0.0003); }
Pose block_edge_down(double t) {
  return over_the_plate(t, exp_rotation({0.0, 0.6, 0.0}), 0.005 * std::cos(0.6) + 0.010 * std::sin(0.6),
                        0.0012);
}
Pose block_corner_down(double t) { return over_the_plate(t, exp_rotation({0.5, 0.6, 0.2}), 0.0115, 0.002); }
Pose ball_down(double t) { return over_the_plate(t, exp_rotation({0.1, 0.2, 0.3}), 0.008, 0.0015); }
/// Over the plate's edge, into the air and back against its side.
Pose ball_round_the_edge(double t) {
  const double angle = -0.4 + 2.2 * t;
  const double r = 0.0092 - 0.0016 * std::min(1.0, t / 0.2);
  const Vec3 edge(0.05, 0.004 * std::sin(7 * t), 0.01);
  return {exp_rotation({0.1, 0.2, 0.3}), edge + r * Vec3(std::sin(angle), 0, std::cos(angle))};
}
Pose block_at_the_edge(double t, double yaw) {
  const double down = 0.004 * std::min(1.0, t / 0.2);
  return {exp_rotation({0.0, 0.3 + 0.2 * t, yaw}),
          {0.044 + 0.006 * t, 0.01 * std::sin(3 * t), 0.0190 - down}};
}
Pose block_over_the_edge(double t) { return block_at_the_edge(t, 0.0); }
Pose block_askew_over_the_edge(double t) { return block_at_the_edge(t, 0.3); }

struct Probe {
  const char* name;
  SharedPart (*part)();
  Motion motion;
};
const Probe kOnTheFace[] = {{"block, flat", block, block_flat},
                            {"block, turning", block, block_turning},
                            {"block, edge down", block, block_edge_down},
                            {"block, corner down", block, block_corner_down},
                            {"ball", ball, ball_down}};
/// The largest ripple that passes, in either response: edges and faces in `penalty` may have their own.
struct Ripple {
  double constraint = 1e-6;
  double penalty = 1e-6;
};

void expect_same(const SharedPart& cut, const SharedPart& whole, const Probe& probe, Ripple most = {}) {
  const int frames = 900;
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    const bool penalty = response == ResponseModel::kPenalty;
    SCOPED_TRACE(std::string(probe.name) + (penalty ? ", penalty" : ", constraint"));
    const Felt expected = slide(whole, probe.part(), probe.motion, response, frames);
    const Felt felt = slide(cut, probe.part(), probe.motion, response, frames);
    const double difference = ripple(felt, expected);
    std::printf("%-25s %4zu pieces, %-10s: ripple %.2g of %.2f N, %d frames in contact\n", probe.name,
                cut->pieces.size(), penalty ? "penalty" : "constraint", difference, expected.largest_force,
                expected.frames_in_contact);
    EXPECT_GT(expected.frames_in_contact, 500);
    EXPECT_GT(expected.largest_force, 0.1);
    EXPECT_LT(difference, penalty ? most.penalty : most.constraint);
  }
}

TEST(Seams, APlaneInAHundredPiecesIsAPlane) {
  const SharedPart whole = grid_plate(1);
  const SharedPart cut = grid_plate(10);
  ASSERT_EQ(cut->pieces.size(), 100u);
  for (const Probe& probe : kOnTheFace) expect_same(cut, whole, probe);
}

TEST(Seams, APlateOfRandomConvexCellsIsAPlate) {
  const SharedPart whole = grid_plate(1);
  for (std::uint64_t seed = 1; seed <= (testing::full_run() ? 20u : 2u); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SharedPart cut = random_plate(seed, 7);
    for (const Probe& probe : kOnTheFace) expect_same(cut, whole, probe);
  }
}

/// A round bar along z of 24 facets, whole or as that many wedges.
SharedPart bar(bool cut) {
  constexpr int kFacets = 24;
  Clouds wedges(cut ? kFacets : 1);
  for (int i = 0; i < kFacets; ++i)
    for (double z : {-0.04, 0.04}) {
      if (cut) wedges[static_cast<std::size_t>(i)].emplace_back(0, 0, z);
      for (int j : {i, i + 1}) {
        const double angle = 2.0 * kPi * (j % kFacets) / kFacets;
        wedges[static_cast<std::size_t>(cut ? i : 0)].emplace_back(0.02 * std::cos(angle),
                                                                   0.02 * std::sin(angle), z);
      }
    }
  return part_of(wedges);
}

/// Round the bar, pressed onto it.
Pose ball_round_the_bar(double t) {
  const double angle = 0.05 + 1.7 * t;
  const double r = 0.0285 - 0.0015 * std::min(1.0, t / 0.2);
  return {exp_rotation({0.1, 0.2, 0.3}), {r * std::cos(angle), r * std::sin(angle), 0.01 * t}};
}
Pose block_round_the_bar(double t) {
  const double angle = 0.05 + 1.7 * t;
  const double r = 0.0260 - 0.0019 * std::min(1.0, t / 0.2);
  const Mat3 R = exp_rotation({0, 0, angle}) * exp_rotation({0, 0.5 * kPi, 0});
  return {R, {r * std::cos(angle), r * std::sin(angle), 0.01 * t}};
}

TEST(Seams, ABarOfWedgesIsRound) {
  const SharedPart whole = bar(false);
  const SharedPart cut = bar(true);
  ASSERT_EQ(cut->pieces.size(), 24u);
  for (const Probe& probe : {Probe{"ball round the bar", ball, ball_round_the_bar},
                             Probe{"block round the bar", block, block_round_the_bar}})
    expect_same(cut, whole, probe);
}

/// A sheet of half a millimetre in tiles of 5 mm, or whole; its middle plane is the plate's top.
SharedPart sheet(int tiles) {
  std::vector<std::pair<Vec3, double>> planes;
  for (int i = 1; i < tiles; ++i)
    for (const Vec3& axis : {Vec3::UnitX().eval(), Vec3::UnitY().eval()})
      planes.emplace_back(axis, -0.05 + 0.1 * i / tiles);
  std::vector<Vec3> corners = make_box({0.05, 0.05, 0.00025}).vertices;
  for (Vec3& corner : corners) corner.z() += kPlate.z() - 0.00025;
  return part_of(cut_by({corners}, planes));
}
Pose ball_from_below(double t) {
  Pose X = ball_down(t);
  X.p.z() = 2.0 * (kPlate.z() - 0.00025) - X.p.z();
  return X;
}

TEST(Seams, AThinSheetOfTilesIsTouchedFromBothSides) {
  const SharedPart whole = sheet(1);
  const SharedPart cut = sheet(20);
  ASSERT_EQ(cut->pieces.size(), 400u);
  for (const Probe& probe :
       {Probe{"ball on a sheet", ball, ball_down}, Probe{"ball below a sheet", ball, ball_from_below},
        Probe{"block on a sheet", block, block_flat}})
    expect_same(cut, whole, probe);
}

TEST(Seams, TrueEdgesAreFelt) {
  const SharedPart whole = grid_plate(1);
  for (const SharedPart& cut : {grid_plate(10), random_plate(3, 6)}) {
    expect_same(cut, whole, {"ball round the edge", ball, ball_round_the_edge});
    // In `penalty` the points of the stretches are others than those of the whole: as one of them leaves the
    // tolerance it shows.
    expect_same(cut, whole, {"block over the edge", block, block_over_the_edge}, {.penalty = 1e-4});
    // ... and while an edge leans by one to two degrees its patch shrinks, each stretch by itself.
    expect_same(cut, whole, {"block askew over the edge", block, block_askew_over_the_edge},
                {.penalty = 0.15});
  }
}

}  // namespace
}  // namespace tactum
