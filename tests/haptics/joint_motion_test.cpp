/// Jointed bodies that move by themselves, against closed forms: no energy is lost or made, periods are right
/// at any amplitude, and a hinge is followed over full turns.

#include <gtest/gtest.h>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/response/energy.h"

namespace tactum::joint_motion_test {
namespace {

const Vec3 kRod(0.002, 0.05, 0.002);  // half a rod of 0.1 m along y [m]

struct Setting {
  ResponseModel response = ResponseModel::kConstraint;
  double dt_s = 0.001;
  double size = 1.0;  ///< of everything, against a rod of 0.1 m
};

/// Both responses; four rates; three sizes.
std::vector<Setting> settings() {
  std::vector<Setting> all;
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    for (const double rate_Hz : {500.0, 1000.0, 2000.0, 4000.0})
      all.push_back({response, 1.0 / rate_Hz, 1.0});
    for (const double size : {0.1, 30.0}) all.push_back({response, 0.001, size});
  }
  return testing::sampled(all, 11);
}

std::string name_of(const Setting& s) {
  return (s.response == ResponseModel::kConstraint ? "constraint " : "penalty ") + std::to_string(s.dt_s) +
         " s, size " + std::to_string(s.size);
}

/// One body on a joint, and nothing else.
class Alone {
 public:
  Alone(const Setting& setting, const Vec3& half, const Joint& joint, const Vec3& gravity_W, const Twist& V,
        const Pose& X_WP = {}) {
    World world;
    world.gravity_W = gravity_W;
    add_body(world, {.part = solid_box(half), .mass_kg = kMass_kg, .X_WP = X_WP, .V_WB = V, .joint = joint});
    FrameSettings frame;
    frame.dt_s = setting.dt_s;
    frame.response = setting.response;
    frame.budget.sleep = false;
    simulation_ = std::move(*Simulation::make(std::move(world), frame));
  }
  void run(double time_s) {
    const auto frames = std::lround(time_s / simulation_->settings().dt_s);
    for (long i = 0; i < frames; ++i) simulation_->step(Pose{});
  }
  double position() const { return simulation_->state().world.joints[0].now; }
  const Pose& X_WB() const { return simulation_->state().world.X_WB[0]; }
  const Twist& V_WB() const { return simulation_->state().world.V_WB[0]; }
  const World& world() const { return simulation_->world(); }

  static constexpr double kMass_kg = 0.05;

 private:
  std::unique_ptr<Simulation> simulation_;
};

/// K(m) of the quarter period, by the arithmetic-geometric mean; m = sin^2 of half the amplitude.
double quarter_period(double amplitude_rad) {
  double a = 1.0;
  double b = std::cos(0.5 * amplitude_rad);
  for (int i = 0; i < 12; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return kPi / (2.0 * a);
}

/// A door keeps its rate, wherever its axis is.
TEST(JointMotion, ADoorKeepsItsRate) {
  for (const Setting& setting : settings()) {
    SCOPED_TRACE(name_of(setting));
    for (const double rate : {0.3, 10.0, -40.0}) {
      Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitZ()};
      hinge.anchor_W = setting.size * Vec3(0.02, -0.05, 0.01);
      const Twist V{Vec3::UnitZ().cross(-hinge.anchor_W) * rate, Vec3::UnitZ() * rate};
      Alone door(setting, setting.size * kRod, hinge, Vec3::Zero(), V);
      door.run(3.0);
      EXPECT_NEAR(door.V_WB().w.z(), rate, 1e-9 * std::abs(rate));
      EXPECT_NEAR(door.position(), 3.0 * rate, 1e-9 * std::abs(3.0 * rate));
    }
  }
}

/// A rod let go at an angle from hanging is back there after its period, which is an elliptic integral.
TEST(JointMotion, APendulumHasItsPeriodAtAnyAmplitude) {
  for (const Setting& setting : settings())
    for (const double amplitude : {0.1, kPi / 3.0, kPi / 2.0, 2.8}) {
      SCOPED_TRACE(name_of(setting) + ", amplitude " + std::to_string(amplitude));
      const Vec3 half = setting.size * kRod;
      const Vec3 hanging(0.0, -half.y(), 0.0);
      const Pose X{exp_rotation(Vec3(0, 0, amplitude)), exp_rotation(Vec3(0, 0, amplitude)) * hanging};
      const Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitZ(), .anchor_W = Vec3::Zero()};
      Alone rod(setting, half, hinge, {0, -9.81, 0}, {}, X);
      const double inertia = (half.x() * half.x() + half.y() * half.y()) / 3.0 + half.y() * half.y();
      const double period_s = 4.0 * quarter_period(amplitude) * std::sqrt(inertia / (9.81 * half.y()));
      const int periods = setting.size < 1.0 ? testing::effort(20, 5) : setting.size > 1.0 ? 2 : 10;
      rod.run(periods * period_s);
      // Half a frame's turn at the turning point, and the phase to the second order of the step.
      const double rate = std::sqrt(9.81 * half.y() / inertia);
      const double steps = setting.dt_s * rate;
      const double phase = periods * 2.0 * kPi * steps * steps + steps;
      EXPECT_NEAR(rod.position(), 0.0, amplitude * phase * phase + 0.02 * phase + 1e-9);
    }
}

