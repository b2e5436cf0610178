/// A scene that is s times as large, met with a workspace scale of s, feels the same: the wrench that is sent
/// is that of scale one, frame by frame.

#include "tactum/response/workspace_scale.h"
#include "support/effort.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/devices/hand_model.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/response/energy.h"

namespace tactum {
namespace {

constexpr double kScales[] = {0.05, 0.1, 10.0, 20.0};
constexpr double kRates_Hz[] = {500.0, 1000.0, 4000.0};
constexpr ResponseModel kResponses[] = {ResponseModel::kConstraint, ResponseModel::kPenalty};

/// A held block of 20 x 14 x 10 mm a little above a plate, everything `scale` times as large.
std::unique_ptr<Simulation> block_over_plate(double scale, ResponseModel response, const std::string& device,
                                             double rate_Hz, const Vec3& handle = {0.002, 0.001, 0.006}) {
  World world;
  world.gravity_W = {0, 0, -9.81};
  add_body(world, {.part = solid_box(scale * Vec3(0.010, 0.007, 0.005)),
                   .mass_kg = 0.03,
                   .X_WP = {Mat3::Identity(), scale * Vec3(0, 0, 0.0052)}});
  add_body(world, {.part = solid_box(scale * Vec3(0.05, 0.05, 0.01)),
                   .X_WP = {Mat3::Identity(), scale * Vec3(0, 0, -0.01)},
                   .joint = {.kind = JointKind::kFixed}});
  FrameSettings settings =
      settings_for(SimulatedDevice(*simulated_device_preset(device), no_hand(), nullptr).info(), rate_Hz);
  settings.response = response;
  settings.workspace.scale = scale;
  settings.tool.body = 0;
  settings.tool.X_BH.p = scale * handle;
  settings.friction = {{0.0, 0.2, 0.2, 0.0}, 2};
  return std::move(*Simulation::make(std::move(world), std::move(settings)));
}

/// The handle is pressed down, turned about all axes, and led sideways.
Pose led(double time_s) {
  const double down = std::min(1.0, time_s / 0.1);
  const double on = std::max(0.0, time_s - 0.1);
  return {exp_rotation({0.05 * std::sin(20 * on), 0.2 * on, 0.3 * on}),
          {0.02 * on, 0.01 * std::sin(15 * on), -0.003 * down + 0.002 * std::sin(30 * on)}};
}

std::vector<Wrench> sent_by(Simulation& simulation, double duration_s) {
  std::vector<Wrench> sent;
  const double dt_s = simulation.settings().dt_s;
  for (int i = 0; i * dt_s < duration_s; ++i) sent.push_back(simulation.step(led(i * dt_s)));
  return sent;
}

struct LargestStep {
  double force_N = 0.0, torque_Nm = 0.0;
};

LargestStep largest_step(const std::vector<Wrench>& sent) {
  LargestStep largest;
  for (std::size_t i = 1; i < sent.size(); ++i) {
    largest.force_N = std::max(largest.force_N, (sent[i].f - sent[i - 1].f).norm());
    largest.torque_Nm = std::max(largest.torque_Nm, (sent[i].t - sent[i - 1].t).norm());
  }
  return largest;
}

void expect_the_same_at_every_scale(ResponseModel response, const std::string& device, double rate_Hz) {
  const auto plain = block_over_plate(1.0, response, device, rate_Hz);
  const std::vector<Wrench> right = sent_by(*plain, 0.6);
  double most_N = 0.0;
  double most_Nm = 0.0;
  for (const Wrench& F : right) {
    most_N = std::max(most_N, F.f.norm());
    most_Nm = std::max(most_Nm, F.t.norm());
  }
  EXPECT_GT(most_N, 0.8) << "something is felt";
  if (plain->settings().port.actuates_torque) {
    EXPECT_GT(most_Nm, 0.003);
  }
  for (const double scale : kScales) {
    SCOPED_TRACE(::testing::Message() << "scale " << scale);
    const auto scaled = block_over_plate(scale, response, device, rate_Hz);
    const std::vector<Wrench> sent = sent_by(*scaled, 0.6);
    for (std::size_t i = 0; i < right.size(); ++i) {
      ASSERT_LT((sent[i].f - right[i].f).norm(), 1e-4 * most_N) << "frame " << i;
      ASSERT_LT((sent[i].t - right[i].t).norm(), 1e-3 * most_Nm + 1e-9) << "frame " << i;
    }
    EXPECT_NEAR(largest_step(sent).force_N, largest_step(right).force_N, 1e-4 * most_N);
    EXPECT_NEAR(largest_step(sent).torque_Nm, largest_step(right).torque_Nm, 1e-3 * most_Nm + 1e-9);
  }
}

TEST(WorkspaceScale, TheSameSceneFeelsTheSameAtEveryScale) {
  for (const ResponseModel response : kResponses)
    for (const double rate_Hz : kRates_Hz) {
      SCOPED_TRACE(::testing::Message() << "response " << int(response) << ", " << rate_Hz << " Hz");
      expect_the_same_at_every_scale(response, "premium-1.5-6dof", rate_Hz);
    }
}

TEST(WorkspaceScale, TheSameSceneFeelsTheSameOnEveryDevice) {
  for (const SimulatedDeviceModel& model : testing::sampled(simulated_device_presets(), 4))
    for (const ResponseModel response : kResponses) {
      SCOPED_TRACE(::testing::Message() << model.name << ", response " << int(response));
      expect_the_same_at_every_scale(response, model.name, 1000.0);
    }
}

/// Closed form: pressed flat by d at the device, the part is felt with k_t (d - gap), and turned with
/// k_r a as long as the face stays flat. So the margin that is told of k_t and k_r holds at every scale.
TEST(WorkspaceScale, TheStiffnessThatIsFeltIsTheCouplings) {
  for (const double rate_Hz : kRates_Hz)
    for (const double scale : {0.05, 0.1, 1.0, 10.0, 20.0}) {
      SCOPED_TRACE(::testing::Message() << scale << ", " << rate_Hz << " Hz");
      const auto block =
          block_over_plate(scale, ResponseModel::kConstraint, "sigma.7", rate_Hz, Vec3::Zero());
      const Coupling& coupling = block->settings().coupling;
      const double depth = 0.002;
      const double turn = 0.4 * coupling.stiffness_N_per_m * depth * 0.007 / coupling.stiffness_Nm_per_rad;
      Wrench sent;
      for (int i = 0; i < 1.0 * rate_Hz; ++i) {
        const double part = std::min(1.0, i / (0.3 * rate_Hz));
        sent = block->step({exp_rotation({part * turn, 0, 0}), {0, 0, -part * (depth + 0.0002)}});
      }
      EXPECT_NEAR(sent.f.z(), coupling.stiffness_N_per_m * depth, 1e-3 * sent.f.z());
      EXPECT_NEAR(sent.t.x(), -coupling.stiffness_Nm_per_rad * turn, 1e-3 * std::abs(sent.t.x()));
    }
}

/// Power at the device is power in the scene over the scale, for force and torque: so work of the hand at the
/// port equals what the scene's stores gain, each over the scale.
TEST(WorkspaceScale, ThePortAndTheScenePassTheSameEnergy) {
  for (const double scale : {0.05, 0.1, 1.0, 10.0, 20.0}) {
    SCOPED_TRACE(scale);
    const Wrench F_W{{1.0, -2.0, 0.5}, {0.3, 0.1, -0.2}};
    const Twist V_D{{0.1, 0.05, -0.02}, {1.0, -0.5, 2.0}};
    const Twist V_W{scale * V_D.v, V_D.w};
    EXPECT_NEAR(power(at_device(F_W, scale), V_D), power(F_W, V_W) / scale, 1e-12);

    World world;
    world.gravity_W = {0, 0, -9.81};
    add_body(world, {.part = solid_box({0.01, 0.01, 0.01}), .mass_kg = 0.2});
    WorldState bodies = initial_state(world);
    FrameSettings settings;
    settings.workspace.scale = scale;
    settings.coupling = {700.0, 0.4, 1.0, 0.001};
    GraspedPart grasped;
    grasped.body = 0;
    grasped.X_WH = {exp_rotation({0, 0, 0.03}), {0, 0, -0.002 * scale}};  // 2 mm at the device
    settings.safety.max_force_N = 5.0;
    settings.safety.max_torque_Nm = 1.0;
    std::array<HandInput, 1> hands;
    hands[0].grasped = grasped;
    const auto store = [&] {
      return stored_energy({.world = world,
                            .settings = settings,
                            .X_WB_start = bodies.X_WB,
                            .bodies = bodies,
                            .hands = hands,
                            .grasped = 0,
                            .to_hand = handle_at(grasped, bodies.X_WB[0]).to_hand,
                            .V_WH = {},
                            .felt = {{0, 0, 1.4}, {0, 0, 0.012}},
                            .smoothed = {}});
    };
    const StoredEnergy start = store();
    EXPECT_NEAR(start.spring_J, 0.5 * 700.0 * 0.002 * 0.002 + 0.5 * 0.4 * 0.03 * 0.03, 1e-12);
    EXPECT_NEAR(start.force_N, 1.4, 1e-12);
    EXPECT_NEAR(start.torque_Nm, 0.012, 1e-12);
    settings.safety.max_force_N = 0.7;  // reached at half the stretch; the other half gives back 0.7 N
    EXPECT_NEAR(store().spring_J, 0.5 * 700.0 * 0.001 * 0.001 + 0.7 * 0.001 + 0.5 * 0.4 * 0.03 * 0.03, 1e-12);
    settings.safety.max_force_N = 5.0;
    bodies.X_WB[0].p.z() -= 0.01 * scale;  // a hand that lowers the weight by 10 mm is pushed by m g
    const StoredEnergy lowered = store();
    EXPECT_NEAR(start.total_J - start.spring_J - (lowered.total_J - lowered.spring_J), 0.2 * 9.81 * 0.01,
                1e-12);
  }
}

/// A hand that presses, turns and comes back has put in no less than it is given back, and the balance is
/// that of scale one.
TEST(WorkspaceScale, TheBalanceOfEnergyIsTheSame) {
  for (const ResponseModel response : kResponses)
    for (const double rate_Hz : kRates_Hz) {
      const auto plain = block_over_plate(1.0, response, "premium-1.5-6dof", rate_Hz);
      sent_by(*plain, 0.6);
      const PortReport& right = plain->report().port;
      for (const double scale : kScales) {
        SCOPED_TRACE(::testing::Message() << int(response) << ", " << rate_Hz << " Hz, scale " << scale);
        const auto scaled = block_over_plate(scale, response, "premium-1.5-6dof", rate_Hz);
        sent_by(*scaled, 0.6);
        const PortReport& port = scaled->report().port;
        EXPECT_NEAR(port.balance_J, right.balance_J, 1e-6);
        EXPECT_NEAR(port.total.from_hand_J, right.total.from_hand_J, 1e-6);
        EXPECT_NEAR(port.total_turning.from_hand_J, right.total_turning.from_hand_J, 1e-6);
      }
    }
}

/// The wrench that is sent while a hand presses the block onto the plate, and holds still.
class HoldWatch final : public LoopObserver {
 public:
  explicit HoldWatch(double from_s) : from_s_(from_s) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    if (record.tick.now_s > from_s_) {
      largest_step_N = std::max(largest_step_N, (record.F_D.f - last_.f).norm());
      sum_N += record.F_D.f;
      ++frames;
    }
    last_ = record.F_D;
    return true;
  }
  double largest_step_N = 0.0;
  Vec3 sum_N = Vec3::Zero();
  int frames = 0;

