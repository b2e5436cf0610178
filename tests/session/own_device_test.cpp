#include <gtest/gtest.h>

#include <limits>

#include "support/allocation_guard.h"
#include "tactum/mesh/make_part.h"
#include "tactum/tactum.h"

namespace tactum::own_device_test {
namespace {

/// A device of the caller's: a simulated one that keeps the samples it gave.
class Recorder final : public Device {
 public:
  explicit Recorder(const Scene& scene, std::vector<DeviceSample>& samples)
      : device_(*simulated_device_preset(scene.device), *hand_model(scene.grip), scene.hand),
        samples_(samples) {}
  Result<void> open() override { return device_.open(); }
  void close() noexcept override { device_.close(); }
  const DeviceInfo& info() const noexcept override { return device_.info(); }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    const bool done = device_.read(now_s, sample);
    samples_.push_back(sample);
    return done;
  }
  bool write(const Wrench& F_D) noexcept override { return device_.write(F_D); }

 private:
  SimulatedDevice device_;
  std::vector<DeviceSample>& samples_;
};

constexpr std::uint64_t kFrames = 3000;

TEST(OwnDevice, ASimulationGivesTheFramesOfASessionForTheSameSamples) {
  for (const char* name : {"block-on-plate", "gears"}) {
    const Result<Scene> scene = open_scene(name);
    ASSERT_TRUE(scene);
    Result<std::unique_ptr<Session>> named = Session::open(*scene, SessionOptions{});
    ASSERT_TRUE(named);
    ASSERT_TRUE((*named)->run_virtual(kFrames, nullptr));
    std::vector<DeviceSample> samples;
    Result<std::unique_ptr<Session>> own =
        Session::open_with(*scene, std::make_unique<Recorder>(*scene, samples));
    ASSERT_TRUE(own);
    ASSERT_TRUE((*own)->run_virtual(kFrames, nullptr));
    EXPECT_EQ((*own)->record().hash(), (*named)->record().hash()) << name;

    const auto simulation = Simulation::make(scene->world, (*own)->scene().settings);
    ASSERT_TRUE(simulation);
    ASSERT_GE(samples.size(), kFrames);
    RunRecord record;
    for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
      (*simulation)->step(samples[frame]);
      record.add((*simulation)->report(), (*simulation)->bodies());
    }
    EXPECT_GT(record.grasped_contact_frames, 0u) << name;
    EXPECT_EQ(record.hash(), (*named)->record().hash()) << name;
    EXPECT_EQ((*simulation)->next_index(), kFrames);
  }
}

TEST(OwnDevice, AStepAllocatesNothing) {
  Result<Scene> scene = open_scene("block-on-plate");
  ASSERT_TRUE(scene);
  const auto simulation = Simulation::make(scene->world, scene->settings);
  ASSERT_TRUE(simulation);
  const AllocationGuard guard;
  for (int frame = 0; frame < 200; ++frame)
    (*simulation)->step(Pose{Mat3::Identity(), {0, 0, -1e-4 * frame}});
  EXPECT_EQ(guard.allocations(), 0u);
  EXPECT_GT((*simulation)->report().grasped_contact_points, 0);
}

/// A device whose handle rests at the middle.
class StillDevice final : public Device {
 public:
  StillDevice() {
    info_.name = "still";
    info_.max_force_N = 5.0;
    info_.max_stiffness_N_per_m = 1000.0;
  }
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    sample = {};
    sample.valid = true;
    sample.time_s = now_s;
    return true;
  }
  bool write(const Wrench&) noexcept override { return true; }

 private:
  DeviceInfo info_;
};

TEST(OwnDevice, ASessionNeedsNoHandMotionUnlessItsDeviceIsSimulated) {
  Result<Scene> scene = open_scene("block-on-plate");
  ASSERT_TRUE(scene);
  scene->hand = nullptr;
  EXPECT_EQ(frames_of_motion(*scene), 0);
  const auto simulated = Session::open(*scene, SessionOptions{});
  ASSERT_FALSE(simulated);
  EXPECT_NE(simulated.error().message().find("no hand motion"), std::string::npos);
  const auto own = Session::open_with(*scene, std::make_unique<StillDevice>(), 2000.0);
  ASSERT_TRUE(own) << own.error().message();
  EXPECT_EQ((*own)->device().name, "still");
  EXPECT_NEAR((*own)->rate_Hz(), 2000.0, 1e-9);
  ASSERT_TRUE((*own)->run_virtual(100, nullptr));
  EXPECT_EQ((*own)->record().frames, 100u);
}

