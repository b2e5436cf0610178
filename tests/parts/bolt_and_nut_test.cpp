#include "tactum/parts/bolt_and_nut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tactum/geometry/mass_properties.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"
#include "tactum/surface/surface_distance.h"

namespace tactum::bolt_and_nut_test {
namespace {

ScrewShape with_facets(const char* size, int facets) {
  ScrewShape shape;
  shape.size = size;
  shape.facets_per_turn = facets;
  return shape;
}

double hexagon_area(const MetricScrew& screw) {
  return 0.5 * std::sqrt(3.0) * screw.across_flats_m * screw.across_flats_m;
}

/// Integral of r^2 over one pitch of the profile: a flat P/8 at `crest`, P/4 at `minor`, flanks of 5/16 P.
double profile_moment(double pitch, double crest, double minor) {
  const double flank = (crest * crest + crest * minor + minor * minor) / 3.0;
  return pitch * (crest * crest / 8.0 + minor * minor / 4.0 + 2.0 * 5.0 / 16.0 * flank);
}

/// Volume of the true bolt. Seen from the axis the ridge is a row of profiles, one for each angle, and its
/// height rises and sinks over half a turn.
double bolt_volume(const ScrewShape& shape) {
  const MetricScrew screw = *metric_screw(shape.size);
  const double deviation = screw_fit(shape)->bolt_m;
  const double minor = 0.5 * (screw.minor_m() + deviation);
  const double crest = 0.5 * (screw.major_m + deviation);
  const auto ridge = [&](double height) {  // per radian
    const double top = minor + height * (crest - minor);
    return 0.5 * (profile_moment(screw.pitch_m, top, minor) - screw.pitch_m * minor * minor);
  };
  const double rising = kPi * (ridge(0.0) + 4.0 * ridge(0.5) + ridge(1.0)) / 6.0;  // exact: of second degree
  const double full = 2.0 * kPi * (shape.length_m / screw.pitch_m - 2.0);
  return hexagon_area(screw) * screw.head_height_m + kPi * minor * minor * shape.length_m + 2.0 * rising +
         full * ridge(1.0);
}

double nut_volume(const ScrewShape& shape, double height) {
  const MetricScrew screw = *metric_screw(shape.size);
  const double deviation = screw_fit(shape)->nut_m;
  const double hole =
      kPi * height / screw.pitch_m *
      profile_moment(screw.pitch_m, 0.5 * (screw.major_m + deviation), 0.5 * (screw.minor_m() + deviation));
  return hexagon_area(screw) * height - hole;
}

/// Where the half-plane at `angle` about z cuts the mesh: points (radius, z), two for each triangle it cuts.
/// A hair beyond the angle, since columns of corners stand at round ones.
std::vector<Vec2> section(const TriangleMesh& mesh, double angle) {
  angle += 1e-9;
  const Vec3 along(std::cos(angle), std::sin(angle), 0.0);
  const Vec3 across(-along.y(), along.x(), 0.0);
  std::vector<Vec2> points;
  for (const Triangle& t : mesh.triangles) {
    const std::size_t before = points.size();
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = mesh.vertices[t[i]];
      const Vec3& q = mesh.vertices[t[(i + 1) % 3]];
      const double a = across.dot(p);
      const double b = across.dot(q);
      if ((a > 0.0) == (b > 0.0)) continue;
      const Vec3 cut = p + (q - p) * (a / (a - b));
      if (along.dot(cut) > 0.0) points.emplace_back(along.dot(cut), cut.z());
    }
    if (points.size() % 2 != 0) points.resize(before);  // an end face, across the axis
  }
  return points;
}

/// Heights at which the section crosses a radius, ascending, doubles removed.
std::vector<double> crossings(const TriangleMesh& mesh, double angle, double radius) {
  const std::vector<Vec2> points = section(mesh, angle);
  std::vector<double> found;
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    const Vec2& p = points[i];
    const Vec2& q = points[i + 1];
    if ((p.x() > radius) == (q.x() > radius)) continue;
    found.push_back(p.y() + (q.y() - p.y()) * (radius - p.x()) / (q.x() - p.x()));
  }
  std::sort(found.begin(), found.end());
  return found;
}

