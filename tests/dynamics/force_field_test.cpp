/// Force fields against their formulas: potentials and circulations, grids at and between their nodes, and
/// the wrench on bodies of points.

#include "tactum/dynamics/force_field.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>

#include "support/effort.h"
#include "support/solid_box.h"
#include "tactum/base/random.h"
#include "tactum/math/screw.h"

namespace tactum::force_field_test {
namespace {

const DipoleField kDipole{.moment_Nm3 = 2e-6, .core_m = 0.01};
const WellField kWell{.depth_J = 0.02, .width_m = 0.02};
const VortexField kVortex{.circulation_J = 0.1, .core_m = 0.015};

Vec3 random_point(Random& random, double range) {
  return {random.uniform(-range, range), random.uniform(-range, range), random.uniform(-range, range)};
}

Pose random_pose(Random& random, double range) {
  return {exp_rotation(random_point(random, 2.0)), random_point(random, range)};
}

/// Minus the gradient of a potential by central differences.
Vec3 downhill(const std::function<double(const Vec3&)>& potential, const Vec3& p) {
  const double h = 1e-5;
  Vec3 force;
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = h * Vec3::Unit(i);
    // Fourth order: the rest is rounding, 1e-11 N.
    force[i] = -(8.0 * (potential(p + step) - potential(p - step)) -
                 (potential(p + 2.0 * step) - potential(p - 2.0 * step))) /
               (12.0 * h);
  }
  return force;
}

Mat3 differences(const std::function<Vec3(const Vec3&)>& force, const Vec3& p) {
  const double h = 1e-5;
  Mat3 gradient;
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = h * Vec3::Unit(i);
    gradient.col(i) =
        (8.0 * (force(p + step) - force(p - step)) - (force(p + 2.0 * step) - force(p - 2.0 * step))) /
        (12.0 * h);
  }
  return gradient;
}

TEST(AnalyticField, DipoleAndWellPushDownTheirPotential) {
  Random random(11);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random, 0.05);
    EXPECT_LT(
        (value_at(kDipole, p).force - downhill([](const Vec3& x) { return potential_at(kDipole, x); }, p))
            .norm(),
        1e-8);
    EXPECT_LT(
        (value_at(kWell, p).force - downhill([](const Vec3& x) { return potential_at(kWell, x); }, p)).norm(),
        1e-8);
  }
}

TEST(AnalyticField, GradientsAreThoseOfTheForceAndNoneIsSteeper) {
  Random random(12);
  const auto check = [&](const auto& field) {
    double most = 0.0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = random_point(random, 0.03);
      const Mat3 gradient = value_at(field, p).gradient;
      const Mat3 seen = differences([&](const Vec3& x) { return value_at(field, x).force; }, p);
      EXPECT_LT((gradient - seen).norm(), 1e-6 * steepest(field));
      const double stretch = std::sqrt(
          (gradient.transpose() * gradient).eval().selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
      EXPECT_LE(stretch, steepness(gradient) * (1.0 + 1e-12));
      most = std::max(most, stretch);
    }
    EXPECT_LE(most, steepest(field) * (1.0 + 1e-12));
    EXPECT_GT(most, 0.5 * steepest(field)) << "the bound is far from what is there";
  };
  check(kDipole);
  check(kWell);
  check(kVortex);
}

TEST(AnalyticField, AVortexTurnsAndFarFromItsAxisATurnIsWorthItsCirculation) {
  for (const double radius : {0.005, 0.02, 2.0}) {
    double work_J = 0.0;
    constexpr int kSteps = 360;
    for (int i = 0; i < kSteps; ++i) {
      const double angle = 2.0 * kPi * i / kSteps;
      const Vec3 p(radius * std::cos(angle), radius * std::sin(angle), 0.7);
      work_J += value_at(kVortex, p).force.dot(Vec3(-p.y(), p.x(), 0.0)) * (2.0 * kPi / kSteps);
    }
    const double inside = radius * radius / (radius * radius + kVortex.core_m * kVortex.core_m);
    EXPECT_NEAR(work_J, kVortex.circulation_J * inside, 1e-12);
  }
  Random random(13);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = random_point(random, 0.05);
    const Mat3 J = value_at(kVortex, p).gradient;
    const double rho_sq = p.x() * p.x() + p.y() * p.y() + kVortex.core_m * kVortex.core_m;
    const double curl = kVortex.circulation_J / kPi * kVortex.core_m * kVortex.core_m / (rho_sq * rho_sq);
    EXPECT_NEAR(J(1, 0) - J(0, 1), curl, 1e-12 * steepest(kVortex));
    EXPECT_NEAR(J.trace(), 0.0, 1e-12 * steepest(kVortex));
  }
}

