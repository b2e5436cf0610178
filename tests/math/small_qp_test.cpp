#include "tactum/math/small_qp.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <iostream>
#include <optional>
#include <vector>

#include "tactum/base/random.h"
#include "tactum/math/types.h"

namespace tactum {
namespace {

using Vector = Eigen::VectorXd;

constexpr double kTolerance = 1e-12;

struct Rows {
  std::size_t unknowns = 0;
  std::vector<double> normals, offsets;

  void add(const Vector& g, double b) {
    normals.insert(normals.end(), g.data(), g.data() + g.size());
    offsets.push_back(b);
  }
  Vector normal(std::size_t row) const {
    return Eigen::Map<const Vector>(normals.data() + row * unknowns, static_cast<Eigen::Index>(unknowns));
  }
  QpAnswer solve(const std::vector<int>& first = {}, int max_iterations = 1000) const {
    SmallQp qp;
    qp.begin(problem(), first);
    return qp.solve_on(problem(), max_iterations);
  }
  QpProblem problem() const {
    made.clear();
    for (std::size_t row = 0; row < offsets.size(); ++row) made.push_back(in_runs(row));
    return {unknowns, made, {}, 0, kTolerance};
  }

 private:
  QpRow in_runs(std::size_t row) const {
    QpRow out;
    out.offset = offsets[row];
    std::size_t next = 0;
    const double* const g = normals.data() + row * unknowns;
    for (QpRow::Run& run : out.runs) {
      while (next < unknowns && g[next] == 0.0) ++next;
      run.first = static_cast<std::uint32_t>(next);
      for (; next < unknowns && run.count < QpRow::kLongestRun; ++next) run.g[run.count++] = g[next];
    }
    for (; next < unknowns; ++next) EXPECT_EQ(g[next], 0.0) << "more than two runs";
    return out;
  }

  mutable std::vector<QpRow> made;
};

Vector point(const Rows& rows, const QpAnswer& answer) {
  return Eigen::Map<const Vector>(answer.z.data(), static_cast<Eigen::Index>(rows.unknowns));
}

/// A normal of random numbers, in two runs where it may not have more.
Vector random_normal(Random& random, std::size_t unknowns) {
  Vector g = Vector::Zero(static_cast<Eigen::Index>(unknowns));
  for (double& x : g) x = random.uniform(-1.0, 1.0);
  const int runs = static_cast<int>(unknowns / QpRow::kLongestRun);
  if (unknowns <= 2 * QpRow::kLongestRun) return g;
  const int one = random.index(runs);
  const int other = random.index(runs);
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    const int run = static_cast<int>(i) / static_cast<int>(QpRow::kLongestRun);
    if (run != one && run != other) g[i] = 0.0;
  }
  return g;
}

/// The optimality conditions, which prove an answer by themselves.
void expect_optimal(const Rows& rows, const QpAnswer& answer) {
  ASSERT_EQ(answer.status, QpStatus::kSolved);
  const Vector z = point(rows, answer);
  Vector sum = Vector::Zero(z.size());
  for (std::size_t row = 0; row < rows.offsets.size(); ++row)
    EXPECT_GE(rows.normal(row).dot(z) - rows.offsets[row], -1e-10);
  for (const QpActive& active : answer.active) {
    const std::size_t row = static_cast<std::size_t>(active.row);
    EXPECT_GE(active.multiplier, 0.0);
    EXPECT_NEAR(rows.normal(row).dot(z), rows.offsets[row], 1e-10);
    sum += active.multiplier * rows.normal(row);
  }
  EXPECT_LT((sum - z).norm(), 1e-10 * (1.0 + z.norm()));
}

/// The nearest point by trying every set of up to `unknowns` rows as equations; none when nothing is
/// feasible.
std::optional<Vector> by_enumeration(const Rows& rows) {
  std::optional<Vector> best;
  const std::size_t m = rows.offsets.size();
  for (unsigned set = 0; set < 1u << m; ++set) {
    std::vector<std::size_t> chosen;
    for (std::size_t row = 0; row < m; ++row)
      if (set >> row & 1u) chosen.push_back(row);
    if (chosen.size() > rows.unknowns) continue;
    Eigen::MatrixXd G(chosen.size(), rows.unknowns);
    Vector b(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      G.row(static_cast<Eigen::Index>(i)) = rows.normal(chosen[i]).transpose();
      b[static_cast<Eigen::Index>(i)] = rows.offsets[chosen[i]];
    }
    Vector z = Vector::Zero(static_cast<Eigen::Index>(rows.unknowns));
    if (!chosen.empty()) {
      const Eigen::FullPivLU<Eigen::MatrixXd> lu(G * G.transpose());
      if (lu.rank() < static_cast<Eigen::Index>(chosen.size())) continue;
      z = G.transpose() * lu.solve(b);
    }
    bool feasible = true;
    for (std::size_t row = 0; row < m && feasible; ++row)
      feasible = rows.normal(row).dot(z) >= rows.offsets[row] - 1e-9;
    if (feasible && (!best || z.norm() < best->norm())) best = z;
  }
  return best;
}

Rows random_rows(Random& random, std::size_t unknowns, int count, double low, double high) {
  Rows rows;
  rows.unknowns = unknowns;
  for (int i = 0; i < count; ++i) {
    rows.add(random_normal(random, unknowns), random.uniform(low, high));
  }
  return rows;
}

TEST(SmallQp, WithoutRowsTheOriginIsNearest) {
  Rows rows;
  rows.unknowns = 6;
  const QpAnswer answer = rows.solve();
  EXPECT_EQ(answer.status, QpStatus::kSolved);
  EXPECT_EQ(point(rows, answer).norm(), 0.0);
  EXPECT_EQ(answer.active.size(), 0u);
}

TEST(SmallQp, AgreesWithTryingEverySetOfRows) {
  constexpr std::uint64_t kSeed = 20261121;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  int solved = 0, infeasible = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const std::size_t unknowns = 1 + std::size_t(random.index(6));
    const Rows rows = random_rows(random, unknowns, 1 + random.index(9), -0.5, 1.0);
    const QpAnswer answer = rows.solve();
    const std::optional<Vector> expected = by_enumeration(rows);
    if (!expected) {
      EXPECT_EQ(answer.status, QpStatus::kInfeasible) << trial;
      ++infeasible;
      continue;
    }
    expect_optimal(rows, answer);
    EXPECT_LT((point(rows, answer) - *expected).norm(), 1e-8 * (1.0 + expected->norm())) << trial;
    ++solved;
  }
  EXPECT_GT(solved, 200);
  EXPECT_GT(infeasible, 20);
}

