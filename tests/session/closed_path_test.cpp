/// A closed path of the hand gives it no energy: a peg is pushed into its hole and drawn out, over and over.
#include <gtest/gtest.h>

#include "support/effort.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum::closed_path_test {
namespace {

struct Insertion {
  const char* scene = "peg-100um";
  double friction = 0.0;
  double aside_m = 0.0015;  // the hand presses the peg against a wall by this
  double tilt_rad = 0.02;
  double cycle_s = 0.4;
  ResponseModel response = ResponseModel::kConstraint;
};

double smooth(double q) { return 0.5 - 0.5 * std::cos(kPi * q); }

/// The net energy that the hand was given after so many cycles, beyond what it has put in [J].
double net_given_J(const Insertion& c, int cycles) {
  Scene scene = std::move(*open_scene(c.scene));
  FrameSettings settings = scene.settings;
  settings.response = c.response;
  settings.safety = safety_limits({.name = "test",
                                   .senses_rotation = true,
                                   .actuates_force = true,
                                   .actuates_torque = true,
                                   .max_force_N = 40.0,
                                   .max_torque_Nm = 4.0});
  if (c.friction > 0.0) {
    const int bodies = static_cast<int>(scene.world.bodies.size());
    settings.friction = {std::vector<double>(static_cast<std::size_t>(bodies * bodies), c.friction), bodies};
  }
  const std::unique_ptr<Simulation> peg = std::move(*Simulation::make(scene.world, settings));
  const Pose start = scene.hand->at(0.0).X_DH;
  const auto at = [&](double depth, double aside, double tilt) {
    return Pose{exp_rotation({0, tilt, 0}) * start.R, start.p + Vec3(-0.004 + aside, 0, -depth)};
  };
  const int frames = static_cast<int>(c.cycle_s / settings.dt_s);
  for (int i = 0; i < 2 * frames; ++i) {  // over the hole, and past the start ramp
    const double q = std::min(1.0, static_cast<double>(i) / frames);
    peg->step(interpolated(start, at(0.0, 0.0, 0.0), smooth(q)));
  }
  const auto given = [&] {
    const PortReport& port = peg->report().port;
    return port.total.to_hand_J - port.total.from_hand_J + port.total_turning.to_hand_J -
           port.total_turning.from_hand_J;
  };
  double most_J = -1.0;
  bool felt = false;
  const double before_J = given();
  for (int cycle = 1; cycle <= cycles; ++cycle) {
    for (int i = 1; i <= 4 * frames; ++i) {  // in, aside and tilted, back, out
      const double q = static_cast<double>(i % frames == 0 ? frames : i % frames) / frames;
      const int part = (i - 1) / frames;
      const double in = part == 0 ? smooth(q) : part == 3 ? 1.0 - smooth(q) : 1.0;
      const double aside = part == 1 ? smooth(q) : part == 2 ? 1.0 - smooth(q) : 0.0;
      peg->step(at(0.025 * in, c.aside_m * aside, c.tilt_rad * aside));
      felt |= peg->report().shown.f.norm() > 0.2;
    }
    most_J = std::max(most_J, (given() - before_J) / cycle);
  }
  EXPECT_TRUE(felt);
  return most_J;
}

TEST(ClosedPath, GivesTheHandNoEnergy) {
  const int cycles = testing::full_run() ? 1000 : testing::effort(20, 2);
  for (const Insertion& c :
       {Insertion{}, Insertion{.friction = 0.1}, Insertion{.friction = 0.3}, Insertion{.aside_m = 0.005},
        Insertion{.scene = "peg-1mm", .friction = 0.1, .tilt_rad = -0.05}, Insertion{.cycle_s = 0.1},
        Insertion{.response = ResponseModel::kPenalty}}) {
    SCOPED_TRACE(::testing::Message() << c.scene << ", friction " << c.friction << ", " << c.aside_m
                                      << " m aside, " << c.cycle_s << " s, response " << int(c.response));
    // Sampling a spring gives K dx^2 / 2 a frame, which the coupling's damper takes back.
    EXPECT_LE(net_given_J(c, cycles), 1e-9);
  }
}

}  // namespace
}  // namespace tactum::closed_path_test
