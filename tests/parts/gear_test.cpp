#include "tactum/parts/gear.h"
#include "support/effort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"
#include "tactum/surface/surface_distance.h"

namespace tactum::gear_test {
namespace {

// The referee is planar and knows nothing of polytopes: two convex polygons are apart when some side of one
// has all of the other beyond it (separating axes).

/// Largest distance by which a side of `a` keeps `b` away; positive when they are apart.
double gap_across_sides(const Polygon& a, const Polygon& b) {
  double gap = -1e300;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2 side = a[(i + 1) % a.size()] - a[i];
    const Vec2 outward = Vec2(side.y(), -side.x()).normalized();
    double nearest = 1e300;
    for (const Vec2& corner : b) nearest = std::min(nearest, outward.dot(corner - a[i]));
    gap = std::max(gap, nearest);
  }
  return gap;
}

double separation(const Polygon& a, const Polygon& b) {
  return std::max(gap_across_sides(a, b), gap_across_sides(b, a));
}

std::vector<Polygon> placed(const std::vector<Polygon>& gear, double angle, const Vec2& centre) {
  const Eigen::Rotation2Dd turn(angle);
  std::vector<Polygon> result = gear;
  for (Polygon& polygon : result)
    for (Vec2& corner : polygon) corner = turn * corner + centre;
  return result;
}

/// Smallest separation over all pieces of a pair at the given angles.
struct Pair {
  Gear a, b;
  std::vector<Polygon> outlines_a, outlines_b;
  double centres = 0.0;

  Pair(const Gear& first, const Gear& second) : a(first), b(second), centres(centre_distance(first, second)) {
    outlines_a = *gear_outlines(a);
    outlines_b = *gear_outlines(b);
  }
  double separation_at(double angle_a, double angle_b) const {
    double least = 1e300;
    const auto placed_b = placed(outlines_b, angle_b, Vec2(centres, 0.0));
    for (const Polygon& piece_a : placed(outlines_a, angle_a, Vec2::Zero()))
      for (const Polygon& piece_b : placed_b) least = std::min(least, separation(piece_a, piece_b));
    return least;
  }
  double middle_b(double angle_a) const { return meshing_angle(b) - angle_a * a.teeth / b.teeth; }
  /// How far b turns from the middle of its play until a tooth is met, in the sense of `sign`.
  double free_turn(double angle_a, double sign) const {
    double free = 0.0;
    double blocked = kPi / b.teeth;
    for (int i = 0; i < 40; ++i) {
      const double half = 0.5 * (free + blocked);
      (separation_at(angle_a, middle_b(angle_a) + sign * half) > 0.0 ? free : blocked) = half;
    }
    return free;
  }
};

/// How deep the chords of a flank lie inside the tooth, at most: radius of curvature * step^2 / 8.
double chord(const Gear& gear) {
  const double last = std::sqrt(std::pow(gear.tip_radius_m() / gear.base_radius_m(), 2) - 1.0);
  return gear.base_radius_m() * last * std::pow(last / gear.flank_facets, 2) / 8.0;
}

double polygon_area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& p = polygon[i];
    const Vec2& q = polygon[(i + 1) % polygon.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return 0.5 * twice;
}

TEST(Gear, IsAboutTwentyConvexPiecesOfAFewHundredPolygons) {
  const Gear gear;
  const Result<std::vector<Polytope>> pieces = gear_pieces(gear);
  ASSERT_TRUE(pieces) << pieces.error().message();
  EXPECT_EQ(pieces->size(), 19u);
  std::size_t faces = 0;
  for (const Polytope& piece : *pieces) {
    EXPECT_EQ(piece.vertices.size() + piece.faces.size(), piece.edges.size() + 2);
    EXPECT_LT(convexity_defect(piece), 4 * tolerances::kCoplanar * piece.extent.size);
    faces += piece.faces.size();
  }
  EXPECT_GE(faces, 300u);
  EXPECT_LE(faces, 600u);
  EXPECT_EQ(pieces->front().faces.size(), 2u + 1u + 1u + 2u * 9u);  // caps, foot, tip, flanks with their feet
}

TEST(Gear, FlanksLieOnTheInvolute) {
  // String unwound from the base circle: at roll t the point is base (cos t + t sin t, sin t - t cos t). A
  // corner's distance from the axis gives its t, and so the polar angle it must have, but for one constant
  // per flank.
  const Gear gear;
  const Polygon tooth = gear_outlines(gear)->front();
  const double base = gear.base_radius_m();
  double constant = 0.0;
  int corners = 0;
  for (std::size_t i = 0; i < tooth.size() / 2; ++i) {
    const double radius = tooth[i].norm();
    if (radius < base * (1.0 + 1e-12)) continue;
    const double t = std::sqrt(radius * radius / (base * base) - 1.0);
    const Vec2 unwound(std::cos(t) + t * std::sin(t), std::sin(t) - t * std::cos(t));
    const double offset = std::atan2(tooth[i].y(), tooth[i].x()) - std::atan2(unwound.y(), unwound.x());
    if (corners++ == 0) constant = offset;
    EXPECT_NEAR(offset, constant, 1e-12) << "corner " << i;
  }
  EXPECT_EQ(corners, gear.flank_facets);
  EXPECT_NEAR(tooth[tooth.size() / 2].norm(), gear.tip_radius_m(), 1e-15);
  EXPECT_NEAR(tooth.front().norm(), gear.root_radius_m(), 1e-15);
}

TEST(Gear, PiecesOverlapNowhereAndShareTheirFeet) {
  const std::vector<Polygon> outlines = *gear_outlines(Gear{});
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    EXPECT_GT(polygon_area(outlines[i]), 0.0);
    for (std::size_t k = i + 1; k < outlines.size(); ++k)
      EXPECT_GT(separation(outlines[i], outlines[k]), -1e-15) << i << " and " << k;
  }
  const Polygon& hub = outlines.back();
  for (std::size_t tooth = 0; tooth + 1 < outlines.size(); ++tooth) {
    EXPECT_EQ(outlines[tooth].front(), hub[2 * tooth]);
    EXPECT_EQ(outlines[tooth].back(), hub[2 * tooth + 1]);
  }
}