void expect_a_solid(const TriangleMesh& mesh, int euler) {
  const MeshReport report = report_mesh(mesh, 0.0);
  EXPECT_TRUE(report.closed);
  EXPECT_TRUE(report.manifold());
  EXPECT_TRUE(report.oriented);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, euler);
  EXPECT_TRUE(report.zero_area.empty());
  EXPECT_TRUE(report.index_degenerate.empty());
  EXPECT_EQ(report.duplicate_triangles, 0);
  EXPECT_GT(report.volume, 0.0);
  EXPECT_EQ(report.vertices, static_cast<int>(mesh.vertices.size()));  // none without a triangle, none twice
}

/// Pairs of triangles that cross without sharing a corner, by all pairs whose boxes meet.
int crossing_pairs(const TriangleMesh& mesh) {
  std::vector<Aabb> boxes;
  std::vector<TrianglePoints> triangles;
  for (const Triangle& t : mesh.triangles) {
    triangles.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    boxes.emplace_back();
    for (const Vec3& corner : triangles.back()) boxes.back().extend(corner);
  }
  std::vector<std::size_t> order(triangles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return boxes[a].min.z() < boxes[b].min.z(); });
  int crossing = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      const std::size_t a = order[i];
      const std::size_t b = order[k];
      if (boxes[b].min.z() > boxes[a].max.z()) break;
      if (!boxes[a].overlaps(boxes[b])) continue;
      std::set<int> corners(mesh.triangles[a].begin(), mesh.triangles[a].end());
      corners.insert(mesh.triangles[b].begin(), mesh.triangles[b].end());
      if (corners.size() == 6 && triangles_cross(triangles[a], triangles[b])) ++crossing;
    }
  }
  return crossing;
}

TEST(BoltAndNut, AreClosedSolidsWithoutSelfIntersection) {
  for (const char* size : {"M3", "M8", "M16", "M18"}) {
    ScrewShape shape = with_facets(size, 16);
    shape.length_m = 6.3 * metric_screw(size)->pitch_m;
    const auto bolt = bolt_mesh(shape);
    ASSERT_TRUE(bolt) << bolt.error().message();
    expect_a_solid(*bolt, 2);
    EXPECT_EQ(crossing_pairs(*bolt), 0) << size;
    const auto nut = nut_mesh(shape);
    ASSERT_TRUE(nut) << nut.error().message();
    expect_a_solid(*nut, 0);  // one handle: the hole
    EXPECT_EQ(crossing_pairs(*nut), 0) << size;
  }
  expect_a_solid(*bolt_mesh(with_facets("M16", 128)), 2);
  expect_a_solid(*nut_mesh(with_facets("M16", 256)), 0);
}

TEST(BoltAndNut, ThreadIsASheetAboutTheAxis) {
  // With outward normals away from the axis (toward it in a nut) everywhere, the sheet folds nowhere.
  for (const bool nut : {false, true}) {
    const ScrewShape shape = with_facets("M10", 32);
    const TriangleMesh mesh = nut ? *nut_mesh(shape) : *bolt_mesh(shape);
    const double radius = 0.45 * metric_screw("M10")->across_flats_m;
    int thread = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]];
      const Vec3 b = mesh.vertices[t[1]];
      const Vec3 c = mesh.vertices[t[2]];
      const Vec3 middle = (a + b + c) / 3.0;
      const Vec3 normal = (b - a).cross(c - a).normalized();
      if (middle.head<2>().norm() > radius || std::abs(normal.z()) > 0.99) continue;
      const double outward = normal.head<2>().dot(middle.head<2>().normalized());
      EXPECT_GT(nut ? -outward : outward, 0.4);  // flanks lean by 60 degrees: cos is 0.5
      ++thread;
    }
    EXPECT_GT(thread, 8 * 32 * 5);
  }
}

