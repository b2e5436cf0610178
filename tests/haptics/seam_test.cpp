/// A part cut into pieces feels like the part uncut, frame by frame.

#include <gtest/gtest.h>

#include <cstdio>

#include "support/add_body.h"
#include "support/effort.h"
#include "tactum/base/random.h"
#include "tactum/contact/contact_finder.h"
#include "tactum/contact/shading.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/polygon_clip.h"
#include "tactum/geometry/primitives.h"
#include "tactum/haptics/frame.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::seam_test {
namespace {

using Clouds = std::vector<std::vector<Vec3>>;
using SharedPart = std::shared_ptr<const Part>;

SharedPart part_of(const Clouds& clouds, const PartOptions& options = {}) {
  Result<Part> part = part_from_clouds(clouds, options);
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

/// Random poses in which patches are compared.
const int kPoses = testing::full_run() ? 20000 : testing::effort(2000, 30);

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

/// Moves `probe` over `part`, both as given, and returns the wrench of every frame. The hand may tremble.
Felt slide(const SharedPart& part, const SharedPart& probe, Motion motion, ResponseModel response,
           double tremor_m = 0.0) {
  const int frames = 900;
  World world;
  add_body(world, {.part = probe, .mass_kg = 0.05, .X_WP = motion(0.0)});
  add_body(world, {.part = part, .joint = {.kind = JointKind::kFixed}});
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
    const double shake = tremor_m * (i % 2);
    sample.X_DH = {wanted.R * start.R.transpose(), wanted.p - start.p + Vec3(shake, shake, shake)};
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

/// The largest difference of force and of torque (over a lever of 10 mm), as a fraction of the largest force.
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
/// In `penalty` a leaning patch that shrinks as it turns can shake the response of the uncut part, which then
/// amplifies the last bit. So the ripple may be some times that of the uncut part with a tremor of that size.
constexpr double kTremor_m = 1e-16;
constexpr double kOwnRipples = 10.0;

void expect_same(const SharedPart& cut, const SharedPart& whole, const Probe& probe,
                 double most_in_penalty = 1e-6) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    const bool penalty = response == ResponseModel::kPenalty;
    SCOPED_TRACE(std::string(probe.name) + (penalty ? ", penalty" : ", constraint"));
    const Felt expected = slide(whole, probe.part(), probe.motion, response);
    const Felt felt = slide(cut, probe.part(), probe.motion, response);
    const double difference = ripple(felt, expected);
    const double own =
        penalty ? ripple(slide(whole, probe.part(), probe.motion, response, kTremor_m), expected) : 0.0;
    std::printf("%-25s %4zu pieces, %-10s: ripple %.2g of %.2f N (its own %.2g), %d frames in contact\n",
                probe.name, cut->pieces.size(), penalty ? "penalty" : "constraint", difference,
                expected.largest_force, own, expected.frames_in_contact);
    EXPECT_GT(expected.frames_in_contact, 500);
    EXPECT_GT(expected.largest_force, 0.1);
    EXPECT_LT(difference, penalty ? std::max(most_in_penalty, kOwnRipples * own) : 1e-6);
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

/// The bar, cut across by random planes.
SharedPart bar_in_cells(std::uint64_t seed, int cuts) {
  Random random(seed);
  std::vector<std::pair<Vec3, double>> planes;
  for (int i = 0; i < cuts; ++i) {
    const Vec3 normal =
        Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    planes.emplace_back(normal, normal.dot(Vec3(0, 0, random.uniform(-0.03, 0.03))));
  }
  return part_of(cut_by({bar(false)->pieces[0].vertices}, planes));
}

TEST(Seams, ABarOfCellsIsRound) {
  const SharedPart whole = bar(false);
  const SharedPart cut = bar_in_cells(5, 5);
  ASSERT_GT(cut->pieces.size(), 10u);
  expect_same(cut, whole, {"block round the bar", block, block_round_the_bar});
  // In `penalty` a normal that turns over to the next is that of one piece, whose supports give the depth.
  expect_same(cut, whole, {"ball round the bar", ball, ball_round_the_bar}, 0.05);
}

TEST(Seams, AFacetThatWasCutIsShadedAsOne) {
  const SharedPart whole = bar(false);
  const SharedPart cut = bar_in_cells(5, 5);
  const double crease = 0.6;
  const ShadingNormals expected(*whole, crease);
  const ShadingNormals found(*cut, crease);
  const Polytope& W = whole->pieces[0];
  double largest = 0.0;
  int stretches = 0;
  for (int piece = 0; piece < static_cast<int>(cut->pieces.size()); ++piece) {
    const Polytope& P = cut->pieces[static_cast<std::size_t>(piece)];
    for (int face = 0; face < P.counts[2]; ++face) {
      if (cut->true_surface.group_of(piece, 2, face) < 0) continue;
      const Vec3& normal = P.faces[static_cast<std::size_t>(face)].normal;
      const auto same = std::find_if(W.faces.begin(), W.faces.end(), [&](const Polytope::Face& other) {
        return (other.normal - normal).norm() < 1e-9;
      });
      ASSERT_NE(same, W.faces.end());
      ++stretches;
      Vec3 middle = Vec3::Zero();
      const std::vector<Vec3> corners = face_corners(P, face);
      for (const Vec3& corner : corners) middle += corner / static_cast<double>(corners.size());
      for (const Vec3& corner : corners) {
        const Vec3 p = 0.9 * corner + 0.1 * middle;
        const Vec3 as_whole =
            expected.deviation(0, {FeatureKind::kFace, static_cast<int>(same - W.faces.begin())}, p);
        EXPECT_LT((found.deviation(piece, {FeatureKind::kFace, face}, p) - as_whole).norm(), 1e-9);
        largest = std::max(largest, as_whole.norm());
      }
    }
  }
  EXPECT_GT(stretches, 60) << "of 26 faces";
  EXPECT_GT(largest, 0.1) << "the bar is shaded at all";
}

/// A sheet of half a millimetre in tiles of 5 mm, or whole; its middle plane is the plate's top.
SharedPart sheet(int tiles) {
  std::vector<std::pair<Vec3, double>> planes;
  for (int i = 1; i < tiles; ++i)
    for (const Vec3& axis : {Vec3::UnitX().eval(), Vec3::UnitY().eval()})
      planes.emplace_back(axis, -0.05 + 0.1 * i / tiles);
  std::vector<Vec3> corners = make_box({0.05, 0.05, 0.00025}).vertices;
  for (Vec3& corner : corners) corner.z() += kPlate.z() - 0.00025;
  return part_of(cut_by({corners}, planes), {.about_center_of_mass = true});
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

/// The patches of a block over a plate, found anew.
std::vector<ContactPatch> patches_of(const SharedPart& plate, const SharedPart& probe, const Pose& X_WA) {
  const std::vector<Pose> X_WB = {X_WA, Pose()};
  ContactFinder finder({{probe.get(), true}, {plate.get(), false}}, X_WB);
  const std::vector<double> motion_bound = {3e-4, 0.0};
  finder.find_near_pairs(X_WB, motion_bound, 0.0);
  finder.find_patches(X_WB, 1 << 20);
  return {finder.patches().begin(), finder.patches().end()};
}

TEST(Seams, PatchesAtTrueEdgesAreThoseOfTheUncutPart) {
  const SharedPart whole = grid_plate(1);
  const SharedPart probe = block();
  const std::uint64_t seed = 11;
  Random random(seed);
  int touching = 0;
  int leaning = 0;
  double worst = 0.0;
  for (const SharedPart& cut : {grid_plate(10), random_plate(3, 6)})
    for (int i = 0; i < kPoses; ++i) {
      // Flat but for three degrees, some of it over the plate's edge or its corner, or on its middle.
      const auto lean = [&] { return random.uniform(-0.05, 0.05); };
      const Mat3 R = exp_rotation({lean(), lean(), 0.0}) * exp_rotation({0, 0, random.uniform(-3, 3)});
      const Vec3 p(random.uniform(0.03, 0.058), random.uniform(-0.02, 0.055), 0.0);
      const Polytope& B = probe->pieces[0];
      double lowest = 1.0;
      for (const Vec3& vertex : B.vertices) lowest = std::min(lowest, (R * vertex).z());
      const Pose X_WA{R, {p.x(), p.y(), kPlate.z() - lowest + random.uniform(-2e-4, 2e-4)}};
      const std::vector<ContactPatch> expected = patches_of(whole, probe, X_WA);
      const std::vector<ContactPatch> found = patches_of(cut, probe, X_WA);
      ASSERT_EQ(found.size(), expected.size()) << "seed " << seed << ", pose " << i;
      if (expected.empty()) continue;
      ASSERT_EQ(expected.size(), 1u);
      ++touching;
      const Manifold& m = found[0].manifold;
      const Manifold& e = expected[0].manifold;
      leaning += e.a.kind == FeatureKind::kFace && e.area < 1e-4;
      ASSERT_EQ(m.points.size(), e.points.size()) << "pose " << i;
      EXPECT_NEAR(m.area, e.area, 1e-9 * 2.8e-4) << "pose " << i;
      for (const ContactPoint& point : m.points) {
        double nearest = 1.0;
        for (const ContactPoint& other : e.points)
          nearest = std::min(nearest, (other.p_a - point.p_a).norm());
        worst = std::max(worst, nearest);
        EXPECT_LT(nearest, 1e-10) << "pose " << i;
      }
    }
  std::printf("%d poses in contact, %d of them leaning faces: points off by at most %.2g m\n", touching,
              leaning, worst);
  EXPECT_GT(touching, kPoses / 2);
  EXPECT_GT(leaning, kPoses / 20);
}

TEST(Seams, PatchesOnARoundBarAreThoseOfTheUncutPart) {
  const SharedPart whole = bar(false);
  const SharedPart probe = ball();
  const std::uint64_t seed = 3;
  Random random(seed);
  const auto any = [&] { return random.uniform(-3, 3); };
  int touching = 0;
  for (const SharedPart& cut : {bar(true), bar_in_cells(5, 5)})
    for (int i = 0; i < kPoses; ++i) {
      const double angle = random.uniform(0, 2 * kPi);
      const double r = 0.0280 - random.uniform(-2e-4, 8e-4);
      const Pose X_WA{exp_rotation({any(), any(), any()}),
                      {r * std::cos(angle), r * std::sin(angle), random.uniform(-0.04, 0.04)}};
      const std::vector<ContactPatch> expected = patches_of(whole, probe, X_WA);
      const std::vector<ContactPatch> found = patches_of(cut, probe, X_WA);
      ASSERT_EQ(found.size(), expected.size()) << "seed " << seed << ", pose " << i;
      if (expected.empty()) continue;
      ++touching;
      EXPECT_NEAR(found[0].distance, expected[0].distance, 1e-12) << "pose " << i;
      EXPECT_LT((found[0].manifold.normal - expected[0].manifold.normal).norm(), 1e-9) << "pose " << i;
    }
  EXPECT_GT(touching, kPoses);
}

TEST(Seams, TrueEdgesAreFelt) {
  const SharedPart whole = grid_plate(1);
  for (const SharedPart& cut : {grid_plate(10), random_plate(3, 6)}) {
    expect_same(cut, whole, {"ball round the edge", ball, ball_round_the_edge});
    expect_same(cut, whole, {"block over the edge", block, block_over_the_edge});
    expect_same(cut, whole, {"block askew over the edge", block, block_askew_over_the_edge});
  }
}

}  // namespace
}  // namespace tactum::seam_test
