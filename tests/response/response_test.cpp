/// The responses alone, without the contact finder: a part in the hand over the half space z <= 0, whose
/// patches and gaps are closed forms.

#include "tactum/response/response.h"

#include <gtest/gtest.h>

#include <array>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/solid_box.h"
#include "tactum/contact/motion_bound.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

const Vec3 kHalf(0.010, 0.007, 0.005);  // of the block [m]

Feature face_along(const Polytope& piece, const Vec3& outward) {
  Feature best{FeatureKind::kFace, -1};
  for (std::size_t i = 0; i < piece.faces.size(); ++i)
    if (piece.faces[i].normal.dot(outward) > 0.999) best.index = static_cast<int>(i);
  EXPECT_GE(best.index, 0);
  return best;
}

/// What touches between a block, body 0, and a plate whose top is the plane z = 0, body 1.
class OverPlane final : public GapOracle {
 public:
  OverPlane(const World& world, PatchPoints points) : points_(points) {
    on_block_ = face_along(world.bodies[0].part->pieces[0], -Vec3::UnitZ());
    on_plate_ = face_along(world.bodies[1].part->pieces[0], Vec3::UnitZ());
  }

  static std::array<Vec3, 4> lower_corners(const Pose& X_WB) {
    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i)
      corners[i] = X_WB * Vec3((i & 1 ? 1 : -1) * kHalf.x(), (i & 2 ? 1 : -1) * kHalf.y(), -kHalf.z());
    return corners;
  }
  static double gap(const Pose& X_WB) {
    double least = 1e300;
    for (const Vec3& corner : lower_corners(X_WB)) least = std::min(least, corner.z());
    return least;
  }

  /// The patch at these poses, where the gap is below `margin`.
  std::vector<ContactPatch> patches_at(std::span<const Pose> X_WB, double margin) const {
    if (gap(X_WB[0]) > margin) return {};
    ContactPatch patch;
    patch.body_a = 0;
    patch.body_b = 1;
    patch.piece_a = patch.piece_b = 0;
    patch.pair = 0;
    patch.facets = {0, 0};
    patch.distance = gap(X_WB[0]);
    patch.tolerance = margin;
    Manifold& manifold = patch.manifold;
    const Pose X_AW = X_WB[0].inverse();
    manifold.normal = X_AW.R * Vec3::UnitZ();
    manifold.a = on_block_;
    manifold.b = on_plate_;
    for (const Vec3& corner : lower_corners(X_WB[0])) {
      if (points_ == PatchPoints::kClosest && corner.z() > patch.distance) continue;
      const Vec3 under(corner.x(), corner.y(), 0.0);
      manifold.points.push_back(
          {X_AW * corner, X_AW * under, corner.z(), 0.25, std::uint64_t(manifold.points.size())});
      if (points_ == PatchPoints::kClosest) {
        manifold.points[0].weight = 1.0;
        break;
      }
    }
    manifold.area = points_ == PatchPoints::kQuadrature ? 4.0 * kHalf.x() * kHalf.y() : 0.0;
    return {patch};
  }

  int distances_at(std::span<const Pose> X_WB, std::span<double> distance, std::span<GapAnswer> asked,
                   std::span<const double> /*enough*/, int /*keep_back*/) noexcept override {
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (asked[i] != GapAnswer::kAsked) continue;
      distance[i] = gap(X_WB[0]);
      asked[i] = GapAnswer::kExact;
    }
    return 1;
  }
  double depth_along(int /*patch*/, std::span<const Pose> X_WB, const Vec3& direction_W) noexcept override {
    return direction_W.z() > 0.0 ? std::max(0.0, -gap(X_WB[0])) / direction_W.z() : 0.0;
  }
  FirstImpact first_impact(std::span<const Pose> /*X_WB*/, std::span<const Twist> /*V_WB*/,
                           double dt_s) noexcept override {
    return {dt_s, true};
  }
  Passing passes(int, std::span<const Pose>, std::span<const Twist>, double, double) noexcept override {
    return Passing::kNot;
  }
  PathWork prove_paths(std::span<const Pose>, std::span<const BodyTurn>, std::span<const char>, int,
                       std::span<double> free) noexcept override {
    std::fill(free.begin(), free.end(), 1.0);  // a plane is not passed between two poses above it
    return {};
  }
  bool capacity_reached() const noexcept override { return false; }
  int tests_left() const noexcept override { return 1000; }
  bool budget_limited() const noexcept override { return false; }
  bool blocked(int /*body*/) const noexcept override { return false; }

 private:
  PatchPoints points_;
  Feature on_block_, on_plate_;
};

/// A block that a hand holds over the plane.
struct Hand {
  World world;
  FrameSettings settings;
  WorldState bodies;
  std::vector<ShadingNormals> no_shading;
  std::vector<std::uint8_t> priority{priority::kGrasped, priority::kOther};
  FrameReport report;
  double least_gap_m = 1e300;
  double margin_m = 0.0;  ///< delta of the last frame

