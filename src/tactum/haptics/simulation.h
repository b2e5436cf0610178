#pragma once
/// A world and its settings, stepped frame by frame, for a program without a scene file.
///
///   World world;                                                 bodies, by World::add
///   FrameSettings settings = settings_for(device.info(), 1000.0);
///   settings.tool.body = 0;                                      which body the hand holds
///   settings.other_hands.push_back(...);                         a second hand, where there is one
///   auto simulation = Simulation::make(std::move(world), settings);
///   (*simulation)->step(sample)  ->  wrench                      in a loop of the caller's, or
///   LoopThread().start(device, **simulation, ...)                in the loop of this library
///
/// A frame is haptic_frame (frame.h): it allocates nothing, locks nothing, throws nothing and reads no clock,
/// and the same samples give the same bits.

#include <memory>
#include <string_view>

#include "tactum/haptics/frame.h"

namespace tactum::inline v0_1 {

/// An error when the world cannot be stepped: a body without a part, a pose that is not finite, a moving body
/// without mass or inertia, a tool that holds no body of the world, a step that is not positive.
Result<void> check_world(const World& world, const FrameSettings& settings);

/// The default settings with those that depend on the device: the step, the limits of safety, the device's
/// properties for the passivity stage, and the stiffest coupling that is stable on it. Without these limits
/// no force is sent.
FrameSettings settings_for(const DeviceInfo& info, double rate_Hz);

class Simulation final : public HapticFrame {
 public:
  /// Takes world and settings, and reserves everything the frames need. Slow; allocates.
  static Result<std::unique_ptr<Simulation>> make(World world, FrameSettings settings);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// One frame, FrameSettings::dt_s after the last. The sample counts as measured now, whatever its time.
  /// Returns the wrench on the hand, axes of D, at the handle [N, N m].
  Wrench step(const DeviceSample& sample) noexcept;
  /// The same when only the pose of the handle is known.
  Wrench step(const Pose& X_DH) noexcept;
  /// The same with several hands: a sample and a wrench for each hand of the settings.
  void step(std::span<const HandSample> samples, std::span<Wrench> wrenches) noexcept;
  /// The same with the loop's own index and time; the sample's time is then on the loop's clock.
  Wrench run(const DeviceSample& sample, const FrameTick& tick) noexcept override;
  void run(std::span<const HandSample> samples, const FrameTick& tick, std::span<Wrench> wrenches) noexcept;

  const World& world() const noexcept { return world_; }
  /// Between two frames the caller may change what setting_table.h calls live, and the budget.
  FrameSettings& settings() noexcept { return settings_; }
  const FrameSettings& settings() const noexcept { return settings_; }
  /// The poses and velocities of the bodies.
  const WorldState& bodies() const noexcept { return state_.world; }
  const FrameState& state() const noexcept { return state_; }
  /// Of the last frame.
  const FrameReport& report() const noexcept { return report_; }
  /// Of the next frame: frames since the start, and the time it is at [s].
  std::uint64_t next_index() const noexcept { return next_index_; }
  double time_s() const noexcept { return static_cast<double>(next_index_) * settings_.dt_s; }

  /// Goes on from a snapshot (frame_snapshot.h) of a simulation of the same world and settings: the next
  /// frame is number `next_index`. After an error nothing can be stepped any more.
  Result<void> restore(std::string_view snapshot, std::uint64_t next_index);

  /// Puts a stage of the caller's before passivity and safety; null for none. It must outlive the frames.
  void set_force_stage(ForceStage* stage) noexcept { state_.force_stage = stage; }

 private:
  Simulation(World world, FrameSettings settings);

  World world_;
  FrameSettings settings_;
  FrameState state_;
  FrameReport report_;
  std::uint64_t next_index_ = 0;
};

}  // namespace tactum::inline v0_1
