#include "viewer/server/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tactum/drivers/registry.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum {
namespace {

using namespace std::chrono_literals;

constexpr auto kShowEvery = 15ms;  // a little under a screen's period, so that none is missed
constexpr auto kStatusEvery = 500ms;
constexpr std::uint64_t kVirtualFramesAtOnce = 16;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// The setting that a request names; null when there is none.
const SettingInfo* setting_of(const Request& request) {
  const int index = setting_called(request.key);
  return index < 0 ? nullptr : &setting_table()[static_cast<std::size_t>(index)];
}

bool same_coupling(const FrameSettings& a, const FrameSettings& b) {
  return std::ranges::all_of(setting_table(), [&](const SettingInfo& setting) {
    return std::string_view(setting.section) != "coupling" || setting.get(a, {}) == setting.get(b, {});
  });
}

/// The recording that is open: its file, frames, and how many are missing. Null: none is.
nlohmann::ordered_json recording_json(const RunRecording& recording) {
  if (!recording.on()) return nullptr;
  const RecordingFile file = recording.files().back();
  return {{"file", file.path}, {"frames", file.frames}, {"dropped", file.dropped}};
}

/// The scene's goals and how far they are.
nlohmann::ordered_json goals_json(const Scene& scene, const SessionStatus& newest) {
  nlohmann::ordered_json goals = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < std::min(scene.goals.size(), newest.goals.size()); ++i) {
    const double best = newest.goals[i];
    goals.push_back(
        {{"met", is_met(scene.goals[i], best)}, {"text", describe_goal(scene.world, scene.goals[i], best)}});
  }
  return goals;
}

/// Hands for which no device is named are led from the pages.
void lead_by_pages(const Scene& scene, SessionOptions& options) {
  if (options.device.empty()) options.device = "pointer:" + scene.device;
  options.other_devices.resize(scene.other_hands.size());
  for (std::size_t i = 0; i < scene.other_hands.size(); ++i)
    if (options.other_devices[i].empty()) options.other_devices[i] = "pointer:" + scene.other_hands[i].device;
}

}  // namespace

Result<std::unique_ptr<Viewer>> Viewer::open(Scene scene, SessionOptions options, int port,
                                             std::vector<SceneRemark> remarks,
                                             std::optional<SceneDescription> description) {
  lead_by_pages(scene, options);
  if (options.grip.empty()) options.grip = scene.grip;
  Result<std::unique_ptr<Server>> server = Server::start(port);
  if (!server) return server.error();
  std::unique_ptr<Viewer> viewer(new Viewer(std::move(scene), std::move(options), std::move(*server),
                                            std::move(remarks), std::move(description)));
  if (Result<void> begun = viewer->begin_run(); !begun) return begun.error();
  return viewer;
}

Viewer::Viewer(Scene scene, SessionOptions options, std::unique_ptr<Server> server,
               std::vector<SceneRemark> remarks, std::optional<SceneDescription> description)
    : scene_(std::move(scene)),
      remarks_(std::move(remarks)),
      description_(std::move(description)),
      options_(std::move(options)),
      server_(std::move(server)) {
  if (options_.rate_Hz > 0.0) scene_.settings.dt_s = 1.0 / options_.rate_Hz;
  options_.rate_Hz = 0.0;  // from here on a setting like any other
  remember_usual();
}

void Viewer::remember_usual() {
  usual_ = {scene_.settings, scene_.safety};
  device_chooses_ = scene_.coupling_by_device;
  if (const SettingsDescription* const before = scene_.before_changes.get()) {
    usual_ = {before->frame, before->safety};
    device_chooses_ = before->coupling_by_device;
  }
}

ShownSettings Viewer::shown_settings() const {
  return {{scene_.settings, scene_.safety}, usual_, scene_.coupling_by_device, device_chooses_};
}

std::string Viewer::message_of_run() const {
  return run_message(shown_scene(*session_), shown_settings(),
                     {run_, options_.device, options_.grip, true, remarks_, {}});
}