TEST(SmallQp, RowsThatRepeatEachOtherHoldOnce) {
  constexpr std::uint64_t kSeed = 7;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  for (int trial = 0; trial < 200; ++trial) {
    Rows rows = random_rows(random, 6, 5, 0.0, 1.0);
    const Rows once = rows;
    for (std::size_t row = 0; row < 5; ++row) {
      rows.add(once.normal(row), once.offsets[row]);
      rows.add(2.0 * once.normal(row), 2.0 * once.offsets[row]);
    }
    // The corner between two rows, and a sum of them that only touches it.
    rows.add(once.normal(0) + once.normal(1), once.offsets[0] + once.offsets[1]);
    const QpAnswer answer = rows.solve();
    expect_optimal(rows, answer);
    EXPECT_LT((point(rows, answer) - point(once, once.solve())).norm(), 1e-9);
  }
}

TEST(SmallQp, FourCornersOfAPlaneHoldABlockAsThreeDo) {
  // Rows of a flat contact: normal z, corners at (+-1, +-1); any three of the four decide.
  Rows rows;
  rows.unknowns = 6;
  for (double x : {-1.0, 1.0})
    for (double y : {-1.0, 1.0}) {
      Vector g(6);
      g << 0, 0, 1, y, -x, 0;
      rows.add(g, 0.5);
    }
  const QpAnswer answer = rows.solve();
  expect_optimal(rows, answer);
  EXPECT_NEAR(answer.z[2], 0.5, 1e-14);
  EXPECT_LE(answer.active.size(), 3u);
}

TEST(SmallQp, OpposedRowsAreInfeasibleOnlyWhenTheyOverlap) {
  for (double gap : {-0.1, 0.0, 0.1}) {
    Rows rows;
    rows.unknowns = 6;
    Vector g = Vector::Zero(6);
    g[1] = 1.0;
    rows.add(g, 0.3);
    rows.add(-g, -0.3 - gap);
    EXPECT_EQ(rows.solve().status, gap < 0.0 ? QpStatus::kInfeasible : QpStatus::kSolved) << gap;
  }
}

