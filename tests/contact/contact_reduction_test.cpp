#include "tactum/contact/contact_reduction.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/cases.h"
#include "support/allocation_guard.h"

namespace tactum {
namespace {

const ReductionBounds kBounds{Vec3::Zero(), 3e-5, 3e-3, 0.0};

std::vector<SurfaceMinimum> random_minima(Random& random, std::size_t count) {
  std::vector<SurfaceMinimum> minima(count);
  for (std::size_t i = 0; i < count; ++i) {
    minima[i].distance = random.uniform(-1e-5, 6e-5);
    minima[i].p_b = cases::random_vector(random, 0.02);
    minima[i].normal = cases::random_unit(random);
    minima[i].p_a = minima[i].p_b + minima[i].normal * minima[i].distance;
    minima[i].a.index = static_cast<int>(i);
  }
  return minima;
}

/// How far a step (x, w) goes past the half-space of a minimum.
double overstepped(const SurfaceMinimum& m, const Vec3& x, const Vec3& w) {
  return -m.distance - m.normal.dot(x + w.cross(m.p_b));
}

TEST(ContactReduction, BoundsByHowMuchADroppedMinimumIsOverstepped) {
  Random random(4);
  std::vector<SurfaceMinimum> minima = random_minima(random, 200);
  std::vector<ReductionScratch> scratch(minima.size());
  const ReductionReport report = reduce_contacts(minima, scratch, 40, kBounds);
  EXPECT_EQ(report.kept, 40);
  EXPECT_EQ(report.dropped, 160);
  int steps = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 x = cases::random_unit(random) * random.uniform(0.0, kBounds.max_translation);
    const Vec3 w = cases::random_unit(random) * random.uniform(0.0, kBounds.max_rotation);
    double worst_kept = 0.0;
    for (std::size_t k = 0; k < 40; ++k) worst_kept = std::max(worst_kept, overstepped(minima[k], x, w));
    for (std::size_t k = 40; k < minima.size(); ++k) {
      EXPECT_LE(overstepped(minima[k], x, w), worst_kept + scratch[k].error + 1e-15);
      EXPECT_LE(scratch[k].error, report.largest_error);
    }
    steps += int(worst_kept > 0.0);
  }
  EXPECT_GT(steps, 100);
}

/// Farthest-first as it is defined: every one against every kept one.
std::vector<int> farthest_first(const std::vector<SurfaceMinimum>& minima, std::size_t room) {
  std::vector<double> error(minima.size(), 1e300);
  std::vector<int> kept;
  while (kept.size() < room) {
    std::size_t next = 0;
    for (std::size_t i = 1; i < minima.size(); ++i) {
      if (kept.empty() ? minima[i].distance < minima[next].distance : error[i] > error[next]) next = i;
    }
    const SurfaceMinimum& k = minima[next];
    kept.push_back(k.a.index);
    for (std::size_t i = 0; i < minima.size(); ++i) {
      const SurfaceMinimum& m = minima[i];
      error[i] = std::min(error[i],
                          std::max(0.0, k.distance - m.distance) +
                              (m.normal - k.normal).norm() * kBounds.max_translation +
                              (m.p_b.cross(m.normal) - k.p_b.cross(k.normal)).norm() * kBounds.max_rotation);
    }
  }
  return kept;
}

TEST(ContactReduction, LeavesOutNothingThatTheDefinitionWouldKeep) {
  Random random(8);
  for (const double spread : {1.0, 0.1, 0.01}) {  // all directions, then as on one flank
    std::vector<SurfaceMinimum> minima = random_minima(random, 600);
    for (SurfaceMinimum& m : minima) m.normal = (Vec3::UnitZ() + spread * m.normal).normalized();
    const std::vector<int> wanted = farthest_first(minima, 150);
    std::vector<ReductionScratch> scratch(minima.size());
    reduce_contacts(minima, scratch, 150, kBounds);
    for (std::size_t k = 0; k < wanted.size(); ++k) ASSERT_EQ(minima[k].a.index, wanted[k]) << k;
  }
}

TEST(ContactReduction, KeepsTheNearestFirstAndLosesNone) {
  Random random(5);
  std::vector<SurfaceMinimum> minima = random_minima(random, 100);
  double nearest = 1.0;
  for (const SurfaceMinimum& m : minima) nearest = std::min(nearest, m.distance);
  std::vector<ReductionScratch> scratch(minima.size());
  reduce_contacts(minima, scratch, 10, kBounds);
  EXPECT_EQ(minima[0].distance, nearest);
  std::vector<int> names;
  for (const SurfaceMinimum& m : minima) names.push_back(m.a.index);
  std::sort(names.begin(), names.end());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(names[std::size_t(i)], i);
}

TEST(ContactReduction, IsWithinTwiceTheBestChoice) {
  // Of few minima at one distance (there the error is a metric) all choices are tried.
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<SurfaceMinimum> minima = random_minima(random, 12);
    for (SurfaceMinimum& m : minima) m.distance = 1e-5;
    double best = 1.0;
    for (unsigned choice = 0; choice < 1u << 12; ++choice) {
      if (std::popcount(choice) != 4) continue;
      double error = 0.0;
      for (const SurfaceMinimum& m : minima) {
        double least = 1.0;
        for (std::size_t k = 0; k < 12; ++k) {
          if ((choice >> k & 1u) == 0) continue;
          least = std::min(least, (m.normal - minima[k].normal).norm() * kBounds.max_translation +
                                      (m.p_b.cross(m.normal) - minima[k].p_b.cross(minima[k].normal)).norm() *
                                          kBounds.max_rotation);
        }
        error = std::max(error, least);
      }
      best = std::min(best, error);
    }
    std::vector<ReductionScratch> scratch(minima.size());
    EXPECT_LE(reduce_contacts(minima, scratch, 4, kBounds).largest_error, 2.0 * best + 1e-15);
  }
}