 private:
  double from_s_;
  Wrench last_;
};

/// The loop closed by the device and a hand: a press is held as still at every scale.
TEST(WorkspaceScale, AHandThatPressesIsHeldAsStill) {
  for (const SimulatedDeviceModel& model : testing::sampled(simulated_device_presets(), 4))
    for (const ResponseModel response : kResponses)
      for (const double rate_Hz : kRates_Hz) {
        if (rate_Hz != 1000.0 && (testing::kSanitized || model.name != "premium-1.5-6dof")) continue;
        const auto hold = [&](double scale) {
          auto motion = std::make_shared<ScriptedMotion>();
          motion->hold(0.6).move_to(0.5, {Mat3::Identity(), {0, 0, -0.0042}}).hold(1.0);
          SimulatedDevice device(model, *hand_model("medium"), motion);
          const auto block = block_over_plate(scale, response, model.name, rate_Hz, Vec3::Zero());
          HoldWatch watch(1.5);
          EXPECT_TRUE(run_virtual(device, *block, rate_Hz, std::uint64_t(2.0 * rate_Hz), &watch));
          return watch;
        };
        const HoldWatch right = hold(1.0);
        for (const double scale : kScales) {
          SCOPED_TRACE(::testing::Message() << model.name << ", response " << int(response) << ", " << rate_Hz
                                            << " Hz, scale " << scale);
          const HoldWatch found = hold(scale);
          EXPECT_GT(found.sum_N.z() / found.frames, 0.4);
          EXPECT_NEAR(found.sum_N.z() / found.frames, right.sum_N.z() / right.frames, 0.02);
          EXPECT_LT(found.largest_step_N, std::max(0.03, 1.2 * right.largest_step_N));
        }
      }
}

TEST(WorkspaceScale, IsTold) {
  EXPECT_EQ(scale_sentence({600.0, 0.3, 1.0, 0.0005}, 1.0), "");
  const std::string large = scale_sentence({600.0, 0.3, 1.0, 0.0005}, 20.0);
  EXPECT_NE(large.find("scale 20: that coupling is 30 N/m and 6 N m/rad in the scene"), std::string::npos)
      << large;
  const std::string small = scale_sentence({600.0, 0.3, 1.0, 0.0005}, 0.1);
  EXPECT_NE(small.find("6e+03 N/m and 0.03 N m/rad"), std::string::npos) << small;
}

}  // namespace
}  // namespace tactum