Result<void> Viewer::begin_run() {
  Result<std::unique_ptr<Session>> session = Session::open(scene_, options_);
  if (!session) return session.error();
  auto feed = std::make_unique<FrameFeed>(scene_.world, (*session)->rate_Hz(), (*session)->hands());
  auto stages = std::make_unique<StageClock>();
  (*session)->show_to(feed.get());
  (*session)->time_stages(stages.get());
  (*session)->hold_wrench_at_zero(stopped_);
  (*session)->stop_while(&server_->stop_asked());
  const bool records = recording_.on();
  recording_.end();  // it refers to the old session
  recording_.attach(**session);
  if (follower_ != nullptr) follower_->end();
  session_ = std::move(*session);  // the old one first: it refers to the old feed
  if (follower_ != nullptr) follower_->begin(*session_);
  if (records)
    if (Result<void> on = recording_.go_on(*description_, *session_, options_.grip); !on)
      server_->send_notice(on.error().message());
  scene_.settings.coupling = session_->scene().settings.coupling;  // it may have chosen
  if (device_chooses_)
    usual_.frame.coupling = coupling_gains(session_->device(), session_->rate_Hz()).coupling;
  feed_ = std::move(feed);
  stages_ = std::move(stages);
  waiting_.clear();
  timings_.clear();
  ready_.clear();
  newest_ = session_->poll();
  ++run_;
  server_->begin_run(run_, message_of_run(), geometry_of(scene_.world));
  return {};
}

void Viewer::let_follow(RunFollower* follower) {
  if (follower_ != nullptr) follower_->end();
  follower_ = follower;
  if (follower_ != nullptr) follower_->begin(*session_);
}

Result<void> Viewer::start() {
  Result<void> started = session_->start();
  threaded_ = static_cast<bool>(started);
  return started;
}

/// The scene from its start, with the settings as they are now.
void Viewer::restart() {
  if (!threaded_) return server_->send_notice("a run on the virtual clock cannot be started anew");
  session_->stop();
  Result<void> begun = begin_run();
  if (begun) begun = start();
  if (!begun) server_->send_notice(begun.error().message());
}

void Viewer::poll(std::chrono::microseconds longest) {
  server_->wait(longest);
  for (Request request; server_->take(request);) obey(request);
  newest_ = session_->poll(&timings_);
  if (follower_ != nullptr) follower_->go_on();
  gather();
  watch_recording();
  if (Clock::now() - last_shown_ >= kShowEvery) show();
}

void Viewer::after_virtual_frame(const FrameRecord& record) {
  ChartSample sample;
  while (feed_->pop(sample.frame)) {
    sample.frame_time_s = static_cast<float>(record.frame_time_s);
    sample.wakeup_latency_s = kUnknown;
    ready_.push_back(sample);
  }
  recording_.wait_for_room();
  if (++virtual_frames_ % kVirtualFramesAtOnce != 0) return;
  for (Request request; server_->take(request);) obey(request);
  newest_ = session_->poll();
  watch_recording();
  show();
}

Result<void> Viewer::record(const std::string& path) {
  return recording_.begin(path, *description_, *session_, options_.grip, std::nullopt);
}

/// In the middle of the run, with the settings as they are now.
void Viewer::begin_recording() {
  if (recording_.on()) return;
  if (!description_) return server_->send_notice("what was not read from a scene file cannot be recorded");
  const UserSettings now{scene_.settings, scene_.safety};
  const Result<void> begun = recording_.begin("", *description_, *session_, options_.grip, now);
  server_->send_notice(begun ? "recording into " + recording_.files().back().path : begun.error().message());
  server_->send_status(status_json());
}

std::vector<RecordingFile> Viewer::end_recording() {
  recording_.end();
  watch_recording();
  return recording_.files();
}

void Viewer::end_recording_by_page() {
  const RecordingFile file = end_recording().back();
  server_->send_notice(fmt::format("{} frames are recorded in {}", file.frames, file.path));
  server_->send_status(status_json());
}

void Viewer::watch_recording() {
  const std::optional<Error> trouble = recording_.trouble();
  if (!trouble) return;
  recording_trouble_ = "the run goes on, and is not recorded any more: " + trouble->message();
  server_->send_notice(recording_trouble_);
}