TEST(ContactReduction, OfAFlatContactKeepsItsCorners) {
  std::vector<SurfaceMinimum> minima;
  for (int i = 0; i <= 10; ++i) {
    for (int k = 0; k <= 10; ++k) {
      SurfaceMinimum m;
      m.distance = 2e-5;
      m.normal = Vec3::UnitZ();
      m.p_b = {0.01 * (i - 5), 0.01 * (k - 5), 0.0};
      minima.push_back(m);
    }
  }
  std::vector<ReductionScratch> scratch(minima.size());
  reduce_contacts(minima, scratch, 5, kBounds);
  int corners = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    corners += int(std::abs(std::abs(minima[k].p_b.x()) - 0.05) < 1e-12 &&
                   std::abs(std::abs(minima[k].p_b.y()) - 0.05) < 1e-12);
  }
  EXPECT_EQ(corners, 4);
}

TEST(ContactReduction, StopsWhenItIsEnoughAndTakesNoMemory) {
  Random random(7);
  std::vector<SurfaceMinimum> minima = random_minima(random, 50);
  std::vector<SurfaceMinimum> doubled = minima;
  doubled.insert(doubled.end(), minima.begin(), minima.end());
  std::vector<ReductionScratch> scratch(doubled.size());
  const AllocationGuard guard;
  const ReductionReport report = reduce_contacts(doubled, scratch, 100, kBounds);
  const std::size_t allocations = guard.allocations();
  EXPECT_EQ(allocations, 0u);
  EXPECT_LE(report.kept, 50);
  EXPECT_EQ(report.largest_error, 0.0);
  EXPECT_EQ(reduce_contacts({}, {}, 5, kBounds).kept, 0);
  EXPECT_EQ(reduce_contacts(doubled, scratch, 0, kBounds).dropped, 100);
}

}  // namespace
}  // namespace tactum
