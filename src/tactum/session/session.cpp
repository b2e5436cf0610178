#include "tactum/session/session.h"

#include "tactum/devices/registry.h"

namespace tactum {
namespace {

constexpr std::size_t kGlances = 4096;  // four seconds at 1 kHz between two polls

}  // namespace

Result<std::unique_ptr<Session>> Session::open(Scene scene, const SessionOptions& options) {
  DeviceOptions device_options;
  device_options.hand_motion = scene.hand;
  device_options.grip = options.grip.empty() ? scene.grip : options.grip;
  const std::string name = options.device.empty() ? "simulated:" + scene.device : options.device;
  Result<std::unique_ptr<Device>> device = make_device(name, device_options);
  if (!device) return device.error();
  if (options.rate_Hz != 0.0) {
    if (Result<void> rate = check_rate(options.rate_Hz); !rate) return rate.error();
    scene.settings.dt_s = 1.0 / options.rate_Hz;
  }
  scene.settings.safety = tightened(safety_limits((*device)->info()), scene.safety);
  return std::unique_ptr<Session>(new Session(std::move(scene), std::move(*device)));
}

Session::Session(Scene scene, std::unique_ptr<Device> device)
    : scene_(std::move(scene)),
      device_(std::move(device)),
      state_(scene_.world, scene_.settings),
      goals_(scene_.world, scene_.goals),
      glances_(kGlances) {}

Result<VirtualRun> Session::run_virtual(std::uint64_t frames, LoopObserver* observer) {
  return tactum::run_virtual(*device_, *this, rate_Hz(), frames, observer);
}

Result<void> Session::start() {
  LoopSettings settings;
  settings.rate_Hz = rate_Hz();
  Result<void> started = loop_.start(*device_, *this, settings);
  threaded_ = static_cast<bool>(started);
  return started;
}

SessionStatus Session::poll() noexcept {
  while (glances_.pop(newest_)) {
  }
  if (!threaded_) return newest_;  // the observer of a virtual run has the times
  for (FrameTiming timing; loop_.timings().pop(timing);)
    frame_times_.add(static_cast<std::int64_t>(timing.frame_time_s * 1e9));
  return newest_;
}

Wrench Session::run(const DeviceSample& sample, const FrameTick& tick) noexcept {
  if (stage_clock_ != nullptr) stage_clock_->frame_begins();
  const Wrench F_D = haptic_frame(scene_.world, scene_.settings, sample, tick, state_, report_);
  record_.add(report_);
  goals_.watch(scene_.world, state_.world);
  // A full ring means nobody has looked for seconds: the newest glance is then lost, the frame is not.
  glances_.push({report_.index, report_.shown.f.norm(), report_.shown.t.norm(), report_.contact_points,
                 (report_.X_WH_proxy.p - report_.X_WH.p).norm(), report_.safety});
  return F_D;
}

}  // namespace tactum
