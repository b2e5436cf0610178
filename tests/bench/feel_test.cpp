#include "bench/feel.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bench/overlap.h"
#include "oracles/exhaustive.h"
#include "tactum/base/random.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"

namespace tactum::bench::feel_test {
namespace {

FeelRow ours(const std::string& name) {
  const auto scene = std::find_if(feel_scenes().begin(), feel_scenes().end(),
                                  [&](const FeelSceneEntry& entry) { return entry.name == name; });
  EXPECT_NE(scene, feel_scenes().end()) << name;
  return feel(*scene, feel_engines().front(), {});
}

TEST(Feel, PressedPartsAreFeltToAMicronewton) {
  for (const char* name : {"block on plane", "wedge in a V-groove", "edge on plane", "corner on plane"}) {
    const FeelRow row = ours(name);
    EXPECT_LT(row.force_error_N, 1e-6) << name;
    EXPECT_LT(row.torque_error_Nm, 1e-6) << name;
    EXPECT_EQ(row.penetration_m, 0.0) << name;
    EXPECT_LT(row.energy_made_J, 1e-9) << name;
  }
}

TEST(Feel, FacetsFeelRound) {
  const FeelRow row = ours("sliding over facets");  // 64 of them, with 5 N
  EXPECT_LT(row.force_step_N, 0.02);
  EXPECT_LT(row.direction_error_rad, 0.1 * 2.0 * kPi / 64) << "a tenth of the angle between two facets";
  // The rest is the depth of a facet below the circle, 24 um.
  EXPECT_LT(row.force_error_N, 600.0 * 0.02 * (1.0 - std::cos(kPi / 64)) + 0.01);
  EXPECT_EQ(row.penetration_m, 0.0);
  const FeelRow hole = ours("cylinder in a hole");
  EXPECT_LT(hole.force_step_N, 0.02);
  EXPECT_EQ(hole.penetration_m, 0.0);
}

TEST(Feel, FrictionIsThatOfCoulomb) {
  const double load_N = 600.0 * 0.008;
  const FeelRow sliding = ours("sliding with friction");
  EXPECT_LT(sliding.force_error_N, 0.01 * 0.3 * load_N);
  EXPECT_EQ(sliding.penetration_m, 0.0);
  const FeelRow resting = ours("stick-slip threshold");
  EXPECT_LT(resting.friction_error, 0.01);
  EXPECT_LT(resting.creep_m_per_s, 1e-6);
  EXPECT_LT(resting.force_error_N, 1e-6);
}

TEST(Feel, AJudgeThatIsToldAnotherTruthSeesIt) {
  // The scene's own numbers must be able to fail: a spring that is a thousandth stiffer than stated.
  static const FeelSceneEntry stiffer = {"stiffer", [] {
                                           FeelScene scene = feel_scenes().front().make();
                                           scene.coupling.stiffness_N_per_m *= 1.001;
                                           return scene;
                                         }};
  EXPECT_GT(feel(stiffer, feel_engines().front(), {}).force_error_N, 4e-3);
}

TEST(Feel, TheOverlapIsThatOfTheExhaustiveReferee) {
  constexpr std::uint64_t kSeed = 7;
  Random random(kSeed);
  const Polytope a = make_box({0.03, 0.02, 0.01});
  const Polytope b = make_prism(6, 0.02, 0.03);
  int overlapping = 0;
  for (int i = 0; i < 200; ++i) {
    const auto number = [&](double size) { return random.uniform(-size, size); };
    const double x = number(0.04), y = number(0.04), z = number(0.04);
    const double rx = number(2.0), ry = number(2.0), rz = number(2.0);
    const Pose X_AB{exp_rotation({rx, ry, rz}), {x, y, z}};
    const double depth = overlap(overlap_piece(a, {}), carried(overlap_piece(b, {}), X_AB));
    const auto truth = static_cast<double>(std::max(0.0L, -oracle::axes_separation(a, b, X_AB)));
    EXPECT_NEAR(depth, truth, 1e-12) << kSeed << " " << i;
    overlapping += truth > 0.0 ? 1 : 0;
  }
  EXPECT_GT(overlapping, 40);
}

TEST(Feel, PeersGetTheSameSceneAndHoldIt) {
  for (const FeelEngineEntry& entry : feel_engines()) {
    const FeelRow row = feel(feel_scenes().front(), entry, entry.setups.back());
    EXPECT_LT(row.force_error_N, 0.1) << entry.name;
    EXPECT_LT(row.penetration_m, 1e-3) << entry.name;
  }
}

TEST(Feel, ThePictureShowsEveryEngine) {
  std::vector<PegRow> rows;
  for (const char* engine : {"tactum", "bullet"})
    for (const double clearance : kClearances_m) {
      PegRow row;
      row.engine = engine;
      row.clearance_m = clearance;
      row.hands = row.inserted = 1;
      row.force_step_N = 0.1;
      rows.push_back(row);
    }
  const std::string svg = peg_plot(rows);
  EXPECT_NE(svg.find("bullet"), std::string::npos);
  EXPECT_NE(svg.find("tactum"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace tactum::bench::feel_test
