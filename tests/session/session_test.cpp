#include "tactum/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>

#include "support/allocation_guard.h"
#include "support/effort.h"
#include "support/real_data.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"

namespace tactum::session_test {
namespace {

/// Counts the allocations of frames (and of everything else in the loop).
class AllocationWatch final : public LoopObserver {
 public:
  bool after_frame(const FrameRecord&) noexcept override {
    if (!guard_) {
      guard_.emplace();  // the first frame is over: from here on nothing may allocate
      return true;
    }
    allocations = guard_->allocations();
    return true;
  }
  std::size_t allocations = 0;

 private:
  std::optional<AllocationGuard> guard_;
};

/// Scenes search for meshes in TACTUM_DATA.
void use_real_data_for_scenes() {
  if (!testing::real_data().empty()) setenv("TACTUM_DATA", testing::real_data().c_str(), 0);
}

/// Opens a built-in scene, or reports why its data is not there.
std::unique_ptr<Session> open_session(const std::string& name) {
  Result<Scene> scene = open_scene(name);
  if (!scene) {
    std::printf("scene %s left out: %s\n", name.c_str(), scene.error().message().c_str());
    return nullptr;
  }
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  EXPECT_TRUE(session) << name;
  return session ? std::move(*session) : nullptr;
}

/// Frames of a run of the scene, and whether they are all of its motion. Of scenes of surfaces, whose frames
/// take tens of milliseconds, a long test runs them all; they have tests of their own (real_parts_test.cpp).
/// A sanitized build takes a part of each: it looks for faults of memory.
std::pair<std::uint64_t, bool> frames_to_run(const Scene& scene) {
  const auto& bodies = scene.world.bodies;
  const bool slow = std::any_of(bodies.begin(), bodies.end(),
                                [](const Body& body) { return body.part->surface.triangles.size() > 3000; });
  if (slow && !testing::full_run()) return {testing::effort<std::uint64_t>(300, 60), false};
  if (testing::kSanitized) return {1000, false};
  return {std::max<std::uint64_t>(10000, static_cast<std::uint64_t>(frames_of_motion(scene))), true};
}

class EveryScene : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryScene, RunsWithoutAllocatingTwiceTheSameAndReachesItsGoals) {
  use_real_data_for_scenes();
  const std::unique_ptr<Session> first = open_session(GetParam());
  if (!first) GTEST_SKIP() << "its meshes are not on this machine";
  AllocationWatch watch;
  const auto [frames, whole] = frames_to_run(first->scene());
  ASSERT_TRUE(first->run_virtual(frames, &watch));
  EXPECT_EQ(watch.allocations, 0u);
  EXPECT_EQ(first->record().frames, frames);
  EXPECT_EQ(first->record().non_finite_frames, 0u);
  EXPECT_EQ(first->record().sum("work.uncertified"), 0u);
  EXPECT_EQ(first->record().sum("work.unchecked"), 0u);
  EXPECT_EQ(
      first->record().flags & ~(frame_flag::kLags | frame_flag::kPathUnproven | frame_flag::kSolverBounded),
      0u);
  if (whole) {
    EXPECT_GT(first->record().grasped_contact_frames, frames / 100) << "the hand must have something to feel";
  }
  for (std::size_t i = 0; whole && i < first->scene().goals.size(); ++i)
    EXPECT_TRUE(first->goals().met(i)) << first->goals().describe(first->scene().world, i);
  EXPECT_LE(first->record().max_force_N, first->device().max_force_N);
  EXPECT_LE(first->record().max_torque_Nm, first->device().max_torque_Nm);

  const std::unique_ptr<Session> second = open_session(GetParam());
  ASSERT_TRUE(second->run_virtual(frames, nullptr));
  EXPECT_EQ(second->record().hash(), first->record().hash());
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const SceneEntry& scene :
       list_scenes())  // a sanitized build reads the large meshes in RealParts alone
    if (!testing::kSanitized || (scene.name != "gears-file" && scene.name != "nut-bolt-file"))
      names.push_back(scene.name);
  return names;
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Session, EveryScene, ::testing::ValuesIn(scene_names()), test_name);

