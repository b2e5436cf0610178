/// Bodies that are jointed to each other and move by themselves, against closed forms: periods, energy,
/// momentum, loads, in both responses, at several rates and sizes, and with the bodies in either order.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/solid_box.h"
#include "tactum/dynamics/pair_joint.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/response/energy.h"

namespace tactum::joined_motion_test {
namespace {

constexpr double kGravity = 9.81;
const Vec3 kRod(0.002, 0.05, 0.002);  // half a rod of 0.1 m along y [m]

struct Setting {
  ResponseModel response = ResponseModel::kConstraint;
  double dt_s = 0.001;
  double size = 1.0;  ///< of everything, against rods of 0.1 m
  bool reversed = false;
};

/// Both responses; four rates; from 10 mm to 3 m; the body before its parent.
std::vector<Setting> settings() {
  std::vector<Setting> all;
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    for (const double rate_Hz : {500.0, 1000.0, 2000.0, 4000.0}) all.push_back({response, 1.0 / rate_Hz});
    for (const double size : {0.1, 30.0}) all.push_back({response, 0.001, size});
    all.push_back({response, 0.001, 1.0, true});
  }
  return testing::sampled(all, 12);
}

std::string name_of(const Setting& s) {
  return std::string(s.response == ResponseModel::kConstraint ? "constraint " : "penalty ") +
         std::to_string(s.dt_s) + " s, size " + std::to_string(s.size) + (s.reversed ? ", reversed" : "");
}

/// A body, and the one that it is jointed to by its place in the list; -1: the world.
struct Piece {
  BodySpec spec;
  int parent = -1;
  Joint joint = {};
};

/// Bodies on joints, and nothing else.
class Linkage {
 public:
  Linkage(const Setting& setting, const Vec3& gravity_W, const std::vector<Piece>& pieces,
          const FrameSettings& base = {}) {
    World world;
    world.gravity_W = gravity_W;
    const int count = static_cast<int>(pieces.size());
    const auto number = [&](int piece) { return setting.reversed ? count - 1 - piece : piece; };
    for (int i = 0; i < count; ++i) {
      const Piece& piece = pieces[static_cast<std::size_t>(number(i))];
      BodySpec spec = piece.spec;
      if (piece.parent < 0) spec.joint = piece.joint;
      number_.push_back(number(i));
      add_body(world, spec);
    }
    for (int i = 0; i < count; ++i) {
      const Piece& piece = pieces[static_cast<std::size_t>(i)];
      if (piece.parent < 0) continue;
      const Result<void> joined = world.join(number(i), number(piece.parent), piece.joint);
      EXPECT_TRUE(joined) << joined.error().message();
    }
    FrameSettings frame = base;
    frame.dt_s = setting.dt_s;
    frame.response = setting.response;
    frame.budget.sleep = false;
    Result<std::unique_ptr<Simulation>> made = Simulation::make(std::move(world), frame);
    EXPECT_TRUE(made) << made.error().message();
    simulation_ = std::move(*made);
  }
  void run(double time_s) {
    const auto frames = std::lround(time_s / simulation_->settings().dt_s);
    for (long i = 0; i < frames; ++i) simulation_->step(Pose{});
  }
  const Pose& X(int piece) const { return state().X_WB[at(piece)]; }
  const Twist& V(int piece) const { return state().V_WB[at(piece)]; }
  double position(int piece) const { return state().joints[at(piece)].now; }
  const World& world() const { return simulation_->world(); }
  const WorldState& state() const { return simulation_->state().world; }
  std::size_t at(int piece) const {
    return static_cast<std::size_t>(number_[static_cast<std::size_t>(piece)]);
  }

  double energy() const { return bodies_energy(world(), state().X_WB, state(), {}); }
  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < world().bodies.size(); ++i)
      sum += world().bodies[i].mass_kg * state().V_WB[i].v;
    return sum;
  }
  /// About the origin.
  Vec3 angular_momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < world().bodies.size(); ++i) {
      const Body& body = world().bodies[i];
      const Pose& X_WB = state().X_WB[i];
      sum += X_WB.p.cross(body.mass_kg * state().V_WB[i].v) +
             X_WB.R * (body.inertia_B * (X_WB.R.transpose() * state().V_WB[i].w));
    }
    return sum;
  }
  /// How far the joints are open, as a fraction of the bodies' size, or turned.
  double open() const {
    double most = 0.0;
    for (const PairJoint& pair : world().pair_joints) {
      const JointError error = joint_error(world(), pair, state().X_WB);
      const double size = world().bodies[static_cast<std::size_t>(pair.body)].part->size;
      most = std::max({most, error.displacement.norm() / size, error.turn.norm()});
    }
    return most;
  }

 private:
  std::unique_ptr<Simulation> simulation_;
  std::vector<int> number_;
};

