/// A scene with two tools on two devices: as it runs, and when one of the devices is unplugged.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tactum/drivers/registry.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"
#include "tactum/session/session.h"

namespace tactum::two_devices_test {
namespace {

constexpr double kStep_N = 0.05;          // the largest that is no step
constexpr double kLed_to_zero_s = 0.020;  // ... within this, when a device is lost

/// What a device has been sent.
struct Sent {
  std::vector<Wrench> wrenches;
  bool closed = false;
};

/// A simulated device that is unplugged at a time: its reads and writes fail from then on.
class Unplugged final : public Device {
 public:
  Unplugged(std::unique_ptr<Device> device, double at_s, Sent& sent)
      : device_(std::move(device)), at_s_(at_s), sent_(sent) {}
  Result<void> open() override { return device_->open(); }
  void close() noexcept override {
    sent_.closed = true;
    device_->close();
  }
  const DeviceInfo& info() const noexcept override { return device_->info(); }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    gone_ = now_s >= at_s_;
    if (!gone_) return device_->read(now_s, sample);
    sample.valid = false;
    return false;
  }
  bool write(const Wrench& F_D) noexcept override {
    sent_.wrenches.push_back(F_D);
    return !gone_ && device_->write(F_D);
  }

 private:
  std::unique_ptr<Device> device_;
  double at_s_;
  Sent& sent_;
  bool gone_ = false;
};

/// Leads a hand by a way from where its probe is, after a tenth of a second.
class Lead final : public LoopObserver {
 public:
  Lead(Session& session, std::uint32_t hand, const Vec3& by) : session_(session), hand_(hand), by_(by) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    if (record.tick.index != 100) return true;
    SessionCommand aim;
    aim.kind = SessionCommand::Kind::kAim;
    aim.hand = hand_;
    const Pose X_WH = session_.state().of_hand(hand_).hand.X_WH;
    const Quat q(X_WH.R);
    for (int i = 0; i < 3; ++i) aim.p_WH[static_cast<std::size_t>(i)] = X_WH.p[i] + by_[i];
    aim.quat_wxyz_WH = {q.w(), q.x(), q.y(), q.z()};
    to = X_WH.p + by_;
    return session_.ask(aim);
  }
  Vec3 to = Vec3::Zero();

 private:
  Session& session_;
  std::uint32_t hand_;
  Vec3 by_;
};

Scene two_hands() {
  Result<Scene> scene = open_scene("peg-two-hands");
  EXPECT_TRUE(scene) << scene.error().message();
  return std::move(*scene);
}

std::unique_ptr<Device> simulated(const SceneHand& hand) {
  DeviceOptions options;
  options.hand_motion = hand.hand;
  options.grip = hand.grip;
  Result<std::unique_ptr<Device>> device = make_device("simulated:" + hand.device, options);
  EXPECT_TRUE(device) << device.error().message();
  return std::move(*device);
}

/// The scene with hand `lost` unplugged at `at_s`; what each device was sent.
std::vector<Sent> run_unplugged(std::size_t lost, double at_s, std::uint64_t frames) {
  constexpr double kNever_s = 1e9;
  Scene scene = two_hands();
  std::vector<Sent> sent(2);
  std::vector<std::unique_ptr<Device>> devices;
  for (std::size_t h = 0; h < 2; ++h)
    devices.push_back(std::make_unique<Unplugged>(simulated(h == 0 ? scene : scene.other_hands[0]),
                                                  h == lost ? at_s : kNever_s, sent[h]));
  Result<std::unique_ptr<Session>> session = Session::open_with(std::move(scene), std::move(devices));
  EXPECT_TRUE(session) << session.error().message();
  const Result<VirtualRun> run = (*session)->run_virtual(frames, nullptr);
  EXPECT_TRUE(run);
  EXPECT_EQ(run->frames, frames);  // the loop goes on for the other hand
  return sent;
}

TEST(TwoDevices, RunTheSceneToItsGoalsAndToTheSameBits) {
  std::uint64_t hash = 0;
  for (const int again : {0, 1}) {
    Result<std::unique_ptr<Session>> session = Session::open(two_hands(), {});
    ASSERT_TRUE(session) << session.error().message();
    Session& run = **session;
    ASSERT_EQ(run.hands(), 2u);
    const auto frames = static_cast<std::uint64_t>(run.scene().hand->duration_s() * run.rate_Hz());
    ASSERT_TRUE(run.run_virtual(frames, nullptr));
    EXPECT_TRUE(run.goals().all_met());
    EXPECT_EQ(run.record().penetrating_frames, 0u);
    EXPECT_EQ(run.record().non_finite_frames, 0u);
    EXPECT_GT(run.record().max_force_N, 0.5);
    ASSERT_EQ(run.record().other_hands.size(), 1u);
    EXPECT_GT(run.record().other_hands[0].max_force_N, 0.5);
    EXPECT_GT(run.record().other_hands[0].grasped_contact_frames, 1000u);
    if (again == 1) {
      EXPECT_EQ(run.record().hash(), hash);
    }
    hash = run.record().hash();
  }
}

