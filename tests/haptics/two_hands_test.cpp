/// Two hands in one scene: what one feels the other gives, a peg in one goes into the hole in the other, a
/// part passes from hand to hand, and a hand whose device is lost leaves the other as it is.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "support/effort.h"
#include "support/judged.h"
#include "support/rotation_between.h"
#include "support/solid_box.h"
#include "tactum/base/random.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"
#include "tactum/parts/generated_parts.h"

namespace tactum::two_hands_test {
namespace {

constexpr double kSumIsZero = 1e-9;  // of forces [N] and moments [N m]
constexpr double kStep_N = 0.05;     // the largest that is no step
constexpr double kGravity = 9.81;    // [m/s^2]
constexpr double kLimit_N = 40.0;    // of the ideal devices
constexpr double kSlew_N_per_s = 1e4;
constexpr std::array kBoth{ResponseModel::kConstraint, ResponseModel::kPenalty};

const char* name_of(ResponseModel response) {
  return response == ResponseModel::kPenalty ? "penalty" : "constraint";
}

std::shared_ptr<const Part> part_of(const Result<std::vector<Polytope>>& pieces) {
  EXPECT_TRUE(pieces) << pieces.error().message();
  std::vector<std::vector<Vec3>> clouds;
  for (const Polytope& piece : *pieces) clouds.emplace_back(piece.vertices.begin(), piece.vertices.end());
  Result<Part> part = part_from_clouds(clouds);
  EXPECT_TRUE(part) << part.error().message();
  return std::make_shared<const Part>(std::move(*part));
}

/// A world and two ideal devices whose frames are the world.
struct Hands : testing::Judged {
  std::array<HandSample, 2> samples;
  std::array<Wrench, 2> wrenches;

