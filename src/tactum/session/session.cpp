#include "tactum/session/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactum/drivers/registry.h"
#include "tactum/haptics/simulation.h"
#include "tactum/scene/build_scene.h"
#include "tactum/session/device_profile.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kGlances = 4096;  // four seconds at 1 kHz between two polls

void put_goals(const GoalRecord& goals, SessionStatus& status) noexcept {
  for (std::size_t goal = 0; goal < std::min(goals.size(), status.goals.size()); ++goal)
    status.goals[goal] = goals.best(goal);
}

/// The devices of a session that has one for each hand.
std::unique_ptr<Device> joined(std::vector<std::unique_ptr<Device>> devices) {
  if (devices.size() == 1) return std::move(devices.front());
  return std::make_unique<HandDevices>(std::move(devices));
}

/// The settings of the scene on its devices.
FrameSettings settings_on(const Scene& scene, const Device& device, const HandDevices* several) {
  if (several == nullptr) return settings_for(scene, device.info());
  std::vector<DeviceInfo> infos;
  for (std::size_t h = 0; h < several->hands(); ++h) infos.push_back(several->device(h).info());
  return settings_for(scene, infos);
}

bool is_simulated(const std::string& name) { return name == "simulated" || name.starts_with("simulated:"); }

}  // namespace

Result<std::unique_ptr<Session>> Session::open(Scene scene, const SessionOptions& options) {
  if (options.other_devices.size() > scene.other_hands.size())
    return Error{"more devices than the scene has hands", std::to_string(1 + options.other_devices.size()),
                 "at most " + std::to_string(1 + scene.other_hands.size()), scene.name};
  std::vector<std::unique_ptr<Device>> devices;
  const auto add = [&](const std::string& asked, const SceneHand& hand) -> Result<void> {
    DeviceOptions device_options;
    device_options.hand_motion = hand.hand;
    device_options.grip = options.grip.empty() ? hand.grip : options.grip;
    const std::string name = listed_device_name(asked.empty() ? "simulated:" + hand.device : asked);
    if (is_simulated(name) && !hand.hand)
      return Error{"the scene has no hand motion for a simulated device", "none", "one, if only a hold",
                   scene.name};
    Result<std::unique_ptr<Device>> device = make_device(name, device_options);
    if (!device) return device.error();
    Result<std::unique_ptr<Device>> known = profiled(std::move(*device));
    if (!known) return known.error();
    devices.push_back(std::move(*known));
    return {};
  };
  if (Result<void> added = add(options.device, scene); !added) return added.error();
  for (std::size_t i = 0; i < scene.other_hands.size(); ++i) {
    const std::string asked = i < options.other_devices.size() ? options.other_devices[i] : "";
    if (Result<void> added = add(asked, scene.other_hands[i]); !added) return added.error();
  }
  return open_with(std::move(scene), std::move(devices), options.rate_Hz);
}

Result<std::unique_ptr<Session>> Session::open_with(Scene scene, std::unique_ptr<Device> device,
                                                    double rate_Hz) {
  std::vector<std::unique_ptr<Device>> devices;
  devices.push_back(std::move(device));
  return open_with(std::move(scene), std::move(devices), rate_Hz);
}

Result<std::unique_ptr<Session>> Session::open_with(Scene scene, std::vector<std::unique_ptr<Device>> devices,
                                                    double rate_Hz) {
  for (const std::unique_ptr<Device>& device : devices)
    if (!device) return Error{"the session has no device", "null", "a device", scene.name};
  if (devices.size() != scene.settings.hands())
    return Error{"the scene has another number of hands than there are devices",
                 std::to_string(devices.size()) + " devices", std::to_string(scene.settings.hands()),
                 scene.name};
  if (rate_Hz != 0.0) {
    if (Result<void> rate = check_rate(rate_Hz); !rate) return rate.error();
    scene.settings.dt_s = 1.0 / rate_Hz;
  }
  // Scene files exclude these errors; programs that build a scene of their own can make them.
  if (Result<void> sound = check_world(scene.world, scene.settings); !sound) {
    Error error = sound.error();
    if (error.where.empty()) error.where = scene.name;
    return error;
  }
  return std::unique_ptr<Session>(new Session(std::move(scene), joined(std::move(devices))));
}

Result<std::unique_ptr<Session>> Session::open(const SceneDescription& scene, const SessionOptions& options) {
  Result<Scene> built = build_scene(scene);
  if (!built) return built.error();
  return open(std::move(*built), options);
}

Result<std::unique_ptr<Session>> Session::open_with(const SceneDescription& scene,
                                                    std::unique_ptr<Device> device, double rate_Hz) {
  Result<Scene> built = build_scene(scene);
  if (!built) return built.error();
  return open_with(std::move(*built), std::move(device), rate_Hz);
}