Joint hinge_at(const Vec3& anchor_W, const Vec3& axis_W = Vec3::UnitZ()) {
  return {.kind = JointKind::kHinge, .axis_W = axis_W, .anchor_W = anchor_W};
}

/// A rod that hangs from `top` at an angle about z.
Piece rod(const Vec3& half, const Vec3& top, double angle, int parent, double mass_kg = 0.05) {
  const Mat3 R = exp_rotation(Vec3(0, 0, angle));
  Piece piece;
  piece.spec = {.part = solid_box(half), .mass_kg = mass_kg, .X_WP = {R, top + R * Vec3(0, -half.y(), 0)}};
  piece.parent = parent;
  piece.joint = hinge_at(top);
  return piece;
}
Vec3 end_of(const Vec3& half, const Vec3& top, double angle) {
  return top + exp_rotation(Vec3(0, 0, angle)) * Vec3(0, -2.0 * half.y(), 0);
}

/// Two rods, one on the other.
std::vector<Piece> double_pendulum(const Vec3& half, double first, double second,
                                   JointKind kind = JointKind::kHinge) {
  std::vector<Piece> pieces{rod(half, Vec3::Zero(), first, -1),
                            rod(half, end_of(half, Vec3::Zero(), first), second, 0)};
  for (Piece& piece : pieces) piece.joint.kind = kind;
  return pieces;
}

/// Two equal rods swing by a little in the two modes of their equations, linear in the angles:
/// (I + m l^2 + m L^2) a'' + m l L b'' = -(m l + m L) g a,  m l L a'' + (I + m l^2) b'' = -m l g b.
TEST(JoinedMotion, ADoublePendulumHasItsTwoPeriods) {
  for (const Setting& setting : settings()) {
    const Vec3 half = setting.size * kRod;
    const double l = half.y();
    const double L = 2.0 * l;
    const double inertia = (half.x() * half.x() + half.y() * half.y()) / 3.0;  // of the mass 1
    Eigen::Matrix2d M;
    Eigen::Matrix2d K;
    M << inertia + l * l + L * L, l * L, l * L, inertia + l * l;
    K << (l + L) * kGravity, 0, 0, l * kGravity;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> modes(K, M);
    for (int mode = 0; mode < 2; ++mode) {
      SCOPED_TRACE(name_of(setting) + ", mode " + std::to_string(mode));
      const double rate = std::sqrt(modes.eigenvalues()[mode]);
      const Eigen::Vector2d shape = 1e-3 * modes.eigenvectors().col(mode).normalized();
      Linkage rods(setting, {0, -kGravity, 0}, double_pendulum(half, shape[0], shape[1]));
      const double start = shape[1] - shape[0];
      // A quarter of a period after ten of them the rods are in line.
      const double time_s = testing::effort(10.25, 2.25) * 2.0 * kPi / rate;
      rods.run(time_s);
      const double step = rate * setting.dt_s;
      // Half a frame of rounding of the time, and the phase to the second order of the step.
      EXPECT_NEAR(start + rods.position(1), 0.0, std::abs(start) * (step + 70.0 * step * step / 24.0 + 2e-3));
      EXPECT_LT(rods.open(), 1e-12);
    }
  }
}