/// Puts samples and times of the same frame together. The times come a moment after the sample.
void Viewer::gather() {
  for (FrameSample sample; feed_->pop(sample);) waiting_.push_back(sample);
  std::size_t used = 0;
  while (!waiting_.empty()) {
    const std::uint64_t index = waiting_.front().index;
    while (used < timings_.size() && timings_[used].index < index) ++used;
    if (used == timings_.size() && session_->loop_status().running) break;
    const bool known = used < timings_.size() && timings_[used].index == index;
    ready_.push_back({waiting_.front(), known ? static_cast<float>(timings_[used].frame_time_s) : kUnknown,
                      known ? static_cast<float>(timings_[used].wakeup_latency_s) : kUnknown});
    waiting_.pop_front();
  }
  timings_.erase(timings_.begin(), timings_.begin() + static_cast<std::ptrdiff_t>(used));
}

void Viewer::show() {
  const Clock::time_point now = Clock::now();
  last_shown_ = now;
  const ServerStatus pages = server_->status();
  if (pages.pages > 0) last_page_ = now;
  if (!ready_.empty()) frames_ready_ = ready_.back().frame.index + 1;
  if (feed_->look()) {
    picture_waits_ = true;
    if (follower_ != nullptr) follower_->see(feed_->picture());
  }
  std::string picture;
  if (picture_waits_ && feed_->picture().index < frames_ready_) {
    write_picture(feed_->picture(), picture);
    picture_waits_ = false;
  }
  if (!ready_.empty() || !picture.empty()) server_->show(ready_, std::move(picture), feed_->picture().index);
  ready_.clear();
  if (now - last_status_ < kStatusEvery) return;
  last_status_ = now;
  server_->send_status(status_json());
}

double Viewer::alone_s() const noexcept {
  return server_->status().pages > 0 ? 0.0 : std::chrono::duration<double>(Clock::now() - last_page_).count();
}

void Viewer::obey(const Request& request) {
  using What = Request::What;
  switch (request.what) {
    case What::kStop:
    case What::kResume:
      stopped_ = request.what == What::kStop;
      session_->hold_wrench_at_zero(stopped_);
      server_->send_status(status_json());
      return;
    case What::kAim:
      session_->ask({.kind = SessionCommand::Kind::kAim,
                     .hand = request.hand,
                     .buttons = request.buttons,
                     .p_WH = request.p,
                     .quat_wxyz_WH = request.q});
      return;
    case What::kRest:
      session_->ask({.kind = SessionCommand::Kind::kRest, .hand = request.hand});
      return;
    case What::kSet:
      return set(request);
    case What::kUnset:
      return unset(request);
    case What::kReset:
      return restart();
    case What::kScene:
      return change_scene(request.name);
    case What::kDevice:
      return change_device(request.name, &SessionOptions::device);
    case What::kGrip:
      return change_device(request.name, &SessionOptions::grip);
    case What::kRecord:
      return begin_recording();
    case What::kEnd:
      if (!recording_.on()) return;
      return end_recording_by_page();
    case What::kSeek:
    case What::kPlay:
      return server_->send_notice("there is no time line: this is no recording");
    case What::kAck:
    case What::kSteer:
    case What::kRelease:
    case What::kLeave:
      return;  // the server's own affair
  }
}

void Viewer::set(const Request& request) {
  const SettingInfo* const setting = setting_of(request);
  if (setting == nullptr) return server_->send_notice("there is no setting called " + request.key);
  if (!in_range(*setting, request.value)) {
    server_->send_notice(fmt::format("{}: {} is not from {} to {} {}", setting->name, request.value,
                                     setting->low, setting->high, setting->unit));
    return send_settings();
  }
  setting->set(scene_.settings, scene_.safety, request.value);
  if (std::string_view(setting->section) == "coupling") scene_.coupling_by_device = false;
  apply(*setting, request.value);
}