/// A grid of 0.08 m about the origin.
GridShape shape_of(int nodes, double side = 0.08) {
  GridShape shape;
  shape.nodes = {nodes, nodes, nodes};
  shape.spacing = Vec3::Constant(side / (nodes - 1));
  shape.origin = Vec3::Constant(-0.5 * side);
  return shape;
}

template <class Field>
std::shared_ptr<const FieldGrid> grid_of(const Field& field, const GridShape& shape) {
  Result<FieldGrid> grid =
      FieldGrid::make(shape, sampled<double>(shape, [&](const Vec3& p) { return value_at(field, p).force; }));
  EXPECT_TRUE(grid) << grid.error().message();
  return std::make_shared<const FieldGrid>(std::move(*grid));
}

TEST(FieldGrid, AtNodesItIsTheField) {
  // Sides of different length and count, so that no axis can be taken for another.
  GridShape shape;
  shape.nodes = {31, 17, 23};
  shape.spacing = {0.0021, 0.0047, 0.0033};
  shape.origin = {-0.031, -0.042, -0.027};
  const auto grid = grid_of(kDipole, shape);
  double worst = 0.0;
  for (int k = 0; k < shape.nodes[2]; ++k)
    for (int j = 0; j < shape.nodes[1]; ++j)
      for (int i = 0; i < shape.nodes[0]; ++i) {
        const Vec3 p = shape.node(i, j, k);
        worst = std::max(worst, (grid->at(p).force - value_at(kDipole, p).force).norm());
      }
  EXPECT_LT(worst, 1e-12);
}

TEST(FieldGrid, BetweenNodesItIsLinearInEachDirection) {
  // Functions that are linear in each direction are met exactly, mixed terms too, and so is their gradient.
  const auto force = [](const Vec3& p) {
    const double x = p.x(), y = p.y(), z = p.z();
    return Vec3(1.0 + 2.0 * x - 3.0 * y * z, x * y * z * 400.0 - z, 0.5 - x * z * 30.0 + y);
  };
  const auto gradient = [](const Vec3& p) {
    const double x = p.x(), y = p.y(), z = p.z();
    Mat3 J;
    J << 2.0, -3.0 * z, -3.0 * y, 400.0 * y * z, 400.0 * x * z, 400.0 * x * y - 1.0, -30.0 * z, 1.0,
        -30.0 * x;
    return J;
  };
  GridShape shape;
  shape.nodes = {5, 4, 6};
  shape.spacing = {0.02, 0.03, 0.025};
  shape.origin = {-0.03, 0.01, -0.05};
  const Result<FieldGrid> grid = FieldGrid::make(shape, sampled<double>(shape, force));
  ASSERT_TRUE(grid);
  Random random(14);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p(random.uniform(-0.03, 0.05), random.uniform(0.01, 0.1), random.uniform(-0.05, 0.075));
    const FieldValue value = grid->at(p);
    EXPECT_LT((value.force - force(p)).norm(), 1e-13);
    EXPECT_LT((value.gradient - gradient(p)).norm(), 1e-11);
  }
}

TEST(FieldGrid, OutsideItFadesWithoutAStepAndIsThenNothing) {
  const GridShape shape = shape_of(9);
  for (const double edge_m : {0.0, 0.004}) {
    const Result<FieldGrid> grid = FieldGrid::make(
        shape, sampled<double>(shape, [](const Vec3&) { return Vec3(1.0, 2.0, 3.0); }), edge_m);
    ASSERT_TRUE(grid);
    const double edge = edge_m > 0.0 ? edge_m : 0.01;
    EXPECT_NEAR(grid->at({0.04 + 0.25 * edge, 0, 0}).force.y(), 1.5, 1e-12);
    EXPECT_NEAR(grid->at({0.04 + 0.5 * edge, 0, -0.04 - 0.5 * edge}).force.y(), 0.5, 1e-12);
    EXPECT_TRUE(grid->at({0, 0.04 + 1.001 * edge, 0}).force.isZero(0.0));
    EXPECT_TRUE(grid->at({0, 0, -1e300}).force.isZero(0.0));
    EXPECT_TRUE(grid->at({std::nan(""), 0, 0}).force.allFinite());
    // Steepest at a corner, where it falls along all three axes.
    EXPECT_NEAR(grid->steepest(), std::sqrt(9.0 / edge * 6.0 / edge), 1e-6);
    Random random(15);
    for (int i = 0; i < 2000; ++i) {  // no step anywhere, and the gradient says how it changes
      const Vec3 p = random_point(random, 0.055);
      const FieldValue value = grid->at(p);
      const Vec3 step = random_point(random, 1e-9);
      const Vec3 change = grid->at(p + step).force - value.force;
      EXPECT_LE(change.norm(), 1.1 * steepness(value.gradient) * step.norm() + 1.8e-9 * 3.75 / edge);
    }
    const Vec3 p(0.04 + 0.3 * edge, 0.01, -0.04 - 0.6 * edge);
    EXPECT_LT(
        (grid->at(p).gradient - differences([&](const Vec3& x) { return grid->at(x).force; }, p)).norm(),
        1e-6 / edge);
  }
}