/// A swing over the top: the energy stays for a minute, on hinges and on balls, which leave the plane.
TEST(JoinedMotion, ADoublePendulumKeepsItsEnergyForAMinute) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const JointKind kind : {JointKind::kHinge, JointKind::kBall})
      for (const double size : {1.0, 10.0}) {
        const bool small = response == ResponseModel::kConstraint && size == 1.0;
        if (testing::kSanitized && !small) continue;
        if (response == ResponseModel::kPenalty && size != 1.0) continue;  // the same code moves them
        const Setting setting{response, 0.001, size};
        SCOPED_TRACE(name_of(setting) + (kind == JointKind::kHinge ? " hinge" : " ball"));
        std::vector<Piece> pieces = double_pendulum(size * kRod, 2.0, 2.5, kind);
        if (kind == JointKind::kBall) pieces[1].spec.V_WB.v = Vec3(0, 0, 0.3 * std::sqrt(size));
        Linkage rods(setting, {0, -kGravity, 0}, pieces);
        // The velocities are those of the middle of a frame: the mean of many frames has no first order.
        const auto mean = [&] {
          double sum = 0.0;
          for (int i = 0; i < 1000; ++i) {
            rods.run(0.001);
            sum += rods.energy() / 1000.0;
          }
          return sum;
        };
        const double swing = 0.1 * kGravity * (0.05 + 0.1) * size;  // of both, from hanging to level
        const double first = mean();
        rods.run(testing::kSanitized ? 3.0 : 59.0);
        const double last = mean();
        EXPECT_NEAR(last, first, 1e-3 * swing);
        EXPECT_LT(rods.open(), 1e-12);
      }
}

/// A pair that nothing else holds keeps its momenta while a spring in its joint shakes it.
TEST(JoinedMotion, AFreePairKeepsItsMomenta) {
  for (const Setting& setting : settings())
    for (const JointKind kind :
         {JointKind::kHinge, JointKind::kSlider, JointKind::kBall, JointKind::kFixed}) {
      SCOPED_TRACE(name_of(setting) + ", kind " + std::to_string(static_cast<int>(kind)));
      const Vec3 half = setting.size * Vec3(0.02, 0.05, 0.01);
      const double m = 0.05;
      std::vector<Piece> pieces{rod(half, Vec3(0.1, 0.2, 0.3) * setting.size, 0.4, -1, m),
                                rod(half, Vec3(0.1, 0.2, 0.3) * setting.size, -0.9, 0, 2.0 * m)};
      pieces[0].joint = {};
      pieces[0].spec.V_WB = {Vec3(0.3, -0.2, 0.1) * setting.size, Vec3(1.0, -2.0, 3.0)};
      pieces[1].spec.V_WB = {Vec3(-0.1, 0.2, 0.3) * setting.size, Vec3(-2.0, 1.0, 2.0)};
      pieces[1].joint.kind = kind;
      const double inertia = m * half.y() * half.y();
      if (kind == JointKind::kHinge || kind == JointKind::kSlider) {
        pieces[1].joint.stiffness = kind == JointKind::kHinge ? 400.0 * inertia : 400.0 * m;
        pieces[1].joint.rest = kind == JointKind::kHinge ? 0.8 : 0.03 * setting.size;
        pieces[1].joint.friction = kind == JointKind::kHinge ? inertia : 0.1 * m * setting.size;
      }
      Linkage pair(setting, Vec3::Zero(), pieces);
      const double speed = setting.size * 0.5;
      const Vec3 linear = pair.momentum();
      const Vec3 angular = pair.angular_momentum();
      pair.run(1.0);
      EXPECT_LT((pair.momentum() - linear).norm(), 1e-12 * 3.0 * m * speed);
      EXPECT_LT((pair.angular_momentum() - angular).norm(), 1e-11 * 3.0 * m * speed * setting.size);
      EXPECT_LT(pair.open(), 1e-12);
    }
}

/// A slider between two free bodies, with a spring: the period of the reduced mass.
TEST(JoinedMotion, ASpringBetweenTwoBodiesHasTheReducedMass) {
  for (const Setting& setting : settings())
    for (const double turns_a_step : {0.002, 0.02}) {
      SCOPED_TRACE(name_of(setting) + ", " + std::to_string(turns_a_step));
      const double m = 0.05;
      const double reduced = m * 3.0 * m / (4.0 * m);
      const double rate = 2.0 * kPi * turns_a_step / setting.dt_s;
      const double amplitude = 0.01 * setting.size;
      std::vector<Piece> pieces{rod(setting.size * kRod, Vec3::Zero(), 0.0, -1, m),
                                rod(setting.size * kRod, Vec3::Zero(), 0.0, 0, 3.0 * m)};
      pieces[0].joint = {};
      pieces[1].joint = {.kind = JointKind::kSlider,
                         .axis_W = Vec3::UnitX(),
                         .stiffness = reduced * rate * rate,
                         .rest = amplitude};
      Linkage cart(setting, Vec3::Zero(), pieces);
      cart.run(20.0 / turns_a_step * setting.dt_s);
      const double step = rate * setting.dt_s;
      const double phase = 20.0 * 2.0 * kPi * step * step / 12.0 + step;
      EXPECT_NEAR(cart.position(1), 0.0, 2.0 * amplitude * phase * phase);
      cart.run(0.5 / turns_a_step * setting.dt_s);
      EXPECT_NEAR(cart.position(1), 2.0 * amplitude, 2.0 * amplitude * phase * phase + 1e-9 * amplitude);
    }
}