Session::Session(Scene scene, std::unique_ptr<Device> device)
    : scene_(std::move(scene)),
      device_(std::move(device)),
      several_(dynamic_cast<HandDevices*>(device_.get())),
      commands_(kCommands),
      state_(scene_.world, scene_.settings),
      record_(scene_.settings.hands()),
      goals_(scene_.world, scene_.goals),
      glances_(kGlances) {
  scene_.settings = settings_on(scene_, *device_, several_);
  for (std::size_t h = 0; h < hands(); ++h) {
    device_limits_.push_back(device_limits(scene_, h, device_of(h)));
    pointers_.push_back(
        dynamic_cast<PointerDevice*>(several_ != nullptr ? &several_->device(h) : device_.get()));
  }
  put_goals(goals_, newest_);
}

Result<VirtualRun> Session::run_virtual(std::uint64_t frames, LoopObserver* observer) {
  return tactum::run_virtual(*device_, *this, rate_Hz(), frames, observer);
}

Result<void> Session::start(std::uint64_t frames) {
  LoopSettings settings;
  settings.rate_Hz = rate_Hz();
  settings.frames = frames;
  Result<void> started = loop_.start(*device_, *this, settings);
  threaded_ = static_cast<bool>(started);
  return started;
}

SessionStatus Session::poll(std::vector<FrameTiming>* timings) {
  while (glances_.pop(newest_)) {
  }
  if (!threaded_) return newest_;  // the observer of a virtual run has the times
  for (FrameTiming timing; loop_.timings().pop(timing);) {
    frame_times_.add(static_cast<std::int64_t>(timing.frame_time_s * 1e9));
    if (timings != nullptr) timings->push_back(timing);
  }
  return newest_;
}

/// The pose is in the world; the device wants it in its own frame, at its own scale.
void Session::aim(const SessionCommand& command) noexcept {
  const HandStage& hand = state_.of_hand(command.hand).hand;
  if (!hand.known) return;
  Pose X_DH = relative_pose(hand.X_WD, command.aim());
  X_DH.p /= scene_.settings.hand(command.hand).workspace.scale;
  pointers_[command.hand]->aim(X_DH, command.buttons);
}

void Session::obey(const SessionCommand& command) noexcept {
  switch (command.kind) {
    case SessionCommand::Kind::kAim:
      if (can_be_led(command.hand)) aim(command);
      return;
    case SessionCommand::Kind::kRest:
      if (can_be_led(command.hand) && pointers_[command.hand]->aimed()) pointers_[command.hand]->rest();
      return;
    case SessionCommand::Kind::kSet:
      set_live(command, device_limits_, scene_.settings, scene_.safety);
      return;
  }
}

/// Every hand may touch and pick what the goals name.
void Session::watch_goals() noexcept {
  for (std::size_t h = 0; h < hands(); ++h)
    goals_.watch(scene_.world, state_.world, state_.of_hand(h).hand.grasp.body, state_.response.rows());
}

Wrench Session::run_frame(const DeviceSample& sample, const FrameTick& tick) noexcept {
  if (several_ == nullptr) return haptic_frame(scene_.world, scene_.settings, sample, tick, state_, report_);
  haptic_frame(scene_.world, scene_.settings, several_->samples(), tick, state_, report_,
               several_->wrenches());
  return several_->largest();
}

/// Tells the listener of a frame that is over. Where there are several hands, each has a device that may
/// refuse its wrench.
void Session::report_over(const DeviceSample& sample, FrameTick tick) noexcept {
  std::span<const HandSample> others;
  if (several_ != nullptr) {
    tick.refused = several_->samples().front().refused;
    others = several_->samples().subspan(1);
  }
  listener_->frame_over(sample, tick, others, {report_, state_, scene_.settings}, stage_clock_);
}

Wrench Session::run(const DeviceSample& sample, const FrameTick& tick) noexcept {
  SessionCommand command;  // no more than fit in, however fast another thread sends
  for (std::size_t n = 0; n < kCommands && commands_.pop(command); ++n) {
    obey(command);
    if (listener_ != nullptr) listener_->obeyed(tick.index, command);
  }
  FrameTick felt = tick;
  felt.stop = tick.stop || wrench_at_zero_.load(std::memory_order_relaxed) ||
              (stop_asked_ != nullptr && stop_asked_->load(std::memory_order_relaxed));
  if (stage_clock_ != nullptr) stage_clock_->frame_begins();
  const Wrench F_D = run_frame(sample, felt);
  if (!tick.stop) record_.add(report_, state_.world, state_.other_reports);
  watch_goals();
  if (feed_ != nullptr) feed_->take({report_, state_, scene_.settings}, stage_clock_);
  if (trace_ != nullptr) trace_->take({report_, state_, scene_.settings}, stage_clock_);
  if (listener_ != nullptr) report_over(sample, felt);
  SessionStatus glance{report_.index,
                       report_.shown.f.norm(),
                       report_.shown.t.norm(),
                       report_.contact_points,
                       (report_.X_WH_proxy.p - report_.X_WH.p).norm(),
                       report_.safety,
                       {}};
  put_goals(goals_, glance);
  // A full ring means that nothing was polled for seconds: the newest glance is then lost, the frame is not.
  glances_.push(glance);
  return F_D;
}

}  // namespace tactum::inline v0_1