TEST(FieldGrid, SinglePrecisionIsTheSameField) {
  const GridShape shape = shape_of(17);
  const auto force = [](const Vec3& p) { return value_at(kWell, p).force; };
  const Result<FieldGrid> single = FieldGrid::make(shape, sampled<float>(shape, force));
  const Result<FieldGrid> whole = FieldGrid::make(shape, sampled<double>(shape, force));
  ASSERT_TRUE(single);
  ASSERT_TRUE(whole);
  Random random(16);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random, 0.05);
    EXPECT_LT((single->at(p).force - whole->at(p).force).norm(), 1e-7 * 0.61);
  }
}

TEST(FieldGrid, RefusesWhatIsNoGrid) {
  const GridShape good = shape_of(3);
  const auto error = [](const GridShape& shape, std::size_t numbers, double edge = 0.0) {
    const Result<FieldGrid> grid = FieldGrid::make(shape, std::vector<double>(numbers, 0.0), edge);
    return grid ? "none" : grid.error().message();
  };
  EXPECT_EQ(error(good, 81), "none");
  EXPECT_NE(error(good, 80).find("found 80 numbers, expected 81"), std::string::npos);
  EXPECT_NE(error(good, 81, -1.0).find("edge"), std::string::npos);
  EXPECT_NE(error(good, 81, std::nan("")).find("edge"), std::string::npos);
  GridShape bad = good;
  bad.nodes[1] = 1;
  EXPECT_NE(error(bad, 27).find("along y: found 1, expected 2 to 4096"), std::string::npos);
  bad = good;
  bad.nodes[2] = 2'000'000'000;
  EXPECT_NE(error(bad, 27).find("along z"), std::string::npos);
  for (const double spacing : {0.0, -0.01, std::nan(""), 1e-320}) {
    bad = good;
    bad.spacing.y() = spacing;
    EXPECT_NE(error(bad, 81).find("spacing"), std::string::npos);
  }
  bad = good;
  bad.origin.x() = std::numeric_limits<double>::infinity();
  EXPECT_NE(error(bad, 81).find("origin"), std::string::npos);
  std::vector<float> numbers(81, 0.0f);
  numbers[3 * (1 + 3 * 2) + 1] = std::numeric_limits<float>::quiet_NaN();
  const Result<FieldGrid> grid = FieldGrid::make(good, numbers);
  ASSERT_FALSE(grid);
  EXPECT_NE(grid.error().message().find("node (1, 2, 0)"), std::string::npos) << grid.error().message();
}

/// The sums of the definition, with the formula itself at every point.
template <class Field>
Wrench summed(const Field& field, const std::vector<FieldPoint>& points, const Pose& X_WF, const Pose& X_WB) {
  Wrench sum;
  for (const FieldPoint& point : points) {
    const Vec3 p_W = X_WB * point.p_B;
    const Vec3 force = point.weight * (X_WF.R * value_at(field, X_WF.inverse() * p_W).force);
    sum = sum + Wrench{force, (p_W - X_WB.p).cross(force)};
  }
  return sum;
}

std::vector<FieldPoint> block_points(int count) {
  return spread_over(solid_box({0.010, 0.007, 0.005})->surface, count);
}