/// Five masses that hang on sprung sliders, one from the other: each spring carries all that hangs below it.
TEST(JoinedMotion, AChainAtRestCarriesWhatHangsBelow) {
  for (const Setting& setting : settings()) {
    SCOPED_TRACE(name_of(setting));
    const double k = 400.0;
    const double m = 0.05;
    std::vector<Piece> pieces;
    for (int i = 0; i < 5; ++i) {
      pieces.push_back(rod(setting.size * kRod, Vec3(0, -i * 0.2 * setting.size, 0), 0.0, i - 1, m));
      pieces.back().joint = {
          .kind = JointKind::kSlider, .axis_W = -Vec3::UnitY(), .damping = 6.0, .stiffness = k};
    }
    Linkage chain(setting, {0, -kGravity, 0}, pieces);
    chain.run(5.0);
    for (int i = 0; i < 5; ++i) {
      EXPECT_NEAR(chain.position(i), (5 - i) * m * kGravity / k, 1e-6 * m * kGravity / k) << i;
      EXPECT_LT(chain.V(i).v.norm(), 1e-6);
    }
  }
}

/// Two bodies on a slider part until its stop, and then go on together; with dry friction they come to go
/// together after the time that it takes.
TEST(JoinedMotion, AStopAndFrictionBetweenTwoBodies) {
  for (const Setting& setting : settings())
    for (const bool stop : {true, false}) {
      SCOPED_TRACE(name_of(setting) + (stop ? " stop" : " friction"));
      const double m = 0.05;
      const double speed = 0.2 * setting.size;
      const double time_s = 0.25;  // until they go together
      std::vector<Piece> pieces{rod(setting.size * kRod, Vec3::Zero(), 0.0, -1, m),
                                rod(setting.size * kRod, Vec3::Zero(), 0.0, 0, 3.0 * m)};
      pieces[0].joint = {};
      pieces[1].spec.V_WB.v = {speed, 0, 0};
      pieces[1].joint = {.kind = JointKind::kSlider, .axis_W = Vec3::UnitX()};
      const double reduced = 0.75 * m;
      if (stop) {
        pieces[1].joint.upper = speed * time_s;
      } else {
        pieces[1].joint.friction = reduced * speed / time_s;
      }
      Linkage pair(setting, Vec3::Zero(), pieces);
      pair.run(2.0 * time_s);
      const double apart = stop ? speed * time_s : 0.5 * speed * time_s;
      EXPECT_NEAR(pair.position(1), apart, 0.002 * apart + speed * setting.dt_s);
      for (const int piece : {0, 1}) EXPECT_NEAR(pair.V(piece).v.x(), 0.75 * speed, 1e-3 * speed) << piece;
    }
}

/// A door on a block that slides freely: the momentum along the slide stays, and so does the energy.
TEST(JoinedMotion, ADoorSwingsOnABlockThatSlides) {
  for (const Setting& setting : settings()) {
    SCOPED_TRACE(name_of(setting));
    const Vec3 half = setting.size * kRod;
    std::vector<Piece> pieces{rod(half, Vec3::Zero(), 0.0, -1), rod(half, Vec3::Zero(), 0.3, 0)};
    pieces[0].joint = {.kind = JointKind::kSlider, .axis_W = Vec3::UnitX()};
    const double rate = 3.0;
    pieces[1].spec.V_WB = {Vec3(0, 0, rate).cross(pieces[1].spec.X_WP.p), Vec3(0, 0, rate)};
    Linkage door(setting, Vec3::Zero(), pieces);
    const double along = door.momentum().x();
    const double energy = door.energy();
    door.run(5.0);
    EXPECT_NEAR(door.momentum().x(), along, 1e-11 * 0.1 * rate * half.y());
    EXPECT_NEAR(door.energy(), energy, (0.02 + 3.0 * rate * setting.dt_s) * energy);
    EXPECT_GT(std::abs(door.position(1)), 5.0);
    EXPECT_LT(door.open(), 1e-12);
  }
}