TEST(OwnDevice, WhatASessionCannotRunIsTold) {
  Result<Scene> scene = open_scene("block-on-plate");
  ASSERT_TRUE(scene);
  EXPECT_FALSE(Session::open_with(*scene, std::unique_ptr<Device>()));
  EXPECT_FALSE(Session::open_with(*scene, std::make_unique<StillDevice>(), -5.0));
  scene->world.bodies[static_cast<std::size_t>(scene->settings.tool.body)].mass_kg = 0.0;
  const auto session = Session::open_with(*scene, std::make_unique<StillDevice>());
  ASSERT_FALSE(session);
  EXPECT_NE(session.error().message().find("mass"), std::string::npos);
  EXPECT_FALSE(Simulation::make(scene->world, scene->settings));
}

TEST(OwnDevice, WhatAFileSaysOfMaterialsAProgramCanSay) {
  const auto made = part_from_clouds({make_box({0.01, 0.01, 0.01}).vertices});
  ASSERT_TRUE(made);
  const auto part = std::make_shared<const Part>(*made);
  World world;
  for (const char* material : {"steel", "wood", "", "steel"})
    ASSERT_TRUE(world.add({.part = part, .material = material}));
  PairCoefficients friction;
  ASSERT_TRUE(set_coefficient(world, {"wood", "steel", 0.4}, friction));
  ASSERT_TRUE(set_coefficient(world, {"steel", "steel", 0.15}, friction));
  EXPECT_EQ(friction.coefficients,
            (std::vector<double>{0.15, 0.4, 0, 0.15, 0.4, 0, 0, 0.4, 0, 0, 0, 0, 0.15, 0.4, 0, 0.15}));
  const Result<void> unknown = set_coefficient(world, {"steel", "glass", 0.4}, friction);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().where, "material_b");
  EXPECT_FALSE(set_coefficient(world, {"", "steel", 0.4}, friction));
  EXPECT_FALSE(set_coefficient(world, {"wood", "steel", -0.4}, friction));
  EXPECT_EQ(friction.between(0, 1), 0.4) << "an error changes nothing";
  FrameSettings settings;
  settings.friction = friction;
  EXPECT_TRUE(check_world(World{}, {}));
  EXPECT_FALSE(check_world(World{}, settings)) << "the table is of a world of two bodies";
}

/// Adds a force along x.
struct Push final : ForceStage {
  explicit Push(double force) : force_N(force) {}
  Wrench apply(const Wrench& F_D, const DeviceSample&, const FrameReport&) noexcept override {
    Wrench pushed = F_D;
    pushed.f.x() += force_N;
    return pushed;
  }
  double force_N;
};

TEST(OwnForceStage, StandsBeforeSafetyWhichBoundsIt) {
  const auto simulation = Simulation::make(World{}, settings_for(StillDevice().info(), 1000.0));
  ASSERT_TRUE(simulation);
  const auto shown = [&](double force_N) {
    Push push(force_N);
    (*simulation)->set_force_stage(&push);
    Wrench last;
    for (int frame = 0; frame < 1000; ++frame) last = (*simulation)->step(Pose{});
    (*simulation)->set_force_stage(nullptr);
    return last.f.x();
  };
  EXPECT_NEAR(shown(2.0), 2.0, 1e-12);
  EXPECT_NEAR(shown(1000.0), 5.0, 1e-12);
  EXPECT_TRUE((*simulation)->report().safety & safety_flag::kForceLimited);
  EXPECT_EQ(shown(std::numeric_limits<double>::quiet_NaN()), 0.0);
  EXPECT_TRUE((*simulation)->report().safety & safety_flag::kNonFiniteWrench);
}

}  // namespace
}  // namespace tactum::own_device_test