TEST(FieldLoad, IsMinusTheGradientOfTheBodysEnergyTurnsIncluded) {
  const std::vector<FieldPoint> points = block_points(60);
  Random random(17);
  const auto check = [&](const auto& field) {
    for (int i = 0; i < 50; ++i) {
      ForceField placed{.shape = field, .X_WF = random_pose(random, 0.02), .scale = 1.7};
      const Pose X_WB = random_pose(random, 0.02);
      const Wrench load = field_load({&placed, 1}, points, X_WB, Vec3::Zero()).at_centre;
      const auto energy = [&](const Vec6& x) {
        const Pose X = advanced(X_WB, {x.head<3>(), x.tail<3>()}, 1.0);
        double sum = 0.0;
        for (const FieldPoint& point : points)
          sum += placed.scale * point.weight * potential_at(field, placed.X_WF.inverse() * (X * point.p_B));
        return sum;
      };
      const double h = 1e-4;
      for (int axis = 0; axis < 6; ++axis) {
        const Vec6 step = h * Vec6::Unit(axis);
        const double slope =
            -(8.0 * (energy(step) - energy(-step)) - (energy(2.0 * step) - energy(-2.0 * step))) / (12.0 * h);
        EXPECT_NEAR(axis < 3 ? load.f[axis] : load.t[axis - 3], slope, axis < 3 ? 2e-6 : 1e-9);
      }
    }
  };
  check(kDipole);
  check(kWell);
}

TEST(FieldLoad, ARingInAVortexIsTurnedByWhatItsFormulaSays) {
  std::vector<FieldPoint> ring;
  constexpr int kPoints = 24;
  const double radius = 0.02;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * kPi * i / kPoints;
    ring.push_back({{radius * std::cos(angle), radius * std::sin(angle), 0.0}, 1.0 / kPoints});
  }
  const ForceField vortex{.shape = kVortex};
  const Wrench load = field_load({&vortex, 1}, ring, {}, Vec3::Zero()).at_centre;
  EXPECT_LT(load.f.norm(), 1e-15);
  const double share = radius * radius / (radius * radius + kVortex.core_m * kVortex.core_m);
  EXPECT_LT((load.t - Vec3(0, 0, kVortex.circulation_J / (2.0 * kPi) * share)).norm(), 1e-15);
}

TEST(FieldLoad, OfAGridIsExactAtNodesForAnyPlaceOfTheField) {
  // A body whose points are nodes: force and torque are those of the formula.
  const GridShape shape = shape_of(33);
  std::vector<FieldPoint> points;
  for (const auto& [i, j, k] : {std::array{10, 12, 20}, {11, 12, 20}, {16, 16, 16}, {20, 30, 2}, {32, 0, 32}})
    points.push_back({shape.node(i, j, k) - Vec3(0.001, 0.002, 0.003), 0.2});
  Random random(18);
  const auto check = [&](const auto& field) {
    const auto grid = grid_of(field, shape);
    for (int i = 0; i < 50; ++i) {
      const ForceField placed{.shape = grid, .X_WF = random_pose(random, 1.0)};
      const Pose X_WB = placed.X_WF * Pose{Mat3::Identity(), {0.001, 0.002, 0.003}};
      const Wrench load = field_load({&placed, 1}, points, X_WB, Vec3::Zero()).at_centre;
      const Wrench truth = summed(field, points, placed.X_WF, X_WB);
      EXPECT_LT((load.f - truth.f).norm(), 1e-9);
      EXPECT_LT((load.t - truth.t).norm(), 1e-9);
    }
  };
  check(kDipole);
  check(kWell);
  check(kVortex);
}

TEST(FieldLoad, OfAGridConvergesWithTheSquareOfItsSpacing) {
  const std::vector<FieldPoint> points = block_points(100);
  const int levels = testing::effort(4, 3);
  const auto check = [&](const auto& field, const char* name) {
    double force_error[4], torque_error[4];
    for (int level = 0; level < levels; ++level) {
      const auto grid = grid_of(field, shape_of((16 << level) + 1));
      Random random(19);
      double force_sum = 0.0, torque_sum = 0.0;
      for (int i = 0; i < 200; ++i) {
        const ForceField placed{.shape = grid, .X_WF = random_pose(random, 0.1)};
        const Pose X_WB = placed.X_WF * random_pose(random, 0.02);
        const Wrench error = field_load({&placed, 1}, points, X_WB, Vec3::Zero()).at_centre -
                             summed(field, points, placed.X_WF, X_WB);
        force_sum += error.f.squaredNorm();
        torque_sum += error.t.squaredNorm();
      }
      force_error[level] = std::sqrt(force_sum / 200.0);
      torque_error[level] = std::sqrt(torque_sum / 200.0);
    }
    for (int level = 1; level < levels; ++level) {
      const double force_order = std::log2(force_error[level - 1] / force_error[level]);
      const double torque_order = std::log2(torque_error[level - 1] / torque_error[level]);
      std::cout << name << " " << (16 << level) << " cells: force " << force_error[level] << " N, order "
                << force_order << "; torque " << torque_error[level] << " N m, order " << torque_order
                << "\n";
      EXPECT_NEAR(force_order, 2.0, 0.2) << name << " " << level;
      EXPECT_NEAR(torque_order, 2.0, 0.2) << name << " " << level;
    }
  };
  check(kDipole, "dipole");
  check(kWell, "well");
  check(kVortex, "vortex");
}