TEST(SmallQp, TheRowsThatHeldBeforeAreTheWholeWork) {
  constexpr std::uint64_t kSeed = 11;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  int cold_work = 0, warm_work = 0;
  for (int trial = 0; trial < 100; ++trial) {
    Rows rows = random_rows(random, 6, 40, 0.01, 0.5);
    for (std::size_t row = 0; row < rows.offsets.size(); ++row)
      rows.offsets[row] = rows.normal(row).sum() - rows.offsets[row];  // all ones keep them
    const QpAnswer cold = rows.solve();
    std::vector<int> active;
    for (const QpActive& row : cold.active) active.push_back(row.row);
    for (double& b : rows.offsets) b += random.uniform(-1e-4, 1e-4);
    const QpAnswer again = rows.solve();
    const QpAnswer warm = rows.solve(active);
    expect_optimal(rows, warm);
    EXPECT_LT((point(rows, warm) - point(rows, again)).norm(), 1e-9);
    cold_work += again.iterations;
    warm_work += warm.iterations;
  }
  EXPECT_LT(10 * warm_work, cold_work);
}

TEST(SmallQp, GoesOnWhenOffsetsChangeAndRowsComeAndGo) {
  constexpr std::uint64_t kSeed = 23;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  int infeasible = 0, worked = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t unknowns = 1 + std::size_t(random.index(int(kMostUnknowns)));
    Rows rows = random_rows(random, unknowns, 60, -0.5, 0.05);
    SmallQp qp;
    qp.begin(rows.problem(), {});
    qp.solve_on(rows.problem(), 1000);
    for (int round = 0; round < 12; ++round) {
      const bool grows = round % 3 == 1;
      if (grows) {
        for (const int more = random.index(8); rows.offsets.size() < 60 + std::size_t(more);)
          rows.add(random_normal(random, unknowns), random.uniform(-0.5, 0.05));
      } else if (round % 3 == 2) {
        rows.offsets.resize(50);
        rows.normals.resize(50 * unknowns);
      }
      for (double& b : rows.offsets) b += random.uniform(-0.02, 0.02);
      const QpAnswer fresh = rows.solve();
      const QpAnswer& on = qp.solve_on(rows.problem(), 1000);
      ASSERT_EQ(on.status, fresh.status) << "trial " << trial << " round " << round;
      if (on.status != QpStatus::kSolved) {
        ++infeasible;
        continue;
      }
      expect_optimal(rows, on);
      ASSERT_LT((point(rows, on) - point(rows, fresh)).norm(), 1e-8 * (1.0 + point(rows, fresh).norm()));
      worked += on.iterations > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(worked, 200);
  EXPECT_GT(infeasible, 10);
}

/// Four rows with the same runs, and offsets for the edges between them.
QpCone random_cone(Random& random, std::size_t unknowns) {
  QpCone cone;
  const auto random_offset = [&] { return random.uniform(-0.1, 0.02); };
  const auto bodies = static_cast<int>(unknowns / QpRow::kLongestRun);
  const std::array<int, 2> body{random.index(bodies), random.index(bodies)};
  for (QpRow* row : {&cone.off, &cone.along, &cone.across, &cone.about}) {
    for (std::size_t r = 0; r < (body[0] == body[1] ? 1u : 2u); ++r) {
      QpRow::Run& run = row->runs[r];
      run.first = static_cast<std::uint32_t>(body[r]) * std::uint32_t(QpRow::kLongestRun);
      run.count = QpRow::kLongestRun;
      for (double& g : run.g) g = random.uniform(-1.0, 1.0);
    }
    row->offset = random_offset();
  }
  cone.slope = random.uniform(0.0, 0.8);
  cone.twist = random.uniform(0.0, 0.3);
  for (double& more : cone.more) more = random_offset();
  return cone;
}

TEST(SmallQp, AConeIsItsEdgesWrittenOut) {
  constexpr std::uint64_t kSeed = 29;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  int on_edges = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t unknowns = QpRow::kLongestRun * (1 + std::size_t(random.index(6)));
    const Rows some = random_rows(random, unknowns, 10, -0.5, 0.05);
    std::vector<QpCone> cones;
    for (int i = 0; i < 8; ++i) cones.push_back(random_cone(random, unknowns));
    QpProblem with_cones = some.problem();
    with_cones.cones = cones;
    std::vector<QpRow> rows;
    for (std::size_t i = 0; i < with_cones.size(); ++i) {
      rows.push_back(with_cones.row(i));
      ASSERT_EQ(with_cones.offset(i), rows.back().offset);
    }
    const std::size_t k = std::size_t(trial) % QpCone::kAround;
    const double angle = 2.0 * kPi * static_cast<double>(k) / static_cast<double>(QpCone::kAround);
    ASSERT_NEAR(rows[10 + k].runs[0].g[2],
                cones[0].off.runs[0].g[2] - cones[0].slope * (std::cos(angle) * cones[0].along.runs[0].g[2] +
                                                              std::sin(angle) * cones[0].across.runs[0].g[2]),
                1e-14);
    SmallQp by_cones, by_rows;
    by_cones.begin(with_cones, {});
    const QpProblem written_out{unknowns, rows, {}, 0, kTolerance};
    by_rows.begin(written_out, {});
    const QpAnswer& one = by_cones.solve_on(with_cones, 1000);
    const QpAnswer& other = by_rows.solve_on(written_out, 1000);
    ASSERT_EQ(one.status, other.status) << "trial " << trial;
    if (one.status != QpStatus::kSolved) continue;
    for (std::size_t i = 0; i < unknowns; ++i) ASSERT_NEAR(one.z[i], other.z[i], 1e-9) << "trial " << trial;
    for (const QpActive& active : one.active) on_edges += active.row >= 10 ? 1 : 0;
  }
  EXPECT_GT(on_edges, 400);
}