  explicit Hand(ResponseModel model) {
    add_body(
        world,
        {.part = solid_box(kHalf), .mass_kg = 0.05, .X_WP = {Mat3::Identity(), {0, 0, kHalf.z() + 0.001}}});
    add_body(world, {.part = solid_box({0.05, 0.05, 0.01}),
                     .X_WP = {Mat3::Identity(), {0, 0, -0.01}},
                     .joint = {.kind = JointKind::kFixed}});
    world.gravity_W = Vec3::Zero();
    settings.response = model;
    settings.tool.body = 0;
    settings.coupling.damping_Ns_per_m = 0.0;
    settings.coupling.damping_Nms_per_rad = 0.0;
    bodies = initial_state(world);
  }

  /// Holds the hand at X_WH for `frames`; returns what is felt in the last.
  Wrench hold(const Pose& X_WH, int frames) {
    Response response(world, settings, bodies);
    OverPlane plane(world, response.points());
    const std::array<double, 2> radius{kHalf.norm(), Vec3(0.05, 0.05, 0.01).norm()};
    Wrench felt;
    for (int i = 0; i < frames; ++i) {
      report = {};
      const GraspedPart grasped{.hand_known = true,
                                .body = 0,
                                .X_BH = {},
                                .X_WH = X_WH,
                                .V_WH = {},
                                .turned_W = {},
                                .in_field = false,
                                .field = {}};
      const std::array<HandInput, 1> hands{hand_input(settings, settings, grasped, radius, 1.0)};
      const MotionInput motion = motion_input(world, settings, hands, radius);
      const std::span<const double> bound = response.bound_motion(motion, bodies);
      const double margin = std::max(bound[0] + bound[1], settings.penalty.min_tolerance_m);
      margin_m = margin;
      const std::vector<ContactPatch> patches = plane.patches_at(bodies.X_WB, margin);
      const std::vector<Pose> start = bodies.X_WB;
      const ContactWork work;
      const StepInput step{motion, patches, priority, work, no_shading, start};
      response.step(step, plane, bodies, report);
      for (int body = 0; body < 2; ++body) {
        // No point went farther than the response said it would, or than pairs are looked for at least.
        const double moved =
            displacement(start[std::size_t(body)], bodies.X_WB[std::size_t(body)], radius[std::size_t(body)]);
        const bool springs = settings.response == ResponseModel::kPenalty;
        const double least = springs ? settings.penalty.min_tolerance_m : 0.0;
        const double most = std::max(bound[std::size_t(body)], least);
        EXPECT_LE(moved, most * (1 + 1e-9) + 1e-15) << "frame " << i << " body " << body;
      }
      least_gap_m = std::min(least_gap_m, OverPlane::gap(bodies.X_WB[0]));
      felt = response.felt(step, handle_at(grasped, bodies.X_WB[0]));
    }
    return felt;
  }
};

Pose hand_at(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
  return {exp_rotation(turn), {x, y, z}};
}

TEST(Response, FreeSpaceIsFollowedAndNothingIsFelt) {
  for (const ResponseModel model : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    Hand hand(model);
    const Pose target = hand_at(0.03, -0.02, 0.04, {0.3, -0.2, 0.5});
    const Wrench felt = hand.hold(target, 600);
    EXPECT_LT((hand.bodies.X_WB[0].p - target.p).norm(), 1e-6);
    EXPECT_LT(log_rotation(hand.bodies.X_WB[0].R.transpose() * target.R).norm(), 1e-6);
    EXPECT_LT(felt.f.norm(), 1e-3);
    EXPECT_LT(felt.t.norm(), 1e-5);
  }
}

/// Nothing is entered, and the spring of the coupling is all that is felt: k_c times how far the hand is
/// below the height at which the block touches.
TEST(Response, TheConstraintResponseRestsOnThePlane) {
  for (const double stiffness : {100.0, 600.0, 5000.0})
    for (const double below : {0.0005, 0.003, 0.012}) {
      SCOPED_TRACE(::testing::Message() << stiffness << " N/m, " << below << " m below");
      Hand hand(ResponseModel::kConstraint);
      hand.settings.coupling.stiffness_N_per_m = stiffness;
      const Wrench felt = hand.hold(hand_at(0.004, 0.001, kHalf.z() - below), 400);
      EXPECT_GE(hand.least_gap_m, 0.0);
      EXPECT_LT(OverPlane::gap(hand.bodies.X_WB[0]), 1e-6);
      EXPECT_NEAR(felt.f.z(), stiffness * below, stiffness * 2e-6);
      EXPECT_NEAR(hand.bodies.X_WB[0].p.x(), 0.004, 1e-6) << "without friction it follows sideways";
      EXPECT_LT(felt.t.norm(), 1e-6 + stiffness * 1e-8);
    }
}

