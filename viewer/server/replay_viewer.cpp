#include "viewer/server/replay_viewer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace tactum {
namespace {

using namespace std::chrono_literals;

constexpr auto kShowReplayEvery = 15ms;
constexpr auto kReplayStatusEvery = 500ms;
constexpr auto kLongestAtOnce = 30ms;  // of computing frames, before requests are looked at again
constexpr float kNoTime = std::numeric_limits<float>::quiet_NaN();

}  // namespace

Result<std::unique_ptr<ReplayViewer>> ReplayViewer::open(std::unique_ptr<ReplayedRun> run, int port) {
  const RecordingTape& tape = run->tape();
  if (tape.first() == tape.past())
    return Error{"there is nothing to show", "no whole frame", "a recording with frames", tape.name()};
  Result<std::unique_ptr<Server>> server = Server::start(port);
  if (!server) return server.error();
  std::unique_ptr<ReplayViewer> viewer(new ReplayViewer(std::move(run), std::move(*server)));
  return viewer;
}

// The feed draws a picture of every frame: any of them may be the one at which the replay stands still.
ReplayViewer::ReplayViewer(std::unique_ptr<ReplayedRun> run, std::unique_ptr<Server> server)
    : run_(std::move(run)),
      server_(std::move(server)),
      feed_(run_->simulation().world(), FrameFeed::kPictures_Hz, run_->simulation().settings().hands()),
      last_advance_(Clock::now()) {
  const RecordingTape& tape = run_->tape();
  const RecordedScene& scene = run_->scene();
  const FrameSettings& settings = run_->simulation().settings();
  const DeviceInfo& device = tape.head().device;
  const UserSettings now{settings, scene.safety};
  RunFacts facts;
  facts.run = 1;
  facts.device = device.name;
  facts.grip = tape.head().grip;
  facts.loop_in_real_time = false;
  facts.replay = {std::filesystem::path(tape.name()).filename().string(), tape.first(), tape.past()};
  const ShownScene shown{
      scene.name, scene.description, run_->simulation().world(), settings, device, 1.0 / settings.dt_s, {}};
  server_->begin_run(1, run_message(shown, {now, now, false, false}, facts),
                     geometry_of(run_->simulation().world()));
  shown_ = tape.first();
}

void ReplayViewer::poll(std::chrono::microseconds longest) {
  server_->wait(longest);
  std::optional<std::uint64_t> wanted;  // of several moments only the last: a scrubbed line asks for many
  for (Request request; server_->take(request);) {
    if (request.what == Request::What::kSeek)
      wanted = request.frame;
    else
      obey(request);
  }
  if (wanted) seek(*wanted);
  advance();
  if (Clock::now() - last_shown_ >= kShowReplayEvery) show(Clock::now() - last_status_ >= kReplayStatusEvery);
}

void ReplayViewer::obey(const Request& request) {
  using What = Request::What;
  switch (request.what) {
    case What::kPlay:
      return play(request.value);
    case What::kAck:
    case What::kSteer:
    case What::kRelease:
    case What::kAim:
    case What::kRest:
    case What::kLeave:
    case What::kStop:
    case What::kResume:
    case What::kSeek:
      return;  // the server's own affair, or nothing that a replay could do
    case What::kReset:
      return seek(run_->tape().first());
    default:
      server_->send_notice(
          "a replay is felt as it was recorded: tactum replay with --settings or --response shows it "
          "otherwise");
  }
}

void ReplayViewer::play(double speed) {
  if (!(speed >= 0.0 && speed <= kFastest)) return server_->send_notice("a speed is from 0 to 16");
  if (speed > 0.0 && run_->next_index() >= run_->tape().past()) seek(run_->tape().first());
  speed_ = speed;
  due_ = 0.0;
  show(true);
}

/// Shows a frame: it is computed from the last snapshot before, and the frames on the way are in the charts.
void ReplayViewer::seek(std::uint64_t frame) {
  const RecordingTape& tape = run_->tape();
  frame = std::clamp(frame, tape.first(), tape.past() - 1);
  const int snapshot = run_->snapshot_before(frame);
  const std::uint64_t from =
      snapshot < 0 ? tape.first() : tape.snapshots()[static_cast<std::size_t>(snapshot)].index;
  if (frame < run_->next_index() || from > run_->next_index())
    if (const Result<void> restored = run_->restore(snapshot); !restored) {
      speed_ = 0.0;
      return server_->send_notice(restored.error().message());
    }
  while (run_->next_index() <= frame && step()) {
  }
  due_ = 0.0;
  show(true);
}

/// Computes the frames that are due, as far as there is time.
void ReplayViewer::advance() {
  const Clock::time_point now = Clock::now();
  const double since_s = std::chrono::duration<double>(now - last_advance_).count();
  last_advance_ = now;
  if (speed_ == 0.0 || server_->status().pages == 0) return;
  due_ += std::min(since_s, 0.1) * speed_ / run_->tape().head().dt_s;
  while (due_ >= 1.0) {
    if (!step()) {
      speed_ = due_ = 0.0;
      return show(true);
    }
    due_ -= 1.0;
    if (Clock::now() - now > kLongestAtOnce) due_ = std::min(due_, 1.0);  // slower than it was: not at once
  }
}

bool ReplayViewer::step() {
  const Result<const TapeFrame*> frame = run_->step();
  if (!frame) {
    server_->send_notice(frame.error().message());
    return false;
  }
  if (*frame == nullptr) return false;
  const Simulation& simulation = run_->simulation();
  feed_.take({simulation.report(), simulation.state(), simulation.settings()}, nullptr);
  ChartSample sample{.frame = {}, .frame_time_s = kNoTime, .wakeup_latency_s = kNoTime};
  while (feed_.pop(sample.frame)) ready_.push_back(sample);
  shown_ = simulation.report().index;
  return true;
}

void ReplayViewer::show(bool with_status) {
  last_shown_ = Clock::now();
  std::string picture;
  if (feed_.look()) write_picture(feed_.picture(), picture);
  if (!ready_.empty() || !picture.empty()) server_->show(ready_, std::move(picture), feed_.picture().index);
  ready_.clear();
  if (!with_status) return;
  last_status_ = last_shown_;
  server_->send_status(status_json());
}

std::string ReplayViewer::status_json() const {
  const nlohmann::ordered_json status = {
      {"running", true}, {"frames", shown_}, {"replay", {{"frame", shown_}, {"speed", speed_}}}};
  return status.dump();
}

}  // namespace tactum