TEST(Session, TheDrivenGearPushesBackOnlyWhileTouching) {
  const std::unique_ptr<Session> session = open_session("gears");
  ASSERT_TRUE(session);
  ASSERT_TRUE(session->run_virtual(12499, nullptr));
  const RunRecord& record = session->record();
  EXPECT_GT(record.colliding_frames, 10000u);
  EXPECT_LT(record.colliding_frames, 12499u);  // backlash: not always
  EXPECT_GT(record.max_torque_Nm, 0.005);      // the driven gear's friction is 10 mN m
  EXPECT_LT(record.max_penetration_m, 5e-4);
}

/// A block in the hand pushes on a lever, less than the friction of its hinge.
const char* const kLever = R"(
schema = 1
description = "lever with friction pushed below its friction"
[[body]]
name = "lever"
part = { box = { size_m = [0.1,0.02,0.01] } }
joint = { kind = "hinge", axis = [0,1,0], anchor_m=[-0.05,0,0], friction_Nm = 0.5 }
[[body]]
name = "block"
part = { box = { size_m = [0.01,0.01,0.01] } }
pos_m = [0.045,0,0.0105]
[tool]
body = "block"
[hand]
grip = "firm"
[[hand.step]]
offset_m = [0,0,-0.004]
duration_s = 0.5
[[hand.step]]
hold_s = 5
[[goal]]
kind = "turned"
body = "lever"
at_least_deg = 0.1
[[goal]]
kind = "moved"
body = "block"
direction = [0,0,-1]
at_least_m = 0.001
)";

TEST(Session, APushBelowTheFrictionOfAHingeMovesNothing) {
  Result<Scene> scene = parse_scene(kLever, "lever", "lever.toml", {});
  ASSERT_TRUE(scene) << scene.error().message();
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  ASSERT_TRUE(session);
  ASSERT_TRUE((*session)->run_virtual(4000, nullptr));
  EXPECT_GT((*session)->record().max_force_N, 0.4);
  EXPECT_GT((*session)->record().grasped_contact_frames, 3000u);
  for (std::size_t i = 0; i < (*session)->scene().world.bodies.size(); ++i) {
    EXPECT_LT(std::abs((*session)->goals().angle(i)), 1e-6) << (*session)->scene().world.bodies[i].name;
  }
}

TEST(SessionThread, RunsOnItsOwnThreadAndStopsWithZeroWrench) {
  const std::unique_ptr<Session> session = open_session("gears");
  ASSERT_TRUE(session);
  ASSERT_TRUE(session->start());
  while (session->loop_status().running && session->loop_status().frames < 200) {
    session->poll();
    std::this_thread::yield();
  }
  session->stop();
  session->poll();
  EXPECT_GE(session->record().frames, 200u);
  EXPECT_TRUE(is_zero(session->last_report().shown));
  EXPECT_GE(session->frame_times().count(), 200u);
  session->stop();  // twice is harmless
}

TEST(SessionThread, RunsAsManyFramesAsAskedForAndThenTheRamp) {
  const std::unique_ptr<Session> session = open_session("block-on-plate");
  ASSERT_TRUE(session);
  ASSERT_TRUE(session->start(150));
  while (session->loop_status().running) std::this_thread::yield();
  session->stop();
  EXPECT_EQ(session->record().frames, 150u);  // the ramp's frames are not the scene's
  EXPECT_TRUE(is_zero(session->last_report().shown));
}

TEST(Session, AnUnknownDeviceIsToldBeforeAnythingRuns) {
  Result<Scene> scene = open_scene("gears");
  ASSERT_TRUE(scene);
  const auto session =
      Session::open(std::move(*scene), {.device = "phantom-of-the-opera", .grip = "", .rate_Hz = 0.0});
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().message().find("simulated"), std::string::npos);
}

