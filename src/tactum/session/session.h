#pragma once
/// The façade: open a scene and a device, run, watch, stop. One Session is one run.
///
///   Scene + device name --open--> Session --run_virtual()--> or --start(), status(), stop()--> RunRecord,
///   goals
///
/// The loop's thread owns the frame; other threads see it only through a ring of small status records.

#include <atomic>
#include <memory>
#include <string>

#include "tactum/base/spsc_ring.h"
#include "tactum/devices/device.h"
#include "tactum/haptics/frame.h"
#include "tactum/haptics/loop_thread.h"
#include "tactum/scene/scene.h"
#include "tactum/telemetry/run_record.h"
#include "tactum/telemetry/statistics.h"

namespace tactum {

struct SessionOptions {
  std::string device;    ///< as in devices/registry.h; empty: the scene's simulated preset
  std::string grip;      ///< of the simulated hand; empty: the scene's
  double rate_Hz = 0.0;  ///< 0: the scene's [Hz]
};

/// A glance at a running loop.
struct SessionStatus {
  std::uint64_t frame = 0;
  double force_N = 0.0;    ///< shown [N]
  double torque_Nm = 0.0;  ///< shown [N m]
  int contact_points = 0;
  double stretch_m = 0.0;    ///< hand to proxy [m]
  std::uint32_t safety = 0;  ///< safety_flag
};

class Session final : private HapticFrame {
 public:
  /// Makes the device (not yet open) and reserves everything the frames need.
  static Result<std::unique_ptr<Session>> open(Scene scene, const SessionOptions& options);
  ~Session() override { stop(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Runs `frames` frames on the virtual clock, in this thread. `observer` may be null.
  Result<VirtualRun> run_virtual(std::uint64_t frames, LoopObserver* observer);

  /// Starts the loop's thread. It stops by itself after `frames` frames and the ramp that follows; 0: when
  /// told.
  Result<void> start(std::uint64_t frames = 0);
  /// Ramps the wrench to zero, closes the device, ends the thread. Safe to call twice.
  void stop() noexcept { loop_.stop(); }
  LoopStatus loop_status() const noexcept { return loop_.status(); }
  const LoopPrivileges& privileges() const noexcept { return loop_.privileges(); }
  /// Moves what the loop has published since the last call into frame_times(); returns the newest status.
  SessionStatus poll() noexcept;

  const Scene& scene() const noexcept { return scene_; }
  const DeviceInfo& device() const noexcept { return device_->info(); }
  double rate_Hz() const noexcept { return 1.0 / scene_.settings.dt_s; }
  /// Durations of the frames of a threaded run, as far as polled.
  const DurationHistogram& frame_times() const noexcept { return frame_times_; }
  /// After the run (or in an observer of a virtual run).
  const RunRecord& record() const noexcept { return record_; }
  const GoalRecord& goals() const noexcept { return goals_; }
  const FrameReport& last_report() const noexcept { return report_; }
  const FrameState& state() const noexcept { return state_; }
  /// Takes the times of the stages of every frame; set before the run, null for none.
  void time_stages(StageClock* clock) noexcept {
    stage_clock_ = clock;
    state_.observer = clock;
  }

 private:
  Session(Scene scene, std::unique_ptr<Device> device);
  Wrench run(const DeviceSample& sample, const FrameTick& tick) noexcept override;

  Scene scene_;
  std::unique_ptr<Device> device_;
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

}  // namespace tactum
