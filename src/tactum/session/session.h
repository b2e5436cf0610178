#pragma once
/// The façade: open a scene and a device, run, watch, stop. One Session is one run.
///
///   Scene (or its description) + device or its name --open, open_with--> Session --run_virtual()--> or
///   --start(), poll(), stop()--> RunRecord, goals
///
/// The loop's thread owns the frame; other threads see it only through rings of small records, and request
/// changes through another (command.h), which the loop empties between two frames.

#include <array>
#include <atomic>
#include <memory>
#include <string>

#include "tactum/base/spsc_ring.h"
#include "tactum/devices/device.h"
#include "tactum/devices/pointer_device.h"
#include "tactum/haptics/frame.h"
#include "tactum/loop/loop_thread.h"
#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"
#include "tactum/session/command.h"
#include "tactum/session/hand_devices.h"
#include "tactum/session/run_listener.h"
#include "tactum/telemetry/frame_feed.h"
#include "tactum/telemetry/run_record.h"
#include "tactum/telemetry/statistics.h"
#include "tactum/telemetry/trace.h"

namespace tactum::inline v0_1 {

struct SessionOptions {
  std::string device;  ///< as in drivers/registry.h; empty: the scene's simulated preset
  /// The same of the second hand and all after it; those that are missing count as empty.
  std::vector<std::string> other_devices = {};
  std::string grip;      ///< of the simulated hand; empty: the scene's
  double rate_Hz = 0.0;  ///< 0: the scene's [Hz]
};

/// A glance at a running loop.
struct SessionStatus {
  std::uint64_t frame = 0;
  double force_N = 0.0;    ///< shown [N]
  double torque_Nm = 0.0;  ///< shown [N m]
  int contact_points = 0;
  double stretch_m = 0.0;    ///< probe to proxy [m]
  std::uint32_t safety = 0;  ///< safety_flag
  /// The numbers that decide the scene's first goals (GoalRecord::best).
  static constexpr std::size_t kGoals = 32;
  std::array<double, kGoals> goals{};
};

class Session final : private HapticFrame {
 public:
  /// Makes the device (not yet open) and reserves everything the frames need. The scene must have a hand
  /// motion when the device is simulated.
  static Result<std::unique_ptr<Session>> open(Scene scene, const SessionOptions& options);
  /// The same with a device of the caller's (not yet open); the scene needs no hand motion. `rate_Hz` 0: the
  /// scene's [Hz].
  static Result<std::unique_ptr<Session>> open_with(Scene scene, std::unique_ptr<Device> device,
                                                    double rate_Hz = 0.0);
  /// The same of a scene with several hands: the device of each.
  static Result<std::unique_ptr<Session>> open_with(Scene scene, std::vector<std::unique_ptr<Device>> devices,
                                                    double rate_Hz = 0.0);
  /// The same of a description, which is built first (build_scene.h).
  static Result<std::unique_ptr<Session>> open(const SceneDescription& scene, const SessionOptions& options);
  static Result<std::unique_ptr<Session>> open_with(const SceneDescription& scene,
                                                    std::unique_ptr<Device> device, double rate_Hz = 0.0);
  ~Session() override { stop(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Runs `frames` frames on the virtual clock, in this thread. `observer` may be null.
  Result<VirtualRun> run_virtual(std::uint64_t frames, LoopObserver* observer);

  /// Starts the loop's thread. It stops by itself after `frames` frames and the ramp that follows; 0: when
  /// stopped.
  Result<void> start(std::uint64_t frames = 0);
  /// Ramps the wrench to zero, closes the device, ends the thread. Safe to call twice.
  void stop() noexcept { loop_.stop(); }
  LoopStatus loop_status() const noexcept { return loop_.status(); }
  const LoopPrivileges& privileges() const noexcept { return loop_.privileges(); }
  /// Moves the records that the loop has published since the last call into frame_times(), and behind
  /// `timings` when that is given; returns the newest status.
  SessionStatus poll(std::vector<FrameTiming>* timings = nullptr);

  // Requests of one other thread to a running session.
  /// Carried out before the next frame; false when so many are waiting that this one was not taken.
  bool ask(const SessionCommand& command) noexcept { return commands_.push(command); }
  /// The big stop: the wrench is led to zero within the stop ramp and stays there, while frames go on, until
  /// taken back; the force then returns by the start ramp.
  void hold_wrench_at_zero(bool on) noexcept { wrench_at_zero_.store(on, std::memory_order_relaxed); }
  /// The same from any thread, while `asked` is true; set before the run, null for none. It must outlive the
  /// session.
  void stop_while(const std::atomic<bool>* asked) noexcept { stop_asked_ = asked; }
  /// Whether a hand, counted from 0, can be led by SessionCommand::kAim.
  bool can_be_led(std::size_t hand = 0) const noexcept {
    return hand < pointers_.size() && pointers_[hand] != nullptr;
  }

  const Scene& scene() const noexcept { return scene_; }
  /// Of the first hand's device.
  const DeviceInfo& device() const noexcept { return device_->info(); }
  std::size_t hands() const noexcept { return scene_.settings.hands(); }
  /// Of a hand's device, counted from 0.
  const DeviceInfo& device_of(std::size_t hand) const noexcept {
    return several_ == nullptr ? device_->info() : several_->device(hand).info();
  }
  /// What the device says is wrong with it, with the cure; empty for nothing. While no run is going on.
  std::string device_trouble() const { return device_->trouble(); }
  double rate_Hz() const noexcept { return 1.0 / scene_.settings.dt_s; }
  /// Durations of the frames of a threaded run, as far as polled.
  const DurationHistogram& frame_times() const noexcept { return frame_times_; }
  /// After the run (or in an observer of a virtual run).
  const RunRecord& record() const noexcept { return record_; }
  const GoalRecord& goals() const noexcept { return goals_; }
  const FrameReport& last_report() const noexcept { return report_; }
  const FrameState& state() const noexcept { return state_; }
  /// Shows every frame to `feed`; set before the run, null for none.
  void show_to(FrameFeed* feed) noexcept { feed_ = feed; }
  /// Traces every frame; set before the run, null for none.
  void trace_to(FrameTrace* trace) noexcept { trace_ = trace; }
  /// Reports everything to `listener`; set before the run, null for none.
  void report_to(RunListener* listener) noexcept { listener_ = listener; }
  /// Puts a stage of the caller's before passivity and safety; set before the run, null for none.
  void set_force_stage(ForceStage* stage) noexcept { state_.force_stage = stage; }
  /// Takes the times of the stages of every frame; set before the run, null for none.
  void time_stages(StageClock* clock) noexcept {
    stage_clock_ = clock;
    state_.observer = clock;
  }

 private:
  Session(Scene scene, std::unique_ptr<Device> device);
  Wrench run(const DeviceSample& sample, const FrameTick& tick) noexcept override;
  Wrench run_frame(const DeviceSample& sample, const FrameTick& tick) noexcept;
  void report_over(const DeviceSample& sample, FrameTick tick) noexcept;
  void watch_goals() noexcept;
  void obey(const SessionCommand& command) noexcept;
  void aim(const SessionCommand& command) noexcept;

  static constexpr std::size_t kCommands = 256;

  Scene scene_;
  std::vector<SafetyLimits> device_limits_;  // by hand; scene_.safety tightens them
  std::unique_ptr<Device> device_;
  HandDevices* several_;                  // the device, when it is those of several hands
  std::vector<PointerDevice*> pointers_;  // by hand: its device, when it is one that can be led, or null
  SpscRing<SessionCommand> commands_;
  std::atomic<bool> wrench_at_zero_{false};
  const std::atomic<bool>* stop_asked_ = nullptr;
  FrameFeed* feed_ = nullptr;
  FrameTrace* trace_ = nullptr;
  RunListener* listener_ = nullptr;
  FrameState state_;
  StageClock* stage_clock_ = nullptr;
  FrameReport report_;
  RunRecord record_;
  GoalRecord goals_;
  SpscRing<SessionStatus> glances_;
  SessionStatus newest_;
  DurationHistogram frame_times_;
  LoopThread loop_;
  bool threaded_ = false;  // the loop has been started, so its timings exist
};

}  // namespace tactum::inline v0_1