TEST(TwoDevices, OneThatIsUnpluggedLeavesTheOtherWithoutAStep) {
  for (const std::size_t lost : {std::size_t{0}, std::size_t{1}}) {
    SCOPED_TRACE(lost);
    constexpr double kAt_s = 4.55;  // while the peg is pressed onto the floor of the hole
    constexpr std::uint64_t kFrames = 4790;
    const std::vector<Sent> sent = run_unplugged(lost, kAt_s, kFrames);
    const auto at = static_cast<std::size_t>(kAt_s * 1000.0);
    const std::vector<Wrench>& gone = sent[lost].wrenches;
    const std::vector<Wrench>& on = sent[1 - lost].wrenches;
    ASSERT_GE(on.size(), kFrames);
    EXPECT_GT(on[at].f.norm(), 0.1);  // they press against each other
    for (std::size_t i = at; i < kFrames; ++i) {
      EXPECT_LT((on[i].f - on[i - 1].f).norm(), kStep_N) << "frame " << i;
    }
    EXPECT_GT(on[kFrames - 1].f.norm(), 0.05);  // it still feels the part of the lost hand
    for (std::size_t i = at + static_cast<std::size_t>(1000.0 * kLed_to_zero_s); i < kFrames; ++i)
      EXPECT_TRUE(is_zero(gone[i])) << "frame " << i;
    for (const Sent& each : sent) {
      EXPECT_TRUE(each.closed);
      EXPECT_TRUE(is_zero(each.wrenches.back()));
    }
  }
}

TEST(TwoDevices, AreOneDeviceWhileSomeAnswers) {
  Scene scene = two_hands();
  std::vector<Sent> sent(2);
  std::vector<std::unique_ptr<Device>> made;
  made.push_back(std::make_unique<Unplugged>(simulated(scene), 0.010, sent[0]));
  made.push_back(std::make_unique<Unplugged>(simulated(scene.other_hands[0]), 0.020, sent[1]));
  HandDevices devices(std::move(made));
  ASSERT_TRUE(devices.open());
  const Wrench pull{{0.1, 0, 0}, Vec3::Zero()}, push{{-0.2, 0, 0}, Vec3::Zero()};
  for (int i = 0; i < 30; ++i) {
    DeviceSample sample;
    EXPECT_EQ(devices.read(0.001 * i, sample), i < 20) << i;
    EXPECT_EQ(sample.valid, i < 10);
    EXPECT_EQ(devices.samples()[1].valid, i < 20);
    devices.wrenches()[0] = pull;
    devices.wrenches()[1] = push;
    EXPECT_EQ(devices.largest().f, push.f);
    EXPECT_EQ(devices.write(devices.largest()), i < 20) << i;
    EXPECT_EQ(devices.samples()[0].refused, i >= 10);
    EXPECT_EQ(devices.samples()[1].refused, i >= 20);
    EXPECT_EQ(sent[0].wrenches.back().f, pull.f);
    EXPECT_EQ(sent[1].wrenches.back().f, push.f);
  }
  devices.write({});  // what a loop sends where a frame came too late is zero for all
  EXPECT_TRUE(is_zero(sent[0].wrenches.back()) && is_zero(sent[1].wrenches.back()));
}

TEST(TwoDevices, AreAsManyAsThereAreTools) {
  Result<std::unique_ptr<Session>> session =
      Session::open(two_hands(), {.device = "", .other_devices = {"touch", "touch"}, .grip = ""});
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().message().find("more devices"), std::string::npos);
  session = Session::open(two_hands(), {.device = "touch", .other_devices = {"omega.6"}, .grip = ""});
  ASSERT_TRUE(session) << session.error().message();
  EXPECT_NE((*session)->device_of(0).name, (*session)->device_of(1).name);
  Scene scene = two_hands();
  const SceneHand second = scene.other_hands[0];
  session = Session::open_with(std::move(scene), simulated(second));
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().message().find("1 devices"), std::string::npos);
}

