#include "tactum/scene/gear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum {
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
    EXPECT_LT(convexity_defect(piece), 4 * tolerances::kCoplanar * piece.size);
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
    for (int step = 0; step <= 400; ++step) {
      const double angle = 2.0 * 2.0 * kPi / teeth_a * step / 400.0 - 0.3;  // two teeth pass
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
    // Chords lie inside the tooth by at most radius of curvature * step^2 / 8 on each flank.
    const double last = std::sqrt(std::pow(b.tip_radius_m() / b.base_radius_m(), 2) - 1.0);
    const double chord = b.base_radius_m() * last * std::pow(last / b.flank_facets, 2) / 8.0;
    for (int step = 0; step < 12; ++step) {
      const double angle = 2.0 * kPi / a.teeth * step / 12.0;
      const double play = (pair.free_turn(angle, 1.0) + pair.free_turn(angle, -1.0)) * b.pitch_radius_m();
      EXPECT_GT(play, backlash - 1e-8) << "angle " << angle;
      EXPECT_LT(play, backlash + 4.0 * 1.3 * chord / std::cos(a.pressure_angle_rad)) << "angle " << angle;
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
}  // namespace tactum
