#include "tactum/session/session.h"

#include <algorithm>
#include <cmath>

#include "tactum/drivers/registry.h"
#include "tactum/haptics/simulation.h"
#include "tactum/scene/build_scene.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kGlances = 4096;  // four seconds at 1 kHz between two polls

void put_goals(const GoalRecord& goals, SessionStatus& status) noexcept {
  for (std::size_t goal = 0; goal < std::min(goals.size(), status.goals.size()); ++goal)
    status.goals[goal] = goals.best(goal);
}

bool is_simulated(const std::string& name) { return name == "simulated" || name.starts_with("simulated:"); }

}  // namespace

Result<std::unique_ptr<Session>> Session::open(Scene scene, const SessionOptions& options) {
  DeviceOptions device_options;
  device_options.hand_motion = scene.hand;
  device_options.grip = options.grip.empty() ? scene.grip : options.grip;
  const std::string name =
      listed_device_name(options.device.empty() ? "simulated:" + scene.device : options.device);
  if (is_simulated(name) && !scene.hand)
    return Error{"the scene has no hand motion for a simulated device", "none", "one, if only a hold",
                 scene.name};
  Result<std::unique_ptr<Device>> device = make_device(name, device_options);
  if (!device) return device.error();
  return open_with(std::move(scene), std::move(*device), options.rate_Hz);
}

Result<std::unique_ptr<Session>> Session::open_with(Scene scene, std::unique_ptr<Device> device,
                                                    double rate_Hz) {
  if (!device) return Error{"the session has no device", "null", "a device", scene.name};
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
  return std::unique_ptr<Session>(new Session(std::move(scene), std::move(device)));
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
      device_limits_(safety_limits(device->info())),
      device_(std::move(device)),
      pointer_(dynamic_cast<PointerDevice*>(device_.get())),
      commands_(kCommands),
      state_(scene_.world, scene_.settings),
      goals_(scene_.world, scene_.goals),
      glances_(kGlances) {
  scene_.settings = settings_for(scene_, device_->info());
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

void Session::obey(const SessionCommand& command) noexcept {
  switch (command.kind) {
    case SessionCommand::Kind::kAim: {
      if (pointer_ == nullptr || !state_.hand.known) return;
      Pose X_DH = relative_pose(state_.hand.X_WD, command.aim());
      X_DH.p /= scene_.settings.workspace.scale;
      pointer_->aim(X_DH, command.buttons);
      return;
    }
    case SessionCommand::Kind::kRest:
      if (pointer_ != nullptr && pointer_->aimed()) pointer_->rest();
      return;
    case SessionCommand::Kind::kSet: {
      set_live(command, device_limits_, scene_.settings, scene_.safety);
      return;
    }
  }
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
  const Wrench F_D = haptic_frame(scene_.world, scene_.settings, sample, felt, state_, report_);
  if (!tick.stop) record_.add(report_, state_.world);
  goals_.watch(scene_.world, state_.world, state_.hand.grasp.body, state_.response.rows());
  if (feed_ != nullptr) feed_->take({report_, state_, scene_.settings}, stage_clock_);
  if (trace_ != nullptr) trace_->take({report_, state_, scene_.settings}, stage_clock_);
  if (listener_ != nullptr)
    listener_->frame_over(sample, felt, {report_, state_, scene_.settings}, stage_clock_);
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