/// An equation is a row and its opposite: the same point, and a multiplier of either sign.
TEST(SmallQp, AnEquationIsARowAndItsOpposite) {
  constexpr std::uint64_t kSeed = 31;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  int pulling = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t unknowns = QpRow::kLongestRun * (1 + std::size_t(random.index(6)));
    constexpr std::size_t kEquations = 4;
    const Rows some = random_rows(random, unknowns, 14, -0.5, 0.05);
    QpProblem problem = some.problem();
    problem.equalities = kEquations;
    Rows both = some;
    for (std::size_t i = 0; i < kEquations; ++i) both.add(-some.normal(i), -some.offsets[i]);
    SmallQp qp;
    qp.begin(problem, {});
    const QpAnswer& one = qp.solve_on(problem, 1000);
    const QpAnswer other = both.solve();
    if (other.status != QpStatus::kSolved || one.status != QpStatus::kSolved) continue;
    for (std::size_t i = 0; i < unknowns; ++i) ASSERT_NEAR(one.z[i], other.z[i], 1e-6) << "trial " << trial;
    for (const QpActive& active : one.active) pulling += active.multiplier < 0.0 ? 1 : 0;
  }
  EXPECT_GT(pulling, 100);
}

TEST(SmallQp, AThousandRowsInSixAndInAsManyUnknownsAsThereMayBe) {
  constexpr std::uint64_t kSeed = 13;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  for (std::size_t unknowns : {std::size_t(6), kMostUnknowns})
    for (int trial = 0; trial < 20; ++trial) {
      // Half-spaces that all hold the point (1, ..., 1) times 0.1.
      Rows rows = random_rows(random, unknowns, 1500, 0.0, 0.2);
      for (std::size_t row = 0; row < rows.offsets.size(); ++row)
        rows.offsets[row] = 0.1 * rows.normal(row).sum() - rows.offsets[row];
      expect_optimal(rows, rows.solve());
    }
}

TEST(SmallQp, StopsWhenItsIterationsAreSpentAndSaysSo) {
  Random random(17);
  Rows rows = random_rows(random, 6, 12, 0.5, 1.0);
  for (std::size_t row = 0; row < rows.offsets.size(); ++row)
    rows.offsets[row] = rows.normal(row).sum() - 0.01;  // feasible: all ones
  EXPECT_EQ(rows.solve({}, 2).status, QpStatus::kBounded);
  EXPECT_EQ(rows.solve({}, 2).iterations, 2);
  expect_optimal(rows, rows.solve());
}

TEST(SmallQp, TheSameRowsGiveTheSameBits) {
  Random random(19);
  const Rows rows = random_rows(random, 6, 30, -1.0, 0.1);
  const QpAnswer one = rows.solve();
  const QpAnswer two = rows.solve();
  EXPECT_EQ(one.z, two.z);
}

}  // namespace
}  // namespace tactum