TEST(BoltAndNut, VolumesApproachThoseOfTheTrueThread) {
  for (const char* size : {"M4", "M16", "M24"}) {
    double before = 1e300;
    for (const int facets : {32, 64, 128}) {
      ScrewShape shape = with_facets(size, facets);
      shape.length_m = 10.0 * metric_screw(size)->pitch_m;
      const TriangleMesh nut = *nut_mesh(shape);
      const double of_bolt = mass_properties(*bolt_mesh(shape), 1.0)->volume / bolt_volume(shape);
      const double of_nut =
          mass_properties(nut, 1.0)->volume / nut_volume(shape, bounds(nut.vertices).max.z());
      // Never more material than there is; what chords leave out shrinks with the square of the angle, what
      // the diagonals of the strips leave out (little) with the angle.
      EXPECT_LT(of_bolt, 1.0) << size;
      EXPECT_LT(of_nut, 1.0) << size;
      const double missing = (1.0 - of_bolt) + (1.0 - of_nut);
      EXPECT_LT(missing, 14.0 / facets / facets) << size << " " << facets;
      if (before < 1e300) {
        EXPECT_NEAR(before / missing, 3.7, 0.3) << size << " " << facets;
      }
      before = missing;
    }
  }
}

TEST(BoltAndNut, DiametersAndPitchAreThoseOfTheFit) {
  for (const char* size : {"M5", "M16", "M20"}) {
    for (const bool nut : {false, true}) {
      ScrewShape shape = with_facets(size, 32);
      const MetricScrew screw = *metric_screw(size);
      shape.length_m = 9.0 * screw.pitch_m;
      const ThreadFit fit = *screw_fit(shape);
      const TriangleMesh mesh = nut ? *nut_mesh(shape) : *bolt_mesh(shape);
      const double deviation = nut ? fit.nut_m : fit.bolt_m;
      const double faceted = nut ? 1.0 / std::cos(kPi / 32) : 1.0;
      for (const double turns :
           {0.0, 5.0 / 32, 0.25, 0.5, 25.0 / 32}) {  // at columns the section is the profile
        const double angle = 2.0 * kPi * turns;
        // On the pitch diameter ridge and groove are half a pitch wide, the ridge's middle at P (turns + k).
        const double pitch_radius = 0.5 * faceted * (screw.pitch_diameter_m() + deviation);
        std::vector<double> heights = crossings(mesh, angle, pitch_radius);
        ASSERT_GE(heights.size(), 6u) << size;
        std::size_t checked = 0;
        for (std::size_t i = 2; i + 3 < heights.size(); ++i) {  // away from the ends
          if (heights[i] < 1.2 * screw.pitch_m ||
              heights[i] > bounds(mesh.vertices).max.z() - 1.2 * screw.pitch_m)
            continue;
          EXPECT_NEAR(heights[i + 1] - heights[i], 0.5 * screw.pitch_m, 1e-9)
              << size << (nut ? " nut" : " bolt");
          const double quarter = heights[i] / screw.pitch_m - turns - 0.25;
          EXPECT_NEAR(2.0 * quarter, std::round(2.0 * quarter), 1e-6) << size;
          ++checked;
        }
        EXPECT_GE(checked, 2u);
        double widest = 0.0;
        double narrowest = 1e300;
        for (const Vec2& point : section(mesh, angle)) {
          if (point.x() > 0.45 * screw.across_flats_m || point.y() < 1.5 * screw.pitch_m ||
              point.y() > bounds(mesh.vertices).max.z() - 1.5 * screw.pitch_m ||
              point.x() < 0.3 * screw.major_m)
            continue;
          widest = std::max(widest, point.x());
          narrowest = std::min(narrowest, point.x());
        }
        EXPECT_NEAR(2.0 * widest, (screw.major_m + deviation) * faceted, 1e-9) << size;
        EXPECT_NEAR(2.0 * narrowest, (screw.minor_m() + deviation) * faceted, 1e-9) << size;
      }
    }
  }
}

