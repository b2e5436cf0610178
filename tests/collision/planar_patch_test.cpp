#include "tactum/collision/planar_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "collision/cases.h"

namespace tactum {
namespace {

/// A convex polygon of so many random corners on an ellipse, some of them often shared with another's.
PatchPolygon random_polygon(Random& random, int corners) {
  std::vector<double> angles;
  for (int i = 0; i < corners; ++i)
    angles.push_back(random.index(2) ? 0.1 * random.index(62) : random.uniform(0.0, 2.0 * kPi));
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
  const Vec2 middle(0.1 * random.index(3), random.index(2) ? 0.0 : random.unit());
  const double wide = random.index(2) ? 1.0 : random.uniform(0.01, 1.0);
  PatchPolygon polygon;
  for (double angle : angles) polygon.push_back(middle + Vec2(wide * std::cos(angle), std::sin(angle)));
  return polygon;
}

/// All sides of the window at once, however many, against cutting by one side after the other.
TEST(PlanarPatch, ClippingByAWindowAgreesWithClippingSideBySide) {
  const std::uint64_t seed = 35;
  Random random(seed);
  for (int i = 0; i < cases::some_of(20000); ++i) {
    const int most = i % 2 ? 6 : kPatchCorners;
    const PatchPolygon polygon = random_polygon(random, 3 + random.index(most - 2));
    const PatchPolygon window =
        i % 40 == 1 ? polygon : random_polygon(random, 3 + random.index(i % 4 == 1 ? 2 : most - 2));
    if (polygon.size() < 3 || window.size() < 3) continue;
    PatchPolygon at_once = polygon;
    clip_polygon(at_once, window);
    PatchPolygon by_sides = polygon;
    for (std::size_t k = 0; k < window.size(); ++k) {
      const Vec2 side = window[(k + 1) % window.size()] - window[k];
      const Vec2 outward = Vec2(side.y(), -side.x()).normalized();
      clip_polygon(by_sides, outward, outward.dot(window[k]));
    }
    ASSERT_NEAR(twice_area(at_once), twice_area(by_sides), 1e-9) << "seed " << seed << " case " << i;
  }
}

/// Windows of one and two corners, which enclose nothing, and repeated corners, which bound nothing.
TEST(PlanarPatch, ClippingByAWindowWithoutSidesKeepsWhatIsInside) {
  const auto clipped = [](std::initializer_list<Vec2> window_corners) {
    PatchPolygon polygon;
    PatchPolygon window;
    for (const Vec2& corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)}) polygon.push_back(corner);
    for (const Vec2& corner : window_corners) window.push_back(corner);
    clip_polygon(polygon, window);
    return 0.5 * twice_area(polygon);
  };
  EXPECT_EQ(clipped({{0, 0}}), 4.0);
  EXPECT_EQ(clipped({{0, -2}, {0, 2}}), 0.0);
  EXPECT_EQ(clipped({{0, -2}, {2, 0}, {2, 0}, {0, 2}}), clipped({{0, -2}, {2, 0}, {0, 2}}));
  const double square = clipped({{-.2, -1.4}, {1.4, -.2}, {.2, 1.4}, {-1.4, .2}});
  EXPECT_NEAR(clipped({{-.2, -1.4}, {1.4, -.2}, {.2, 1.4}, {-1.4, .2}, {-1.4, .2}}), square, 1e-14);
}