TEST(Session, ASceneWithoutACouplingGetsThatOfItsDeviceAndRate) {
  const auto opened = [](const std::string& device, double rate_Hz, const std::string& coupling) {
    Result<Scene> scene = parse_scene(R"(
schema = 1
[[body]]
name = "block"
part = { box = { size_m = [0.04, 0.03, 0.02] } }
density_kg_per_m3 = 1000
[tool]
body = "block"
)" + coupling,
                                      "block", "block.toml", {});
    EXPECT_TRUE(scene) << scene.error().message();
    return Session::open(std::move(*scene),
                         {.device = "simulated:" + device, .grip = {}, .rate_Hz = rate_Hz});
  };
  for (const char* device : {"premium-1.5-6dof", "touch", "sigma.7", "virtuose-6d"})
    for (const double rate_Hz : {1000.0, 4000.0}) {
      const auto session = opened(device, rate_Hz, "");
      ASSERT_TRUE(session);
      const Coupling& chosen = (*session)->scene().settings.coupling;
      const CouplingGains gains = coupling_gains((*session)->device(), rate_Hz);
      EXPECT_EQ(chosen.stiffness_N_per_m, gains.coupling.stiffness_N_per_m) << device;
      EXPECT_EQ(chosen.damping_Nms_per_rad, gains.coupling.damping_Nms_per_rad) << device;
      EXPECT_LE(chosen.stiffness_N_per_m, gains.translation.loose_hand) << device;
    }
  const auto given = opened("sigma.7", 1000.0, "[coupling]\nstiffness_N_per_m = 432\n");
  ASSERT_TRUE(given);
  EXPECT_EQ((*given)->scene().settings.coupling.stiffness_N_per_m, 432.0);
}

TEST(Session, WithTheChosenCouplingEveryDeviceReachesTheGoalsOfTheBlock) {
  for (const char* device : {"premium-1.5-6dof", "touch", "omega.6", "sigma.7", "virtuose-6d"}) {
    Result<Scene> scene = open_scene("block-on-plate");
    ASSERT_TRUE(scene);
    scene->settings.response = ResponseModel::kConstraint;
    scene->coupling_by_device = true;
    const auto frames = static_cast<std::uint64_t>(frames_of_motion(*scene));
    auto session = Session::open(std::move(*scene),
                                 {.device = std::string("simulated:") + device, .grip = {}, .rate_Hz = 0.0});
    ASSERT_TRUE(session);
    ASSERT_TRUE((*session)->run_virtual(frames, nullptr));
    EXPECT_TRUE((*session)->goals().all_met()) << device;
    EXPECT_EQ((*session)->record().penetrating_frames, 0u) << device;
    EXPECT_EQ((*session)->record().flags & ~(frame_flag::kLags | frame_flag::kPathUnproven), 0u) << device;
  }
}

/// Asks for another stiffness while the hand presses.
class StiffnessChange final : public LoopObserver {
 public:
  StiffnessChange(Session& session, double to_N_per_m) : session_(session), to_N_per_m_(to_N_per_m) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    const FrameReport& report = session_.last_report();
    if (record.tick.index == 2500) {
      pressed_N = report.shown.f.norm();
      SessionCommand command;
      command.kind = SessionCommand::Kind::kSet;
      command.setting = setting_called("coupling.stiffness_N_per_m");
      command.value = to_N_per_m_;
      asked = session_.ask(command);
    }
    least_share = std::min(least_share, report.port.stiffness_share);
    return true;
  }
  double pressed_N = 0.0, least_share = 1.0;
  bool asked = false;

 private:
  Session& session_;
  double to_N_per_m_;
};

TEST(Session, AStifferCouplingThatIsAskedForWhilePressedIsNotTakenForGeneratedEnergy) {
  for (const double to_N_per_m : {4000.0, 200.0}) {
    Result<Scene> scene = open_scene("block-on-plate");
    ASSERT_TRUE(scene);
    auto session = Session::open(std::move(*scene), {});
    ASSERT_TRUE(session);
    StiffnessChange change(**session, to_N_per_m);
    ASSERT_TRUE((*session)->run_virtual(3000, &change));
    EXPECT_TRUE(change.asked);
    EXPECT_GT(change.pressed_N, 0.5);
    EXPECT_EQ(change.least_share, 1.0);
    EXPECT_EQ((*session)->scene().settings.coupling.stiffness_N_per_m, to_N_per_m);
  }
}

}  // namespace
}  // namespace tactum::session_test