/// One part of a coupling that the device chooses cannot be taken back alone while the others stay set.
void Viewer::unset(const Request& request) {
  const SettingInfo* const setting = setting_of(request);
  if (setting == nullptr) return server_->send_notice("there is no setting called " + request.key);
  const double usual = setting->get(usual_.frame, usual_.safety);
  setting->set(scene_.settings, scene_.safety, usual);
  scene_.coupling_by_device = device_chooses_ && same_coupling(scene_.settings, usual_.frame);
  apply(*setting, usual);
}

/// The setting is in the scene; the session takes it over.
void Viewer::apply(const SettingInfo& setting, double value) {
  if (!setting.live) return restart();
  const auto index = static_cast<int>(&setting - setting_table().data());
  session_->ask({.kind = SessionCommand::Kind::kSet, .setting = index, .value = value});
  send_settings();
}

void Viewer::send_settings() {
  server_->send_settings(settings_message(shown_scene(*session_), shown_settings()), message_of_run());
}

/// Only scenes that come with the program, and the one it was started with: a page cannot name files.
void Viewer::change_scene(const std::string& name) {
  if (name == scene_.name) return restart();
  const std::vector<SceneEntry> known = list_scenes();
  if (std::none_of(known.begin(), known.end(), [&](const SceneEntry& s) { return s.name == name; }))
    return server_->send_notice("there is no scene called " + name);
  const Result<SceneDescription> description = describe_scene(name);
  if (!description) return server_->send_notice(description.error().message());
  Result<Scene> scene = build_scene(*description);
  if (!scene) return server_->send_notice(scene.error().message());
  remarks_ = remarks_on(*description, *scene);
  const bool follows_scene = options_.device == "pointer:" + scene_.device;
  scene_ = std::move(*scene);
  description_ = *description;
  remember_usual();
  if (follows_scene) options_.device.clear();
  options_.grip = scene_.grip;
  options_.other_devices.clear();  // they were named for the tools of another scene
  lead_by_pages(scene_, options_);
  restart();
}

/// Simulated devices and hands only: a page must not start a motor that was not chosen at the keyboard.
void Viewer::change_device(const std::string& name, std::string SessionOptions::*choice) {
  const bool simulated = choice == &SessionOptions::grip || name.rfind("pointer:", 0) == 0;
  DeviceOptions device_options;
  device_options.grip = choice == &SessionOptions::grip ? name : options_.grip;
  const std::string& device = choice == &SessionOptions::device ? name : options_.device;
  const Result<std::unique_ptr<Device>> made = make_device(device, device_options);
  if (!simulated || !made)
    return server_->send_notice(made ? "only simulated devices can be chosen here" : made.error().message());
  options_.*choice = name;
  restart();
}

std::string Viewer::status_json() {
  const LoopStatus loop = session_->loop_status();
  const Summary times = session_->frame_times().summary();
  nlohmann::ordered_json privileges = nlohmann::ordered_json::array();
  if (threaded_)
    for (const std::string& sentence : session_->privileges().sentences) privileges.push_back(sentence);
  const nlohmann::ordered_json status = {{"stopped", stopped_},
                                         {"stop_ramp_s", scene_.settings.safety.stop_ramp_s},
                                         {"running", loop.running},
                                         {"device_lost", loop.device_lost},
                                         {"frames", loop.frames},
                                         {"missed_deadlines", loop.missed_deadlines},
                                         {"late_frames", loop.late_frames},
                                         {"failed_reads", loop.failed_reads},
                                         {"failed_writes", loop.failed_writes},
                                         {"samples_dropped", feed_->dropped()},
                                         {"frame_us",
                                          {{"mean", times.mean_ns * 1e-3},
                                           {"p50", times.p50_ns * 1e-3},
                                           {"p99", times.p99_ns * 1e-3},
                                           {"p999", times.p999_ns * 1e-3},
                                           {"max", times.max_ns * 1e-3}}},
                                         {"safety", safety_flag_names(newest_.safety)},
                                         {"goals", goals_json(scene_, newest_)},
                                         {"recording", recording_json(recording_)},
                                         {"remarks", privileges}};
  return status.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace tactum
