/// A grasped part and what is jointed to it: the hand feels the weight and inertia of both, against closed
/// forms.

#include <gtest/gtest.h>

#include <complex>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum::grasped_linkage_test {
namespace {

constexpr double kGravity = 9.81;
const Vec3 kRod(0.002, 0.05, 0.002);  // half a rod of 0.1 m along y [m]

/// The hand holds one body, and another one hangs on it.
class GraspedPair {
 public:
  GraspedPair(double dt_s, double size, const Joint& joint, const Vec3& gravity_W, bool holds_child) {
    World world;
    world.gravity_W = gravity_W;
    const Vec3 half = size * kRod;
    add_body(world, {.part = solid_box(half), .mass_kg = kPalm_kg});
    add_body(world, {.part = solid_box(half), .mass_kg = kHung_kg, .X_WP = {Mat3::Identity(), hung(size)}});
    const Result<void> joined = holds_child ? world.join(0, 1, joint) : world.join(1, 0, joint);
    EXPECT_TRUE(joined) << joined.error().message();
    FrameSettings settings;
    settings.dt_s = dt_s;
    settings.tool.body = 0;
    settings.smoothing.on = false;
    simulation_ = std::move(*Simulation::make(std::move(world), settings));
  }
  static Vec3 hung(double size) { return {0.02 * size, -0.1 * size, 0.0}; }
  Wrench step(const Vec3& hand) {
    simulation_->step(Pose{Mat3::Identity(), hand});
    return simulation_->report().coupling;
  }
  const Pose& X(std::size_t body) const { return simulation_->state().world.X_WB[body]; }
  double now_s() const { return simulation_->time_s(); }

  static constexpr double kPalm_kg = 0.02, kHung_kg = 0.05;

 private:
  std::unique_ptr<Simulation> simulation_;
};

/// At rest the hand feels the weight of both, and the torque of what rides beside the handle.
TEST(GraspedLinkage, TheHandFeelsTheWeightOfWhatHangsOnThePart) {
  for (const double rate_Hz : testing::frame_rates_Hz())
    for (const double size : {0.1, 1.0})
      for (const bool holds_child : {false, true})
        for (const JointKind kind : {JointKind::kFixed, JointKind::kHinge}) {
          SCOPED_TRACE(std::to_string(rate_Hz) + " Hz, size " + std::to_string(size) + ", kind " +
                       std::to_string(static_cast<int>(kind)) + (holds_child ? ", child" : ""));
          // A hinge above the centre of what hangs, with a damper: it comes to rest hanging straight.
          Joint joint{.kind = kind, .anchor_W = GraspedPair::hung(size) + Vec3(0, 0.05 * size, 0)};
          joint.damping = 1e-3 * size;
          GraspedPair pair(1.0 / rate_Hz, size, joint, {0, -kGravity, 0}, holds_child);
          Wrench felt;
          for (int i = 0; i < 2.0 * rate_Hz; ++i) felt = pair.step(Vec3::Zero());
          const double weight = (GraspedPair::kPalm_kg + GraspedPair::kHung_kg) * kGravity;
          EXPECT_NEAR(felt.f.y(), -weight, 2e-3 * weight);
          EXPECT_NEAR(felt.f.x(), 0.0, 2e-3 * weight);
          const double arm = pair.X(1).p.x() - pair.X(0).p.x();
          EXPECT_NEAR(felt.t.z(), -GraspedPair::kHung_kg * kGravity * arm, 2e-3 * weight * size);
        }
}

/// A hand that shakes the part steadily, below resonance, leads it by the amplitude of a spring and the mass
/// of what rides on the part; the part itself has none that is felt.
TEST(GraspedLinkage, TheHandFeelsTheInertiaOfWhatRides) {
  for (const double rate_Hz : {1000.0, 4000.0}) {
    SCOPED_TRACE(rate_Hz);
    Joint joint{.kind = JointKind::kFixed};
    GraspedPair pair(1.0 / rate_Hz, 1.0, joint, Vec3::Zero(), false);
    const double rate = 2.0 * kPi * 6.0;
    const Vec3 along = GraspedPair::hung(1.0).normalized();  // through both, so that nothing turns
    const double amplitude = 0.002;
    const double k = FrameSettings{}.coupling.stiffness_N_per_m;
    const double b = FrameSettings{}.coupling.damping_Ns_per_m;
    // m x'' = k (hand - x) + b (hand' - x') at the end of each step, for a hand on a circle of the plane of
    // complex numbers that turns by w dt in a step.
    const std::complex<double> z = std::polar(1.0, rate / rate_Hz);
    const std::complex<double> pull = z * k + b * rate_Hz * (z - 1.0);
    const double gain =
        std::abs(pull / (GraspedPair::kHung_kg * rate_Hz * rate_Hz * (z - 2.0 + 1.0 / z) + pull));
    double most = 0.0;
    double felt = 0.0;
    const double ramp_s = 2.0;
    for (int i = 0; i < 4.0 * rate_Hz; ++i) {
      const double t = i / rate_Hz;
      const double full = std::min(1.0, t / ramp_s);
      const Wrench wrench = pair.step(full * amplitude * std::sin(rate * t) * along);
      if (t < ramp_s + 1.0) continue;
      most = std::max(most, std::abs(pair.X(0).p.dot(along)));
      felt = std::max(felt, std::abs(wrench.f.dot(along)));
    }
    EXPECT_GT(gain, 1.1);
    EXPECT_NEAR(most, gain * amplitude, 0.01 * amplitude);
    EXPECT_NEAR(felt, GraspedPair::kHung_kg * rate * rate * gain * amplitude, 0.02 * felt);
  }
}

}  // namespace
}  // namespace tactum::grasped_linkage_test