TEST(Gear, PairTurnsFreelyInTheMiddleOfItsPlay) {
  for (const auto& [teeth_a, teeth_b] : {std::pair(18, 18), std::pair(18, 20), std::pair(23, 61)}) {
    Gear a, b;
    a.teeth = teeth_a;
    b.teeth = teeth_b;
    const Pair pair(a, b);
    double least = 1e300;
    for (int step = 0; step <= testing::effort(400, 100); ++step) {
      const double angle =
          2.0 * 2.0 * kPi / teeth_a * step / testing::effort(400.0, 100.0) - 0.3;  // two teeth pass
      least = std::min(least, pair.separation_at(angle, pair.middle_b(angle)));
    }
    // Half the play, seen along the line of action, is free on either side.
    EXPECT_GE(least, 0.5 * a.backlash_m * std::cos(a.pressure_angle_rad) - 1e-9) << teeth_a << ":" << teeth_b;
    EXPECT_LE(least, a.backlash_m);
  }
}

TEST(Gear, PlayOfThePairIsTheBacklashAskedFor) {
  for (const double backlash : {0.0001, 0.0003, 0.001}) {
    Gear a, b;
    b.teeth = 20;
    a.backlash_m = b.backlash_m = backlash;
    const Pair pair(a, b);
    for (int step = 0; step < 12; step += testing::effort(1, 5)) {
      const double angle = 2.0 * kPi / a.teeth * step / 12.0;
      const double play = (pair.free_turn(angle, 1.0) + pair.free_turn(angle, -1.0)) * b.pitch_radius_m();
      EXPECT_GT(play, backlash - 1e-8) << "angle " << angle;
      EXPECT_LT(play, backlash + 4.0 * 1.3 * chord(b) / std::cos(a.pressure_angle_rad)) << "angle " << angle;
    }
  }
}

TEST(Gear, BlockedTeethMeetInEitherSense) {
  Gear a, b;
  b.teeth = 20;
  const Pair pair(a, b);
  for (const double sign : {-1.0, 1.0}) {
    const double beyond = 1.5 * b.backlash_m / b.pitch_radius_m();
    EXPECT_LT(pair.separation_at(0.1, pair.middle_b(0.1) + sign * beyond), 0.0);
  }
}