/// A hand that turns the block on the plane: it stays flat while the torque is less than the load can bear
/// with its arm, k_r turn < k_c below half the width.
TEST(Response, TheConstraintResponseStaysFlatUntilTheLoadIsOutside) {
  for (const double turn : {0.05, 0.2}) {
    Hand hand(ResponseModel::kConstraint);
    const double arm = hand.settings.coupling.stiffness_Nm_per_rad * turn /
                       (hand.settings.coupling.stiffness_N_per_m * 0.008);
    const Wrench felt = hand.hold(hand_at(0, 0, kHalf.z() - 0.008, {0, turn, 0}), 600);
    const bool flat = arm < kHalf.x();
    EXPECT_EQ(flat, turn < 0.1);
    EXPECT_GE(hand.least_gap_m, 0.0);
    const double tilt = log_rotation(hand.bodies.X_WB[0].R).norm();
    if (flat) {
      EXPECT_LT(tilt, 1e-4);
      EXPECT_NEAR(felt.t.y(), -hand.settings.coupling.stiffness_Nm_per_rad * turn, 1e-4);
    } else {
      EXPECT_GT(tilt, 0.01);
    }
  }
}

/// The springs of the contact and of the coupling are in series; that of the contact begins at the margin
/// delta above the plane: the load is k_c k_s / (k_c + k_s) (below + delta).
TEST(Response, ThePenaltyResponseIsTwoSpringsInSeries) {
  for (const double coupling : {150.0, 600.0, 5000.0})
    for (const double contact : {0.5 * coupling, coupling, 2.0 * coupling})
      for (const double below : {0.0005, 0.002}) {
        SCOPED_TRACE(::testing::Message()
                     << coupling << " and " << contact << " N/m, " << below << " m below");
        Hand hand(ResponseModel::kPenalty);
        hand.settings.coupling.stiffness_N_per_m = coupling;
        hand.settings.penalty.stiffness_N_per_m = contact;
        const Wrench felt = hand.hold(hand_at(0, 0, kHalf.z() - below), 600);
        const double load = coupling * contact / (coupling + contact) * (below + hand.margin_m);
        EXPECT_NEAR(felt.f.z(), load, 1e-6 * load);
        EXPECT_NEAR(felt.f.z(), contact * (hand.margin_m - OverPlane::gap(hand.bodies.X_WB[0])), 1e-6 * load);
        EXPECT_LT(felt.t.norm(), 1e-6);
      }
}

/// While a hand presses, in every frame of contact: what is felt, the contact force and k_s (delta - d) of
/// that frame are one force, however much stiffer the contact is than the coupling, and however little it is
/// pressed. The part is then pushed off in the frame in which it has met the plane.
TEST(Response, ThePenaltyLawHoldsInEveryFrame) {
  for (const double rate_Hz : testing::frame_rates_Hz())
    for (const double coupling : {150.0, 600.0})
      for (const double ratio : {0.5, 2.0, 5000.0 / 600.0, 20.0})
        for (const double below : {0.00005, 0.0002, 0.001, 0.004}) {
          SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, " << coupling << " N/m, contact " << ratio
                                            << " times that, " << below << " m below");
          Hand hand(ResponseModel::kPenalty);
          hand.settings.dt_s = 1.0 / rate_Hz;
          hand.settings.coupling.stiffness_N_per_m = coupling;
          hand.settings.penalty.stiffness_N_per_m = ratio * coupling;
          int in_contact = 0;
          const int approach = static_cast<int>(0.02 * rate_Hz);
          for (int i = 0; i < 2 * approach; ++i) {
            const double down = below * std::min(1.0, double(i) / approach);
            const Wrench felt = hand.hold(hand_at(0, 0, kHalf.z() - down), 1);
            if (i < approach / 4 || !(hand.report.restoring.f.z() > 0.0)) continue;
            ++in_contact;
            const double law = ratio * coupling * (hand.margin_m - OverPlane::gap(hand.bodies.X_WB[0]));
            EXPECT_NEAR(felt.f.z(), hand.report.restoring.f.z(), 1e-6 * law) << "frame " << i;
            EXPECT_NEAR(felt.f.z(), law, 1e-6 * law) << "frame " << i;
          }
          EXPECT_GT(in_contact, approach);
        }
}

TEST(Response, NothingIsFeltOfAPartThatIsNotHeld) {
  for (const ResponseModel model : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    Hand hand(model);
    hand.settings.tool.body = -1;
    Response response(hand.world, hand.settings, hand.bodies);
    const std::array<double, 2> radius{kHalf.norm(), 0.08};
    const GraspedPart nothing{.hand_known = true,
                              .body = -1,
                              .X_BH = {},
                              .X_WH = hand_at(0, 0, -1),
                              .V_WH = {},
                              .turned_W = {},
                              .in_field = false,
                              .field = {}};
    const std::array<HandInput, 1> hands{hand_input(hand.settings, hand.settings, nothing, radius, 1.0)};
    const MotionInput motion = motion_input(hand.world, hand.settings, hands, radius);
    response.bound_motion(motion, hand.bodies);
    const std::vector<Pose> start = hand.bodies.X_WB;
    const ContactWork work;
    const std::vector<std::uint8_t> priority(2, priority::kOther);
    const StepInput step{motion, {}, priority, work, hand.no_shading, start};
    OverPlane plane(hand.world, response.points());
    response.step(step, plane, hand.bodies, hand.report);
    const Wrench felt = response.felt(step, {});
    EXPECT_EQ(felt.f.norm() + felt.t.norm(), 0.0);
  }
}

}  // namespace
}  // namespace tactum