  explicit Hands(ResponseModel response = ResponseModel::kConstraint) {
    settings.response = response;
    settings.tool.body = 0;
    settings.other_hands.resize(1);
    settings.other_hands[0].tool.body = 1;
    for (HandSettings* hand : {static_cast<HandSettings*>(&settings), &settings.other_hands[0]}) {
      hand->safety.max_force_N = kLimit_N;
      hand->safety.max_torque_Nm = kLimit_N;
      hand->safety.max_force_slew_N_per_s = kSlew_N_per_s;
      hand->safety.max_torque_slew_Nm_per_s = kSlew_N_per_s;
      hand->safety.start_ramp_s = 0.01;
    }
    for (HandSample& sample : samples) sample.valid = true;
  }
  int add(const std::shared_ptr<const Part>& part, const Pose& X_WB, JointKind joint = JointKind::kFree) {
    Body& body = world.bodies.emplace_back();
    body.part = part;
    body.X_WB = X_WB;
    body.joint.kind = joint;
    body.mass_kg = 0.1;
    body.inertia_B = 1e-5 /* kg m^2 */ * Mat3::Identity();
    return static_cast<int>(world.bodies.size()) - 1;
  }
  const FrameState& state() const { return simulation->state(); }
  const HandReport& report(std::size_t hand) const {
    return hand == 0 ? simulation->report() : state().other_reports[hand - 1];
  }
  void step() {
    for (HandSample& sample : samples)
      if (sample.valid) sample.time_s = simulation->time_s();
    simulation->step(samples, wrenches);
  }
  void step(const Pose& first, const Pose& second) {
    samples[0].X_DH = first;
    samples[1].X_DH = second;
    step();
  }
  void press(std::size_t hand, bool pressed) { samples[hand].buttons = pressed ? 1u : 0u; }
  /// The sum of what the hands feel, moments about the origin, with the handles where the frame began.
  Wrench sum() const {
    Wrench all;
    for (std::size_t h = 0; h < 2; ++h) {
      const GraspedPart& grasped = state().hand_inputs[h].grasped;
      const Vec3 p_W = state().X_WB_start[static_cast<std::size_t>(grasped.body)] * grasped.X_BH.p;
      const Wrench& felt = report(h).coupling;
      all = all + Wrench{felt.f, felt.t + p_W.cross(felt.f)};
    }
    return all;
  }
};

Tool picking() {
  Tool tool;
  tool.picks = true;
  tool.pick_distance_m = 0.05;
  return tool;
}

Pose moved_by(const Vec3& p, const Vec3& turn = Vec3::Zero()) { return {exp_rotation(turn), p}; }

TEST(TwoHands, WhatOneFeelsTheOtherGives) {
  for (const double mu : {0.0, 0.4}) {
    Hands hands;
    hands.add(solid_box({0.01, 0.008, 0.006}), moved_by({0, 0, 0.0065}));
    hands.add(solid_box({0.012, 0.009, 0.006}), moved_by({0, 0, -0.0065}));
    hands.settings.tool.X_BH.p = {0.002, -0.001, 0.003};
    hands.settings.other_hands[0].tool.X_BH.p = {-0.003, 0.002, -0.001};
    if (mu > 0.0) hands.settings.friction = {{0.0, mu, mu, 0.0}, 2};
    hands.begin();
    double most_N = 0.0;
    int touching = 0;
    for (int i = 0; i < testing::effort(1200, 300); ++i) {
      const double s = 0.001 * i;
      const Vec3 slide(0.002 * std::sin(6.0 * s), 0.001 * std::sin(9.0 * s), 0.0);
      hands.step(moved_by(slide - Vec3(0, 0, 0.004 * std::min(1.0, 4.0 * s)),
                          0.05 * Vec3(std::sin(5.0 * s), std::cos(4.0 * s), 0)),
                 moved_by(Vec3(0, 0, 0.004 * std::min(1.0, 4.0 * s)), {0, 0.04 * std::sin(7.0 * s), 0}));
      const Wrench left = hands.sum();
      EXPECT_LT(left.f.norm(), kSumIsZero) << "frame " << i << ", friction " << mu;
      EXPECT_LT(left.t.norm(), kSumIsZero) << "frame " << i << ", friction " << mu;
      most_N = std::max(most_N, hands.report(0).coupling.f.norm());
      touching += hands.report(0).grasped_contact_points > 0 && hands.report(1).grasped_contact_points > 0;
      EXPECT_FALSE(hands.simulation->report().penetrating) << i;
    }
    EXPECT_GT(most_N, 1.0);  // they were pressed together
    EXPECT_GT(touching, testing::effort(800, 50));
  }
}

/// Two couplings and, in the penalty response, the spring of the contact are in a row:
/// F (1/k_1 + 1/k_2 + 1/k_s) = overlap + delta, with delta the steps that both would like to make towards
/// their hands, at most the threshold each. In the constraint response 1/k_s and delta are zero.
TEST(TwoHands, PressedTogetherTheySqueezeAsTheirSpringsInARow) {
  struct Case {
    double first_N_per_m, second_N_per_m, overlap_m, dt_s;
    Vec3 along;  // world
  };
  for (const Case& of :
       {Case{400, 400, 0.004, 1e-3, Vec3::UnitZ()}, Case{200, 900, 0.004, 1e-3, Vec3::UnitZ()},
        Case{900, 200, 0.002, 5e-4, Vec3::UnitX()}, Case{50, 60, 0.01, 2e-3, -Vec3::UnitY()},
        Case{1500, 1500, 0.001, 2.5e-4, Vec3(1, 2, 2) / 3.0}})
    for (const ResponseModel response : kBoth) {
      // A body that falls beside them: then all that nobody holds moves by impulses.
      const bool some_falls = of.dt_s < 1e-3 || of.first_N_per_m < 300.0;
      SCOPED_TRACE(::testing::Message() << name_of(response) << ", " << of.first_N_per_m << " and "
                                        << of.second_N_per_m << " N/m, " << of.dt_s << " s");
      Hands hands(response);
      const Mat3 R = testing::rotation_between(Vec3::UnitZ(), of.along);
      hands.add(solid_box({0.01, 0.008, 0.006}), {R, 0.0065 * of.along});
      hands.add(solid_box({0.012, 0.009, 0.006}), {R, -0.0065 * of.along});
      hands.settings.coupling.stiffness_N_per_m = of.first_N_per_m;
      hands.settings.other_hands[0].coupling.stiffness_N_per_m = of.second_N_per_m;
      hands.settings.dt_s = of.dt_s;
      if (some_falls) hands.add(solid_box({0.01, 0.01, 0.01}), moved_by({0.5, 0, 0}));
      hands.begin();
      const double together = 0.5 * (of.overlap_m + 0.001);
      for (int i = 0; i < 2000; ++i) {
        const double s = std::min(1.0, i / 500.0);
        hands.step({R, (0.0065 - together * s) * of.along}, {R, (-0.0065 + together * s) * of.along});
      }
      double expected_N = of.overlap_m / (1.0 / of.first_N_per_m + 1.0 / of.second_N_per_m);
      for (int i = 0; i < 200 && response == ResponseModel::kPenalty; ++i) {
        const Penalty& law = hands.settings.penalty;
        double compliance = 1.0 / law.stiffness_N_per_m, delta_m = 0.0;
        for (const double k : {of.first_N_per_m, of.second_N_per_m}) {
          compliance += 1.0 / k;
          delta_m += std::min(expected_N / k, law.max_step_m * of.dt_s / 1e-3 /* s */);
        }
        expected_N = (of.overlap_m + delta_m) / compliance;
      }
      const double tolerance_N = response == ResponseModel::kPenalty ? 1e-6 * expected_N : 1e-3 * expected_N;
      EXPECT_LT((hands.report(0).coupling.f - expected_N * of.along).norm(), tolerance_N);
      EXPECT_LT((hands.report(1).coupling.f + expected_N * of.along).norm(), tolerance_N);
      EXPECT_LT((hands.report(0).restoring.f + hands.report(1).restoring.f).norm(), kSumIsZero);
      EXPECT_GT(hands.report(0).grasped_contact_points, 0);
      EXPECT_GT(hands.report(1).grasped_contact_points, 0);
      const Wrench left = hands.sum();
      EXPECT_LT(left.f.norm(), kSumIsZero);
      EXPECT_LT(left.t.norm(), kSumIsZero);
    }
}

TEST(TwoHands, OneBodyBetweenThemIsPushedAsMuchByBoth) {
  for (const ResponseModel response : kBoth) {
    SCOPED_TRACE(name_of(response));
    Hands hands(response);
    hands.add(solid_box({0.01, 0.01, 0.005}), moved_by({0, 0, 0.0105}));
    hands.add(solid_box({0.01, 0.01, 0.005}), moved_by({0, 0, -0.0105}));
    hands.add(solid_box({0.006, 0.006, 0.005}), {});
    hands.begin();
    for (int i = 0; i < 600; ++i) {
      const double pressed = 0.005 * std::min(1.0, i / 300.0);
      hands.step(moved_by({0, 0, -pressed}), moved_by({0, 0, pressed}));
    }
    const Wrench left = hands.sum();
    EXPECT_GT(hands.report(0).coupling.f.norm(), 1.0);
    EXPECT_LT(left.f.norm(), 1e-4);  // the free body is at rest
    EXPECT_LT(left.t.norm(), 1e-6);
  }
}

void expect_both_couplings(ResponseModel response) {
  Hands hands(response);
  hands.add(solid_box({0.02, 0.01, 0.005}), {});
  hands.settings.other_hands[0].tool.body = 0;
  hands.settings.tool.X_BH.p = {-0.02, 0, 0};
  hands.settings.other_hands[0].tool.X_BH.p = {0.02, 0, 0};
  hands.world.gravity_W = {0, 0, -kGravity};
  hands.begin();
  const double k = hands.settings.coupling.stiffness_N_per_m;
  for (int i = 0; i < 2000; ++i) {
    const double apart = 0.002 * std::min(1.0, i / 500.0);
    hands.step(moved_by({-apart, 0, 0}), moved_by({apart, 0, 0}));
  }
  const double weight_N = hands.world.bodies[0].mass_kg * kGravity;
  const Vec3 first = hands.report(0).coupling.f, second = hands.report(1).coupling.f;
  EXPECT_NEAR(first.x(), k * 0.002, 1e-6);
  EXPECT_NEAR(second.x(), -k * 0.002, 1e-6);
  EXPECT_NEAR(first.z(), -0.5 * weight_N, 1e-6);
  EXPECT_NEAR(second.z(), -0.5 * weight_N, 1e-6);
  EXPECT_NEAR(hands.X_WB(0).p.z(), -0.5 * weight_N / k, 1e-9);
}

TEST(TwoHands, OnePartHeldByBothHasBothCouplings) {
  for (const ResponseModel response : kBoth) {
    SCOPED_TRACE(name_of(response));
    expect_both_couplings(response);
  }
}

void pass_from_hand_to_hand(ResponseModel response) {
  Hands hands(response);
  hands.add(solid_box({0.02, 0.01, 0.005}), {});
  hands.world.gravity_W = {0, 0, -kGravity};
  hands.settings.tool = hands.settings.other_hands[0].tool = picking();
  for (HandSettings* hand : {static_cast<HandSettings*>(&hands.settings), &hands.settings.other_hands[0]})
    hand->smoothing.on = false;  // what the parts do is to be seen, not what smoothing makes of it
  hands.begin();
  const double weight_N = hands.world.bodies[0].mass_kg * kGravity;
  constexpr int kGrasps = 600, kReleases = 900, kEnd = 1600;
  std::array<Vec3, 2> felt, sent;
  for (int i = 0; i < kEnd; ++i) {
    hands.press(0, i > 0 && i < kReleases);
    hands.press(1, i >= kGrasps);
    const double turn = 0.02 * std::sin(0.01 * i);  // both are led about while they hold it
    const Vec3 along(0.005 * std::sin(0.004 * i), 0, 0);
    hands.step(moved_by(along, {0, turn, 0}), moved_by(Vec3(0.015, 0, 0) + along, {0, turn, 0}));
    for (std::size_t h = 0; h < 2; ++h) {
      const Vec3 now = hands.report(h).coupling.f, now_sent = hands.wrenches[h].f;
      if (i >= kGrasps) {
        EXPECT_LT((now - felt[h]).norm(), kStep_N) << "hand " << h << " feels, frame " << i;
        EXPECT_LT((now_sent - sent[h]).norm(), kStep_N) << "hand " << h << " is sent, frame " << i;
      }
      felt[h] = now;
      sent[h] = now_sent;
    }
    if (i == kReleases - 1) {
      EXPECT_EQ(hands.report(0).grasped_body, 0);
      EXPECT_EQ(hands.report(1).grasped_body, 0);
    }
  }
  EXPECT_EQ(hands.report(0).grasped_body, -1);
  EXPECT_EQ(hands.report(1).grasped_body, 0);
  EXPECT_TRUE(felt[0].isZero(0.0));
  EXPECT_NEAR(felt[1].z(), -weight_N, 0.02 * weight_N);
  EXPECT_GT(hands.X_WB(0).p.z(), -0.01);  // it never fell
}

TEST(TwoHands, APartPassesFromHandToHandWithoutAStep) {
  for (const ResponseModel response : kBoth) {
    SCOPED_TRACE(name_of(response));
    pass_from_hand_to_hand(response);
  }
}

void lose_a_device(ResponseModel response) {
  Hands hands(response);
  hands.add(solid_box({0.01, 0.008, 0.006}), moved_by({0, 0, 0.0065}));
  hands.add(solid_box({0.012, 0.009, 0.006}), moved_by({0, 0, -0.0065}));
  hands.begin();
  constexpr int kLost = 800, kEnd = 1600;
  Wrench before;
  for (int i = 0; i < kEnd; ++i) {
    const double pressed = 0.004 * std::min(1.0, i / 400.0);
    if (i == kLost) hands.samples[0].valid = false;
    const Vec3 about(0.0005 * std::sin(0.02 * i), 0, 0);
    hands.step(moved_by({0, 0, -pressed}), moved_by(about + Vec3(0, 0, pressed)));
    if (i >= kLost) {
      EXPECT_LT((hands.wrenches[1].f - before.f).norm(), kStep_N) << i;
    }
    before = hands.wrenches[1];
    if (i > kLost + 20) {
      EXPECT_TRUE(hands.wrenches[0].f.isZero(0.0) && hands.wrenches[0].t.isZero(0.0)) << i;
    }
  }
  EXPECT_GT(hands.wrenches[1].f.norm(), 1.0);  // the other hand is still pressed against the part
}

TEST(TwoHands, ALostDeviceStopsItsOwnHandAlone) {
  for (const ResponseModel response : kBoth) {
    SCOPED_TRACE(name_of(response));
    lose_a_device(response);
  }
}

TEST(TwoHands, AHandThatIsNotThereYetHoldsItsPartStill) {
  Hands hands;
  hands.add(solid_box({0.01, 0.008, 0.006}), moved_by({0, 0, 0.0065}));
  hands.add(solid_box({0.012, 0.009, 0.006}), moved_by({0, 0, -0.0065}));
  hands.begin();
  hands.samples[1].valid = false;
  for (int i = 0; i < 400; ++i) hands.step(moved_by({0, 0, -1e-5 * i}), {});
  EXPECT_GT(hands.report(0).coupling.f.z(), 0.5);       // pushed back by the part that is held still
  EXPECT_LT(hands.X_WB(1).p.z(), -0.0065);              // which yields as its coupling does
  EXPECT_TRUE(hands.report(1).coupling.f.isZero(0.0));  // and nobody feels
  EXPECT_TRUE(hands.wrenches[1].f.isZero(0.0));
}

/// A peg over a hole, apart and tilted by chance, and two hands that bring them together, each half of the
/// way and led about by a tremble of its own.
struct Insertion : Hands {
  static constexpr double kWidth_m = 0.025, kHole_m = 0.03;
  Random random;
  std::array<Vec3, 2> off, turn;