TEST(BoltAndNut, FlatsAreAnEighthAndAQuarterOfThePitch) {
  const MetricScrew screw = *metric_screw("M16");
  const ThreadFit fit = *thread_fit("M16", "medium");
  const TriangleMesh bolt = *bolt_mesh(with_facets("M16", 64));
  const double below_crest = 0.5 * (screw.major_m + fit.bolt_m) - 1e-7;
  const double above_foot = 0.5 * (screw.minor_m() + fit.bolt_m) + 1e-7;
  std::vector<double> crest = crossings(bolt, 0.0, below_crest);
  std::vector<double> foot = crossings(bolt, 0.0, above_foot);
  ASSERT_GE(crest.size(), 12u);
  ASSERT_GE(foot.size(), 12u);
  EXPECT_NEAR(crest[7] - crest[6], screw.pitch_m / 8.0, 1e-6);
  EXPECT_NEAR(foot[8] - foot[7], screw.pitch_m / 4.0, 1e-6);
  EXPECT_NEAR(crest[8] - crest[6], screw.pitch_m, 1e-9);
}

/// Nut on bolt: turned, and raised from where the head seats it.
struct Pair {
  ScrewShape shape;
  Surface bolt, nut;
  SurfacePairCache cache;

  explicit Pair(const ScrewShape& of) : shape(of), bolt(*bolt_mesh(of)), nut(*nut_mesh(of)) {}
  SurfaceDistance at(double angle, double raised) {
    return surface_distance(bolt, nut, {exp_rotation(Vec3(0, 0, angle)), Vec3(0, 0, raised)}, cache);
  }
};

/// Distance of two flanks of a true thread: the axial gap, seen square to the steepest part of the helicoid.
double designed_gap(const ScrewShape& shape) {
  const MetricScrew screw = *metric_screw(shape.size);
  const double axial = screw_fit(shape)->flank_clearance_m() / std::cos(kPi / 6.0);
  const double lead = screw.pitch_m / (kPi * screw.minor_m());
  return axial / std::sqrt(4.0 / 3.0 + lead * lead);
}

TEST(BoltAndNut, NutTurnsOnTheBoltWithTheDesignedClearance) {
  for (const char* size : {"M5", "M16"}) {
    for (const char* tolerance_class : {"fine", "medium", "coarse"}) {
      ScrewShape shape = with_facets(size, 32);
      shape.tolerance_class = tolerance_class;
      const MetricScrew screw = *metric_screw(size);
      shape.length_m = screw.nut_height_m + 6.0 * screw.pitch_m;
      const double gap = designed_gap(shape);
      const double facets = 0.5 * screw.major_m * (1.0 / std::cos(kPi / 32) - std::cos(kPi / 32));
      Pair pair(shape);
      for (const double turns : {0.0, 0.004, 0.13, 0.5, 1.31, 2.5}) {
        const double distance = pair.at(2.0 * kPi * turns, screw.pitch_m * (2.0 + turns)).distance;
        EXPECT_GT(distance, 0.999 * gap) << size << " " << tolerance_class << " turned " << turns;
        EXPECT_LT(distance, gap + 0.5 * facets) << size << " " << tolerance_class << " turned " << turns;
      }
    }
  }
}

TEST(BoltAndNut, EqualPosesSeatTheNutOnTheHead) {
  const ScrewShape shape = with_facets("M16", 64);
  Pair pair(shape);
  EXPECT_EQ(pair.at(0.0, 0.0).distance, 0.0);  // face on face
  EXPECT_NEAR(pair.at(0.0, 10e-6).distance, 10e-6, 1e-12);
  const double gap = designed_gap(shape);
  const double past = pair.at(2.0 * kPi * 0.05, 0.05 * metric_screw("M16")->pitch_m).distance;
  EXPECT_GT(past, 0.999 * gap);
}