/// A star of so many corners.
PatchPolygon random_star(Random& random, int corners) {
  PatchPolygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * kPi * (i + 0.9 * random.uniform(0.0, 1.0)) / corners;
    polygon.push_back(random.uniform(0.1, 3.0) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

/// A damaged part may hold faces that are not convex: the patch then means little, but is within bounds.
TEST(PlanarPatch, ClippingWhatIsNotConvexStaysWithinBounds) {
  const std::uint64_t seed = 36;
  Random random(seed);
  for (int i = 0; i < cases::some_of(20000); ++i) {
    PatchPolygon polygon = random_star(random, 3 + random.index(4));
    clip_polygon(polygon, random_star(random, 1 + random.index(6)));
    for (const Vec2& corner : polygon) ASSERT_LE(corner.norm(), 3.1) << "seed " << seed << " case " << i;
  }
}

/// ... nor by a box, that many sides cross. Stars of so many corners that there may be no room are given up.
TEST(PlanarPatch, ClippingWhatIsNotConvexByABoxStaysWithinIt) {
  const std::uint64_t seed = 40;
  Random random(seed);
  const int always_fit = int(PatchPolygon::capacity()) / 4;
  const int tries = cases::some_of(20000);
  std::size_t most = 0;
  int left = 0;
  for (int i = 0; i < tries; ++i) {
    const int most_corners = i % 2 ? always_fit : int(PatchPolygon::capacity());
    PatchPolygon polygon = random_star(random, 3 + random.index(most_corners - 2));
    const Vec2 middle(random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec2 half(random.index(3) ? random.uniform(0, 1) : 0.0,
                    random.index(3) ? random.uniform(0, 1) : 0.0);
    const PatchBox box{middle - half, middle + half};
    clip_polygon(polygon, box, 6.0);
    most = std::max(most, polygon.size());
    left += polygon.empty() ? 0 : 1;
    for (const Vec2& corner : polygon) {
      ASSERT_LE((box.low - corner).maxCoeff(), 1e-11) << "seed " << seed << " case " << i;
      ASSERT_LE((corner - box.high).maxCoeff(), 1e-11) << "seed " << seed << " case " << i;
    }
  }
  EXPECT_GT(most, std::size_t{kPatchCorners / 2});
  EXPECT_GT(left, tries / 3);
}

/// A face of the most corners there are of one, of which a box takes one off at each of its sides.
TEST(PlanarPatch, ClippingTheMostCornersByABoxKeepsThem) {
  PatchPolygon polygon;
  for (int i = 0; i < kPatchCorners; ++i) {
    const double angle = 2.0 * kPi * i / kPatchCorners;
    polygon.push_back({std::cos(angle), std::sin(angle)});
  }
  const double beside = std::cos(2.0 * kPi / kPatchCorners);
  const double half_width = 0.5 * (1.0 + beside);
  const double cut_off =
      (1.0 - half_width) * (1.0 - half_width) * std::sin(2.0 * kPi / kPatchCorners) / (1.0 - beside);
  const double area = 0.5 * twice_area(polygon);
  clip_polygon(polygon, PatchBox{{-half_width, -half_width}, {half_width, half_width}}, 3.0);
  EXPECT_EQ(polygon.size(), std::size_t{kPatchCorners + 4});
  EXPECT_NEAR(0.5 * twice_area(polygon), area - 4.0 * cut_off, 1e-14);
}

/// Both sides across an axis at once against one side after the other; corners on the sides, and boxes of no
/// width.
TEST(PlanarPatch, ClippingByABoxAgreesWithClippingSideBySide) {
  const std::uint64_t seed = 37;
  Random random(seed);
  int cut_to_nothing = 0;
  for (int i = 0; i < cases::some_of(20000); ++i) {
    const PatchPolygon polygon = random_polygon(random, 3 + random.index(i % 2 ? 6 : kPatchCorners - 2));
    if (polygon.size() < 3) continue;
    const auto value = [&](int axis) {
      return random.index(3) ? random.uniform(-1.2, 1.4) : polygon[random.index(int(polygon.size()))][axis];
    };
    PatchBox box;
    for (const int axis : {0, 1}) {
      const double one = value(axis);
      const double other = random.index(9) ? value(axis) : one;
      box.low[axis] = std::min(one, other);
      box.high[axis] = std::max(one, other);
    }
    PatchPolygon at_once = polygon;
    clip_polygon(at_once, box, 2.0);
    PatchPolygon by_sides = polygon;
    for (const int axis : {0, 1}) {
      clip_polygon(by_sides, -Vec2::Unit(axis), -box.low[axis]);
      clip_polygon(by_sides, Vec2::Unit(axis), box.high[axis]);
    }
    if (at_once.empty()) ++cut_to_nothing;
    ASSERT_NEAR(twice_area(at_once), twice_area(by_sides), 1e-11) << "seed " << seed << " case " << i;
    for (const Vec2& corner : at_once) {
      ASSERT_LE((box.low - corner).maxCoeff(), 1e-11) << "seed " << seed << " case " << i;
      ASSERT_LE((corner - box.high).maxCoeff(), 1e-11) << "seed " << seed << " case " << i;
    }
  }
  EXPECT_GT(cut_to_nothing, cases::some_of(1000));
}

/// Of a quadrilateral over a box: every corner that is left, in order.
TEST(PlanarPatch, ClippingByABoxKeepsTheOrderOfCorners) {
  PatchPolygon polygon;
  for (const Vec2& corner : {Vec2(-2, 0), Vec2(0, -2), Vec2(2, 0), Vec2(0, 2)}) polygon.push_back(corner);
  clip_polygon(polygon, PatchBox{{-1.5, -1}, {1, 3}}, 4.0);
  const std::vector<Vec2> expected = {{-1.5, 0.5}, {-1.5, -0.5}, {-1, -1}, {1, -1}, {1, 1}, {0, 2}};
  ASSERT_EQ(polygon.size(), expected.size());
  std::size_t first = 0;
  while (first < 6 && (polygon[first] - expected[0]).norm() > 1e-14) ++first;
  ASSERT_LT(first, 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT((polygon[(first + i) % 6] - expected[i]).norm(), 1e-14) << i;
}

/// Four points at the arms' ends have the polygon's moments; two polygons together those of both.
TEST(PlanarPatch, ArmsCarryTheSecondMoments) {
  const std::uint64_t seed = 38;
  Random random(seed);
  const auto second_of = [](const PatchSpread& arms) -> Eigen::Matrix2d {
    return 0.5 * (arms.u * arms.u.transpose() + arms.v * arms.v.transpose());
  };
  for (int i = 0; i < cases::some_of(20000); ++i) {
    const double by = std::pow(10.0, random.uniform(-6.0, 2.0));
    const double low = random.uniform(-1.0, 1.0);
    const double wide = random.uniform(1e-3, 2.0);
    const double high = random.uniform(1e-3, 2.0);
    const double cut = random.uniform(0.1, 0.9);
    const double turn = random.uniform(-kPi, kPi);
    const Eigen::Rotation2Dd R(turn);
    const auto rectangle = [&](double from, double to) {
      PatchPolygon polygon;
      for (const Vec2& x : {Vec2(from, 0), Vec2(to, 0), Vec2(to, high), Vec2(from, high)})
        polygon.push_back(by * (R * Vec2(low + x.x(), x.y())));
      return polygon;
    };
    const Eigen::Matrix2d expected = R.toRotationMatrix() * Vec2(wide * wide, high * high).asDiagonal() *
                                     R.inverse().toRotationMatrix() * (by * by / 12.0);
    const PatchMoments whole = moments_of(rectangle(0.0, wide));
    const PatchMoments parts =
        together(moments_of(rectangle(0.0, cut * wide)), moments_of(rectangle(cut * wide, wide)));
    for (const PatchMoments& m : {whole, parts, together(whole, {}), together({}, whole)}) {
      const Vec2 middle = by * (R * Vec2(low + 0.5 * wide, 0.5 * high));
      ASSERT_LT((m.centroid - middle).norm(), 1e-13 * by) << "seed " << seed << " case " << i;
      ASSERT_NEAR(m.area / (by * by), wide * high, 1e-12) << "seed " << seed << " case " << i;
      ASSERT_LT((second_of(spread_of(m, Eigen::Rotation2Dd(i) * Vec2::UnitX())) - expected).norm(),
                1e-11 * expected.norm() + 1e-13 * by * by)
          << "seed " << seed << " case " << i;
    }
  }
}

}  // namespace
}  // namespace tactum