TEST(FieldLoad, LimitsScaleTheWholeWrenchAndFieldsAddUp) {
  const std::vector<FieldPoint> points = block_points(40);
  const Pose X_WB{exp_rotation({0.2, 0.1, -0.3}), {0.012, -0.004, 0.006}};
  ForceField field{.shape = kDipole, .scale = 3.0};
  const Wrench free = field_load({&field, 1}, points, X_WB, Vec3::Zero()).at_centre;
  for (const bool by_force : {true, false}) {
    field.largest_force_N = by_force ? 0.25 * free.f.norm() : 1e9;
    field.largest_torque_Nm = by_force ? 1e9 : 0.25 * free.t.norm();
    const Wrench cut = field_load({&field, 1}, points, X_WB, Vec3::Zero()).at_centre;
    EXPECT_LT((cut.f - 0.25 * free.f).norm(), 1e-12);
    EXPECT_LT((cut.t - 0.25 * free.t).norm(), 1e-12);
  }
  const std::vector<ForceField> both{{.shape = kDipole, .scale = 3.0},
                                     {.shape = kWell, .X_WF = {Mat3::Identity(), {0.01, 0, 0}}}};
  const Wrench sum = field_load(both, points, X_WB, Vec3::Zero()).at_centre;
  EXPECT_LT((sum.f - free.f - summed(kWell, points, both[1].X_WF, X_WB).f).norm(), 1e-14);
}

TEST(FieldLoad, NoChangeOfTheLoadIsFasterThanItsStiffness) {
  const std::vector<FieldPoint> points = block_points(40);
  Random random(20);
  for (int i = 0; i < 200; ++i) {
    const ForceField field{.shape = kDipole, .X_WF = random_pose(random, 0.02)};
    const Pose X_WB = random_pose(random, 0.02);
    const Vec3 p_BH = random_point(random, 0.02);
    const FieldLoad load = field_load({&field, 1}, points, X_WB, p_BH);
    const Vec3 displacement = random_point(random, 1e-6);
    const Vec3 turn = random_point(random, 1e-4);
    // The handle goes by `displacement` and turns.
    const Pose X_WH{X_WB.R, X_WB * p_BH};
    const Pose X_WB_then = advanced(X_WH, {displacement, turn}, 1.0) * Pose{Mat3::Identity(), -p_BH};
    const auto at_handle = [&](const Pose& X) {
      return moved(field_load({&field, 1}, points, X, p_BH).at_centre, X.R * p_BH);
    };
    const Wrench change = at_handle(X_WB_then) - at_handle(X_WB);
    // A moving point is pulled by at most sqrt(k) sqrt(energy) of each.
    const double work = std::abs(change.f.dot(displacement) + change.t.dot(turn));
    const double most = load.stiffness_N_per_m * 2.0 * displacement.squaredNorm() +
                        load.stiffness_Nm_per_rad * 2.0 * turn.squaredNorm();
    EXPECT_LE(work, most);
  }
}

TEST(FieldPoints, AreSpreadEvenlyAndAlwaysTheSame) {
  const auto box = solid_box({0.010, 0.007, 0.005});
  const std::vector<FieldPoint> points = spread_over(box->surface, 400);
  ASSERT_EQ(points.size(), 400u);
  Vec3 mean = Vec3::Zero();
  double weight = 0.0;
  int on_top = 0;
  for (const FieldPoint& point : points) {
    mean += point.weight * point.p_B;
    weight += point.weight;
    const Vec3 share = point.p_B.cwiseAbs().cwiseQuotient(Vec3(0.010, 0.007, 0.005));
    EXPECT_NEAR(share.maxCoeff(), 1.0, 1e-9) << "off the surface";
    on_top += std::abs(point.p_B.z() - 0.005) < 1e-9 ? 1 : 0;
  }
  EXPECT_NEAR(weight, 1.0, 1e-12);
  EXPECT_LT(mean.norm(), 3e-4);
  const double top_share = 0.020 * 0.014 / (2.0 * (0.020 * 0.014 + 0.020 * 0.010 + 0.014 * 0.010));
  EXPECT_NEAR(on_top, 400 * top_share, 3.0);
  const std::vector<FieldPoint> again = spread_over(box->surface, 400);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].p_B, again[i].p_B);
  EXPECT_TRUE(spread_over({}, 10).empty());
}

}  // namespace
}  // namespace tactum::force_field_test