TEST(BoltAndNut, TurningWithoutRisingMeetsTheFlank) {
  ScrewShape shape = with_facets("M16", 64);
  shape.length_m = 0.024;
  const MetricScrew screw = *metric_screw("M16");
  Pair pair(shape);
  const double axial = screw_fit(shape)->flank_clearance_m() / std::cos(kPi / 6.0);
  const double raised = 3.0 * screw.pitch_m;
  for (const double sign : {-1.0, 1.0}) {
    const double touching = 2.0 * kPi * axial / screw.pitch_m;
    EXPECT_GT(pair.at(sign * 0.95 * touching, raised).distance, 0.0);
    EXPECT_EQ(pair.at(sign * 1.3 * touching, raised).distance, 0.0);
    EXPECT_GT(pair.at(sign * 1.3 * touching, raised).touching_pairs, 20);
    EXPECT_EQ(pair.at(0.0, raised + sign * 1.3 * axial).distance, 0.0);
    EXPECT_EQ(pair.at(sign * 0.5 * kPi, raised).distance, 0.0);
    // The other hand: a left-hand screw would pass here.
    EXPECT_EQ(pair.at(sign * 0.3, raised - sign * 0.3 * screw.pitch_m / (2.0 * kPi)).distance, 0.0);
    EXPECT_GT(pair.at(sign * 0.3, raised + sign * 0.3 * screw.pitch_m / (2.0 * kPi)).distance, 0.0);
  }
}

TEST(BoltAndNut, ClearanceMayBeToldInPlaceOfAClass) {
  ScrewShape shape = with_facets("M8", 128);
  shape.clearance_m = 20e-6;
  shape.length_m = 0.015;
  const MetricScrew screw = *metric_screw("M8");
  Pair pair(shape);
  const double distance = pair.at(1.0, screw.pitch_m * (4.0 + 0.5 / kPi)).distance;
  EXPECT_GT(distance, 0.999 * designed_gap(shape));
  EXPECT_LT(distance, 20e-6 + 2.5e-6);
  shape.clearance_m = 0.0;  // no play but what the facets add
  Pair tight(shape);
  EXPECT_LT(tight.at(1.0, screw.pitch_m * (4.0 + 0.5 / kPi)).distance, 2.5e-6);
}

TEST(BoltAndNut, BecomePartsWhoseSurfaceIsTheMesh) {
  const TriangleMesh mesh = *nut_mesh(with_facets("M16", 32));
  const auto part = part_from_mesh(mesh);
  ASSERT_TRUE(part) << part.error().message();
  EXPECT_EQ(part->tree.triangle_count(), static_cast<int>(mesh.triangles.size()));
  EXPECT_TRUE(part->notes.remarks.empty());
  EXPECT_TRUE(part->mass.approximation.empty());
}

TEST(BoltAndNut, RefuseWhatCannotBe) {
  const auto message = [](auto change) {
    ScrewShape shape;
    change(shape);
    const auto mesh = bolt_mesh(shape);
    return mesh ? std::string("no error") : mesh.error().message();
  };
  EXPECT_EQ(message([](ScrewShape&) {}), "no error");
  EXPECT_NE(message([](ScrewShape& s) { s.size = "M7"; }).find("found \"M7\", expected one of M3 M4"),
            std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) { s.tolerance_class = "tight"; }).find("fine, medium or coarse"),
            std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) {
              s.size = "M3";
              s.tolerance_class = "coarse";
            }).find("M5 or larger"),
            std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) { s.facets_per_turn = 40; }).find("multiple of 16"), std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) { s.facets_per_turn = 0; }).find("multiple of 16"), std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) { s.length_m = 0.005; }).find("3 to 100 pitches"), std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) { s.length_m = std::nan(""); }).find("length"), std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) { s.clearance_m = -1e-6; }).find("clearance"), std::string::npos);
  EXPECT_NE(message([](ScrewShape& s) { s.clearance_m = 0.001; }).find("an eighth of the pitch"),
            std::string::npos);
  ScrewShape wrong;
  wrong.facets_per_turn = 272;
  EXPECT_FALSE(nut_mesh(wrong));
}

}  // namespace
}  // namespace tactum::bolt_and_nut_test