/// Two halves of a box, one riding on the other, tumble as the whole does.
TEST(JoinedMotion, ABodyThatRidesMovesAsOneWithTheOther) {
  for (const Setting& setting : settings()) {
    SCOPED_TRACE(name_of(setting));
    const Vec3 half = setting.size * Vec3(0.02, 0.05, 0.01);
    const Vec3 whole(half.x(), 2.0 * half.y(), half.z());
    const Vec3 w(2.0, 1.0, -1.5);
    const Vec3 v = setting.size * Vec3(0.1, 0.2, 0.3);
    std::vector<Piece> pieces(2);
    for (int i = 0; i < 2; ++i) {
      const Vec3 p(0, (i == 0 ? 1 : -1) * half.y(), 0);
      pieces[static_cast<std::size_t>(i)].spec = {.part = solid_box(half),
                                                  .mass_kg = 0.05,
                                                  .X_WP = {Mat3::Identity(), p},
                                                  .V_WB = {v + w.cross(p), w}};
    }
    pieces[1].parent = 0;
    pieces[1].joint.kind = JointKind::kFixed;
    Piece one;
    one.spec = {.part = solid_box(whole), .mass_kg = 0.1, .V_WB = {v, w}};
    Linkage halves(setting, {0, -kGravity, 0}, pieces);
    Linkage box(setting, {0, -kGravity, 0}, {one});
    halves.run(1.0);
    box.run(1.0);
    const Vec3 centre = 0.5 * (halves.X(0).p + halves.X(1).p);
    EXPECT_LT((centre - box.X(0).p).norm(), 1e-6 * setting.size + 1e-9);
    const double turned = log_rotation(halves.X(0).R * box.X(0).R.transpose()).norm();
    EXPECT_LT(turned, 2.0 * std::pow(w.norm() * setting.dt_s, 2) + 1e-9);
    EXPECT_LT(halves.open(), 1e-12);
  }
}

/// Two jointed rods that fall on a floor come to rest on it, whole.
TEST(JoinedMotion, APairThatFallsComesToRestOnTheFloor) {
  for (const Setting& setting : settings()) {
    SCOPED_TRACE(name_of(setting));
    const Vec3 half = setting.size * kRod;
    std::vector<Piece> pieces{{},
                              rod(half, setting.size * Vec3(0, 0.2, 0), 0.5, -1),
                              rod(half, setting.size * Vec3(0, 0.2, 0), -0.9, 1)};
    pieces[0].spec = {.part = solid_box(setting.size * Vec3(0.5, 0.05, 0.5)),
                      .X_WP = {Mat3::Identity(), setting.size * Vec3(0, -0.05, 0)}};
    pieces[0].joint.kind = JointKind::kFixed;
    pieces[1].joint = {};
    Linkage fallen(setting, {0, -kGravity, 0}, pieces);
    double lowest = 1.0;
    for (int i = 0; i < 150; ++i) {
      fallen.run(0.01 * std::sqrt(setting.size));
      for (const int piece : {1, 2})
        for (const Vec3& corner : fallen.world().bodies[fallen.at(piece)].part->surface.vertices)
          lowest = std::min(lowest, (fallen.X(piece) * corner).y());
      ASSERT_LT(fallen.open(), 1e-12);
    }
    EXPECT_GT(lowest, 0.0);
    for (const int piece : {1, 2}) EXPECT_LT(fallen.X(piece).p.y(), 3.0 * half.x());
  }
}

/// A chain with more unknowns than the exact solver has room for.
TEST(JoinedMotion, ALongChainGainsNoEnergy) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    const Setting setting{response};
    std::vector<Piece> pieces;
    Vec3 top = Vec3::Zero();
    for (int i = 0; i < 10; ++i) {
      pieces.push_back(rod(kRod, top, 0.6, i - 1));
      top = end_of(kRod, top, 0.6);
    }
    Linkage chain(setting, {0, -kGravity, 0}, pieces);
    const double first = chain.energy();
    const double swing = 10 * 0.05 * kGravity * 0.5 * (1.0 - std::cos(0.6));
    for (int i = 0; i < testing::effort(30, 6); ++i) {
      chain.run(0.1);
      EXPECT_LT(chain.energy(), first + 0.05 * swing) << i;
      ASSERT_LT(chain.open(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace tactum::joined_motion_test