TEST(Gear, ShiftedPairTurnsAtItsOwnDistanceWithTheSamePlay) {
  // ISO 21771's worked rule: inv(alpha_w) = inv(alpha) + 2 (x1 + x2) tan(alpha) / (z1 + z2).
  struct Shifts {
    int teeth_a, teeth_b;
    double a, b;
  };
  for (const Shifts& shifts :
       {Shifts{12, 30, 0.4, 0.2}, Shifts{18, 20, 0.5, -0.05}, Shifts{14, 40, 0.3, -0.3}}) {
    Gear a, b;
    a.teeth = shifts.teeth_a;
    b.teeth = shifts.teeth_b;
    a.profile_shift = shifts.a;
    b.profile_shift = shifts.b;
    a.addendum = b.addendum = 0.95;  // tips of a shifted pair come nearer to the roots
    const Pair pair(a, b);
    const double working = std::acos((a.base_radius_m() + b.base_radius_m()) / pair.centres);
    const double alpha = a.pressure_angle_rad;
    EXPECT_NEAR(std::tan(working) - working,
                std::tan(alpha) - alpha +
                    2.0 * (shifts.a + shifts.b) * std::tan(alpha) / (shifts.teeth_a + shifts.teeth_b),
                1e-14);
    for (int step = 0; step < 2; ++step) {
      const double angle = 2.0 * kPi / a.teeth * step / 2.0;
      const double play = (pair.free_turn(angle, 1.0) + pair.free_turn(angle, -1.0)) * b.pitch_radius_m();
      EXPECT_GT(play, b.backlash_m - 1e-8) << shifts.teeth_a << " step " << step;
      EXPECT_LT(play, b.backlash_m + 2.6 * (chord(a) + chord(b)) / std::cos(alpha)) << shifts.teeth_a;
    }
  }
}

TEST(Gear, ShiftWidensTheToothAndMovesItOut) {
  Gear plain, shifted;
  shifted.profile_shift = 0.25;
  EXPECT_NEAR(shifted.tip_radius_m() - plain.tip_radius_m(), 0.25 * plain.module_m, 1e-15);
  EXPECT_NEAR(shifted.root_radius_m() - plain.root_radius_m(), 0.25 * plain.module_m, 1e-15);
  EXPECT_EQ(centre_distance(plain, plain), 2.0 * plain.pitch_radius_m());
  EXPECT_GT(centre_distance(plain, shifted), 2.0 * plain.pitch_radius_m());
  EXPECT_LT(centre_distance(plain, shifted), 2.0 * plain.pitch_radius_m() + 0.25 * plain.module_m);
  // The foot, at the base circle or below, widens as the pitch circle does: by 2 x tan(alpha) modules an
  // angle of 2 x tan(alpha) / (z / 2).
  const auto foot_angle = [](const Gear& gear) {
    const Polygon tooth = gear_outlines(gear)->front();
    return std::atan2(tooth.back().y(), tooth.back().x());
  };
  EXPECT_NEAR(foot_angle(shifted) - foot_angle(plain), 2.0 * 0.25 * std::tan(kPi / 9.0) / 18.0, 1e-14);
  shifted.teeth = 13;
  EXPECT_TRUE(gear_pieces(shifted)) << "a shift allows fewer teeth than 18";
}

TEST(Gear, SurfaceIsTheSameSolidAsThePieces) {
  for (const auto& [teeth, facets] : {std::pair(18, 8), std::pair(80, 3), std::pair(20, 64)}) {
    Gear gear;
    gear.teeth = teeth;
    gear.flank_facets = facets;
    const auto surface = gear_surface(gear);
    ASSERT_TRUE(surface) << surface.error().message();
    const MeshReport report = report_mesh(*surface, 0.0);
    EXPECT_TRUE(report.closed && report.manifold() && report.oriented);
    EXPECT_EQ(report.components, 1);
    EXPECT_EQ(report.euler, 2);
    EXPECT_TRUE(report.zero_area.empty());
    EXPECT_EQ(report.vertices, static_cast<int>(surface->vertices.size()));
    const bool foot = gear.root_radius_m() < gear.base_radius_m();
    EXPECT_EQ(report.triangles, 8 * teeth * (facets + (foot ? 2 : 1)));
    double area = 0.0;
    const std::vector<Polygon> outlines = *gear_outlines(gear);
    for (const Polygon& piece : outlines) area += polygon_area(piece);
    EXPECT_NEAR(report.volume / (area * gear.face_width_m), 1.0, 1e-12);
    std::vector<std::vector<Vec3>> clouds;
    const std::vector<Polytope> solid = *gear_pieces(gear);
    for (const Polytope& piece : solid) clouds.push_back(piece.vertices);
    const auto pieces = part_from_clouds(clouds);
    ASSERT_TRUE(pieces);
    const auto whole = part_from_mesh(*surface, {.pieces = PieceSource::kSurface});
    ASSERT_TRUE(whole);
    EXPECT_TRUE(whole->is_surface());
    EXPECT_NEAR(whole->mass.volume / pieces->mass.volume, 1.0, 1e-12);
    EXPECT_TRUE(whole->mass.inertia.isApprox(pieces->mass.inertia, 1e-11));
    EXPECT_NEAR((whole->mass.center - pieces->mass.center).norm(), 0.0, 1e-15);
  }
}