double swing_energy(const Alone& a, double g) {
  // By the position alone would miss the motion: the velocity is that of the middle of the step, which moves
  // the energy by a share of the step that cancels over a swing.
  const Vec3 w_B = a.X_WB().R.transpose() * a.V_WB().w;
  return 0.5 * Alone::kMass_kg * a.V_WB().v.squaredNorm() +
         0.5 * w_B.dot(a.world().bodies[0].inertia_B * w_B) + Alone::kMass_kg * g * a.X_WB().p.y();
}

/// The mean energy of a swing does not change in a minute: pendulums on a hinge and on a ball.
TEST(JointMotion, APendulumKeepsItsEnergyForAMinute) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const JointKind kind : {JointKind::kHinge, JointKind::kBall}) {
      SCOPED_TRACE(name_of({response}) + (kind == JointKind::kHinge ? " hinge" : " ball"));
      const Pose X{exp_rotation(Vec3(0, 0, kPi / 3.0)),
                   exp_rotation(Vec3(0, 0, kPi / 3.0)) * Vec3(0, -0.05, 0)};
      const Joint joint{.kind = kind, .axis_W = Vec3::UnitZ(), .anchor_W = Vec3::Zero()};
      Alone rod({response}, kRod, joint, {0, -9.81, 0}, {}, X);
      const auto mean = [&] {
        double sum = 0.0;
        for (int i = 0; i < 600; ++i) {
          rod.run(0.001);
          sum += swing_energy(rod, 9.81) / 600.0;
        }
        return sum;
      };
      const double lowest = -Alone::kMass_kg * 9.81 * 0.05;
      const double first = mean() - lowest;
      rod.run(testing::effort(59.0, 5.0));
      EXPECT_NEAR(mean() - lowest, first, 1e-3 * first);
    }
}

/// A mass on a spring, from soft to one that the step just resolves: the amplitude stays.
TEST(JointMotion, ASprungSliderKeepsItsSwing) {
  for (const Setting& setting : settings())
    for (const double turns_a_step : {0.001, 0.01, 0.08}) {
      SCOPED_TRACE(name_of(setting) + ", " + std::to_string(turns_a_step) + " turns a step");
      const double rate = 2.0 * kPi * turns_a_step / setting.dt_s;
      const double k = Alone::kMass_kg * rate * rate;
      const double amplitude = 0.01 * setting.size;
      const Joint slider{
          .kind = JointKind::kSlider, .axis_W = Vec3::UnitX(), .stiffness = k, .rest = amplitude};
      Alone mass(setting, setting.size * kRod, slider, Vec3::Zero(), {});
      mass.run(5.0);
      double most = 0.0;
      double least = 1e300;
      for (int i = 0; i < 2.0 / turns_a_step; ++i) {
        mass.run(setting.dt_s);
        most = std::max(most, mass.position());
        least = std::min(least, mass.position());
      }
      // Of twice the amplitude the frames see at least the cosine of half a step.
      const double seen = 1.0 - std::cos(kPi * turns_a_step);
      EXPECT_NEAR(most, 2.0 * amplitude, 2.0 * amplitude * (seen + 0.01));
      EXPECT_NEAR(least, 0.0, 2.0 * amplitude * (seen + 0.01));
    }
}

/// Stops and springs of a hinge beyond half a turn are met, either way.
TEST(JointMotion, AHingeIsFollowedOverFullTurns) {
  for (const Setting& setting : settings())
    for (const double degrees : {200.0, -250.0, 400.0, -1000.0}) {
      SCOPED_TRACE(name_of(setting) + ", " + std::to_string(degrees) + " degrees");
      const double to = degrees * kPi / 180.0;
      const double scale = std::pow(setting.size, 2);  // of inertia, at the same mass
      Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitZ(), .anchor_W = Vec3::Zero()};
      hinge.damping = 0.0005 * scale;
      hinge.stiffness = 0.002 * scale;
      hinge.rest = to;
      Alone sprung(setting, setting.size * kRod, hinge, Vec3::Zero(), {});
      sprung.run(4.0);
      EXPECT_NEAR(sprung.position(), to, 0.002 * std::abs(to));
      hinge.rest = 2.0 * to;
      (to > 0.0 ? hinge.upper : hinge.lower) = to;
      Alone stopped(setting, setting.size * kRod, hinge, Vec3::Zero(), {});
      stopped.run(4.0);
      EXPECT_NEAR(stopped.position(), to, 1e-4);
    }
}

}  // namespace
}  // namespace tactum::joint_motion_test