  Insertion(double clearance_m, std::uint64_t seed) : random(seed) {
    const Peg peg{.width_m = kWidth_m, .depth_m = kWidth_m, .length_m = 0.06, .chamfer_m = 0.001};
    const HoleBlock block{.peg_width_m = kWidth_m,
                          .peg_depth_m = kWidth_m,
                          .clearance_m = clearance_m,
                          .wall_m = 0.025,
                          .hole_depth_m = kHole_m,
                          .floor_m = 0.005};
    add(part_of(peg_pieces(peg)), {});
    add(part_of(hole_block_pieces(block)), {});
    for (std::size_t i = 0; i < 2; ++i) {
      Body& body = world.bodies[i];
      body.X_WB.p = body.part->origin + Vec3(0, 0, i == 0 ? kHole_m + 0.004 : 0.0);
    }
    settings.coupling.stiffness_Nm_per_rad = 0.6;
    settings.coupling.damping_Nms_per_rad = 0.001;
    settings.other_hands[0].coupling = settings.coupling;
    const auto about = [&](double most) {
      return Vec3(most * random.uniform(-1, 1), most * random.uniform(-1, 1), most * random.uniform(-1, 1));
    };
    for (std::size_t h = 0; h < 2; ++h) {
      off[h] = about(0.0006);
      turn[h] = about(0.02);
    }
  }
  /// How far the peg's tip is above the floor of the hole, along the hole.
  double height() const {
    const Pose X_hole = {X_WB(1).R, X_WB(1) * -world.bodies[1].part->origin};
    const Vec3 tip = X_WB(0) * -world.bodies[0].part->origin;
    return (X_hole.inverse() * tip).z();
  }
};

/// The hands bring the parts together and press, at first apart and tilted by `askew_at_first` of what chance
/// has given them.
void bring_together(double askew_at_first, Insertion& pair) {
  constexpr int kFrames = 3000, kJudged = 50;
  int penetrating = 0;
  for (int i = 0; i < kFrames; ++i) {
    const double s = static_cast<double>(i) / kFrames;
    const double in = std::min(1.0, 1.4 * s);
    const double askew = askew_at_first * std::max(0.0, 1.0 - 3.0 * s) * std::min(1.0, 20.0 * s);
    const Vec3 trembles(3e-5 * std::sin(0.06 * i), 3e-5 * std::cos(0.05 * i), 0);
    const double half = 0.5 * (Insertion::kHole_m + 0.004 + 0.002) * in;
    pair.step(moved_by(askew * pair.off[0] + trembles - Vec3(0, 0, half), askew * pair.turn[0]),
              moved_by(askew * pair.off[1] - trembles + Vec3(0, 0, half), askew * pair.turn[1]));
    penetrating += pair.simulation->report().penetrating ? 1 : 0;
    if (i % kJudged == 0) {
      ASSERT_TRUE(pair.referee->judge(pair.state().world.X_WB).empty()) << "frame " << i;
    }
  }
  EXPECT_EQ(penetrating, 0);
  EXPECT_GT(pair.height(), -1e-6);
}

/// A peg that enters with a tilt of more than some sqrt(clearance / half its width), 24 mrad at 7 um, may
/// catch: one side is in, the chamfer of the other lies on the rim, and pressing tilts it further. The hands
/// then pull back, as people do, and come again straight. Returns how often they came.
int insert(double clearance_m, std::uint64_t seed) {
  SCOPED_TRACE(::testing::Message() << "clearance " << clearance_m << " m, seed " << seed);
  constexpr int kPullsBack = 400;
  Insertion pair(clearance_m, seed);
  pair.begin();
  bring_together(1.0, pair);
  if (pair.height() < 0.001) return 1;
  const Vec3 half(0, 0, 0.5 * (Insertion::kHole_m + 0.006));
  for (int i = 0; i < kPullsBack; ++i)
    pair.step(moved_by((i / double{kPullsBack} - 1.0) * half),
              moved_by((1.0 - i / double{kPullsBack}) * half));
  EXPECT_GT(pair.height(), Insertion::kHole_m);
  bring_together(0.0, pair);
  EXPECT_LT(pair.height(), 0.001);
  return 2;
}

TEST(TwoHands, APegInOneGoesIntoTheHoleInTheOther) {
  const int pairs = testing::full_run() ? 20 : testing::effort(3, 1);
  for (const double clearance_m : {20e-6, 7e-6}) {
    int tries = 0;
    for (int seed = 1; seed <= pairs; ++seed) tries += insert(clearance_m, static_cast<std::uint64_t>(seed));
    EXPECT_LE(tries, pairs + 1) << clearance_m;
  }
}

TEST(TwoHands, InThePenaltyResponseNeitherHoldsAJointedBody) {
  for (const int holder : {0, 1}) {
    Hands hands(ResponseModel::kPenalty);
    for (const double x : {0.0, 0.1, 0.2}) hands.add(solid_box({0.01, 0.01, 0.01}), moved_by({x, 0, 0}));
    PairJoint& joint = hands.world.pair_joints.emplace_back();
    joint.parent = holder;
    joint.body = 2;
    joint.joint.kind = JointKind::kHinge;
    const auto made = Simulation::make(hands.world, hands.settings);
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().message().find("jointed"), std::string::npos);
  }
}

}  // namespace
}  // namespace tactum::two_hands_test