TEST(Gear, SurfacePairIsAsFarApartAsItsPieces) {
  Gear a, b;
  b.teeth = 20;
  const Pair pair(a, b);
  const Surface first(*gear_surface(a));
  const Surface second(*gear_surface(b));
  SurfacePairCache cache;
  for (const double angle : {0.0, 0.05, 0.11}) {
    for (const double play : {0.0, 0.4}) {  // fractions of half the play
      const double angle_b = pair.middle_b(angle) + play * 0.5 * b.backlash_m / b.pitch_radius_m();
      const Mat3 R_a = exp_rotation(Vec3(0, 0, angle));
      const Pose X_AB{R_a.transpose() * exp_rotation(Vec3(0, 0, angle_b)),
                      R_a.transpose() * Vec3(centre_distance(a, b), 0, 0)};
      const double distance = surface_distance(first, second, X_AB, cache).distance;
      // The planar referee measures along sides: at most the distance, and equal for side against corner.
      EXPECT_NEAR(distance, pair.separation_at(angle, angle_b), 1e-9);
    }
  }
}

TEST(Gear, FacetsReachTheTrianglesOfRealGears) {
  Gear medium, small;
  medium.teeth = 40;
  small.teeth = 20;
  medium.flank_facets = 108;
  small.flank_facets = 126;
  EXPECT_GT(gear_surface(medium)->triangles.size(), 34'800u);
  EXPECT_GT(gear_surface(small)->triangles.size(), 20'400u);
}

TEST(Gear, RefusesWhatCannotBe) {
  const auto message = [](auto change) {
    Gear gear;
    change(gear);
    const auto pieces = gear_pieces(gear);
    return pieces ? std::string() : pieces.error().message();
  };
  EXPECT_EQ(message([](Gear&) {}), "");
  EXPECT_NE(message([](Gear& g) { g.teeth = 9; }).find("found 9, expected 18 to 400"), std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.module_m = -1; }).find("module"), std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.module_m = std::nan(""); }).find("module"), std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.backlash_m = 0.01; }).find("backlash"), std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.pressure_angle_rad = 1.5; }).find("pressure angle"), std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.profile_shift = 1.5; }).find("profile shift"), std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.profile_shift = -0.2; }).find("found 18, expected 21 to 400"),
            std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.flank_facets = 257; }).find("2 to 256"), std::string::npos);
  EXPECT_NE(message([](Gear& g) {
              g.teeth = 8;
              g.profile_shift = 1.0;
              g.addendum = 0.1;
              g.dedendum = 2.0;
              g.pressure_angle_rad = kPi / 6.0;
              g.backlash_m = 0.0;
            }).find("meet at their feet"),
            std::string::npos);
  EXPECT_NE(message([](Gear& g) { g.dedendum = 0.5; }).find("dedendum"), std::string::npos);
  EXPECT_NE(message([](Gear& g) {
              g.pressure_angle_rad = kPi / 6.0;
              g.addendum = 1.5;
              g.dedendum = 1.75;
            }).find("tip"),
            std::string::npos);
}

TEST(Gear, LargeGearsHaveNoRadialFoot) {
  Gear gear;
  gear.teeth = 80;
  ASSERT_GT(gear.root_radius_m(), gear.base_radius_m());
  const auto pieces = gear_pieces(gear);
  ASSERT_TRUE(pieces) << pieces.error().message();
  EXPECT_EQ(pieces->front().faces.size(), 4u + 2u * 8u);
}

}  // namespace
}  // namespace tactum::gear_test