/// Two hands press their blocks onto each other: each feels the stretch of its own coupling, and both feel
/// one force. Of a limit that one hand has, the other feels nothing.
TEST(TwoDevices, EachHandFeelsItsOwnCouplingAndLimit) {
  const auto pressed = [](double first_N_per_m, const std::string& second) {
    const Result<Scene> scene =
        parse_scene("schema = 1\ngravity_m_per_s2 = [0, 0, 0]\ncoupling.stiffness_N_per_m = " +
                        std::to_string(first_N_per_m) + R"(
[[body]]
name = "lower"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
[[body]]
name = "upper"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [0, 0, 0.021]
[[tool]]
body = "upper"
[hand]
step = [{ offset_m = [0, 0, -0.004], duration_s = 0.3 }, { hold_s = 1.2 }]
[[tool]]
body = "lower"
)" + second + R"(
[tool.hand]
step = [{ offset_m = [0, 0, 0.004], duration_s = 0.3 }, { hold_s = 1.2 }]
)",
                    "two", "two.toml", {});
    EXPECT_TRUE(scene) << scene.error().message();
    auto session = Session::open(*scene, {});
    EXPECT_TRUE(session) << session.error().message();
    EXPECT_TRUE((*session)->run_virtual(1500, nullptr));
    return std::move(*session);
  };
  for (const double first : {150.0, 400.0})
    for (const double second : {100.0, 250.0, 400.0, 700.0}) {
      const auto session = pressed(first, "coupling.stiffness_N_per_m = " + std::to_string(second));
      const HandReport& one = session->last_report();
      const HandReport& other = session->state().other_reports[0];
      const double force_N = one.coupling.f.norm();
      EXPECT_GT(force_N, 0.2);
      EXPECT_NEAR(other.coupling.f.norm(), force_N, 0.005 * force_N) << first << " " << second;
      EXPECT_NEAR(first * (one.X_WH.p - one.X_WH_proxy.p).norm(), force_N, 0.01 * force_N) << second;
      EXPECT_NEAR(second * (other.X_WH.p - other.X_WH_proxy.p).norm(), force_N, 0.01 * force_N) << first;
    }
  for (const double limit_N : {0.1, 0.2, 0.3}) {
    const auto session = pressed(400.0, "safety.max_force_N = " + std::to_string(limit_N));
    EXPECT_NEAR(session->state().other_reports[0].shown.f.norm(), limit_N, 1e-9);
    EXPECT_GT(session->last_report().shown.f.norm(), 2.0 * limit_N);
  }
}

/// A change while it runs, of whatever setting, leaves every hand the limits of its own.
TEST(TwoDevices, ALiveChangeKeepsTheLimitsOfEachHand) {
  for (const auto& [changed, first_N, second_N] :
       {std::tuple{"coupling.stiffness_N_per_m", 3.0, 1.5}, std::tuple{"safety.max_force_N", 2.0, 1.5}}) {
    Scene scene = two_hands();
    scene.own_safety.max_force_N = 3.0;
    scene.other_hands[0].own_safety.max_force_N = 1.5;
    auto session = Session::open(std::move(scene), {});
    ASSERT_TRUE(session) << session.error().message();
    EXPECT_EQ((*session)->scene().settings.hand(0).safety.max_force_N, 3.0);
    EXPECT_EQ((*session)->scene().settings.hand(1).safety.max_force_N, 1.5);
    SessionCommand set;
    set.kind = SessionCommand::Kind::kSet;
    set.setting = setting_called(changed);
    set.value = 2.0;
    EXPECT_TRUE((*session)->ask(set));
    ASSERT_TRUE((*session)->run_virtual(10, nullptr));
    EXPECT_EQ((*session)->scene().settings.hand(0).safety.max_force_N, first_N) << changed;
    EXPECT_EQ((*session)->scene().settings.hand(1).safety.max_force_N, second_N) << changed;
  }
}

TEST(TwoDevices, EachHandIsLedOnItsOwn) {
  const std::string pointer = "pointer:premium-1.5-6dof";
  for (const std::uint32_t led : {0u, 1u})
    for (const double scale : {1.0, 3.0}) {
      Scene scene = two_hands();
      scene.settings.workspace.scale = 2.0;
      scene.settings.other_hands[0].workspace.scale = scale;
      auto session = Session::open(
          std::move(scene), {.device = pointer, .other_devices = {pointer}, .grip = {}, .rate_Hz = 0.0});
      ASSERT_TRUE(session) << session.error().message();
      EXPECT_TRUE((*session)->can_be_led(0) && (*session)->can_be_led(1));
      EXPECT_FALSE((*session)->can_be_led(2));
      const Vec3 apart = led == 0 ? Vec3(0.004, 0.002, 0.01) : Vec3(-0.004, 0.002, -0.01);
      Lead lead(**session, led, apart);
      ASSERT_TRUE((*session)->run_virtual(1500, &lead));
      const FrameState& state = (*session)->state();
      EXPECT_LT((state.of_hand(led).hand.X_WH.p - lead.to).norm(), 5e-4) << led << ' ' << scale;
      EXPECT_GT((state.of_hand(1 - led).hand.X_WH.p - lead.to).norm(), 0.01);  // goes on by its script
    }
  auto one = Session::open(two_hands(), {.device = pointer, .grip = {}, .rate_Hz = 0.0});
  ASSERT_TRUE(one);
  EXPECT_TRUE((*one)->can_be_led(0));
  EXPECT_FALSE((*one)->can_be_led(1));
  SessionCommand aim;
  aim.kind = SessionCommand::Kind::kAim;
  aim.hand = 7;  // no such hand: nothing happens
  EXPECT_TRUE((*one)->ask(aim));
  EXPECT_TRUE((*one)->run_virtual(10, nullptr));
}

}  // namespace
}  // namespace tactum::two_devices_test
