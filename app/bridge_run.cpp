#include "bridge_run.h"

#include <algorithm>
#include <cmath>

#include "commands.h"

namespace tactum {
namespace {

constexpr double kSecond_ns = 1e9;

/// All rows have the bodies, which clients draw.
std::unique_ptr<FrameTrace> own_trace(const Session& session, const TraceFile* file) {
  if (file != nullptr) return nullptr;
  return std::make_unique<FrameTrace>(session.scene().world, session.scene().settings.dt_s, true,
                                      FrameTrace::kFrames, session.hands());
}

std::vector<BridgeChoice> choices_of(const BridgeOptions& options) {
  std::vector<BridgeChoice> choices;
  for (const std::string& text : options.bridges) {
    const Result<BridgeChoice> choice = parse_bridge(text);
    if (!choice) fail(choice.error());
    choices.push_back(*choice);
  }
  return choices;
}

}  // namespace

BridgeRun::BridgeRun(const BridgeOptions& options)
    : choices_(choices_of(options)), rate_Hz_(options.rate_Hz) {}

BridgeRun::BridgeRun(const BridgeOptions& options, Session& session, TraceFile* trace) : BridgeRun(options) {
  session_ = &session;
  trace_file_ = trace;
  trace_ = own_trace(session, trace);
  const FrameTrace& rows = trace_ ? *trace_ : trace->rows_of_frames();
  take_rows(rows);
  listen(rows);
  feed_.emplace(session.scene().world, session.rate_Hz(), session.hands());
  session.show_to(&*feed_);
  if (trace_)
    session.trace_to(trace_.get());
  else
    trace->pass_rows_to([this](std::span<const double> row) { show(row); });
}

BridgeRun::~BridgeRun() {
  if (session_ == nullptr) return;
  if (feed_) session_->show_to(nullptr);
  if (trace_)
    session_->trace_to(nullptr);
  else
    trace_file_->pass_rows_to({});
}

void BridgeRun::take_rows(const FrameTrace& rows) {
  row_.resize(rows.width());
  time_ = static_cast<std::size_t>(rows.column("time_s"));
  frames_a_message_ = static_cast<std::uint64_t>(std::max(1.0, std::round(session_->rate_Hz() / rate_Hz_)));
}

void BridgeRun::listen(const FrameTrace& rows) {
  scene_ = session_->scene().name;
  led_ = session_->can_be_led();
  BridgeTopics topics(session_->scene().world, rows.columns(), session_->hands());
  bridge_.reset();  // which frees the ports, if it had any
  Result<std::unique_ptr<Bridge>> bridge = Bridge::start(choices_, std::move(topics), led_);
  if (!bridge) fail(bridge.error());
  bridge_ = std::move(*bridge);
  for (std::size_t i = 0; i < choices_.size(); ++i) choices_[i].port = bridge_->ports()[i];
}

void BridgeRun::begin(Session& session) {
  session_ = &session;
  trace_ = own_trace(session, nullptr);
  take_rows(*trace_);
  if (!bridge_ || scene_ != session.scene().name || led_ != session.can_be_led()) listen(*trace_);
  session.trace_to(trace_.get());
}

void BridgeRun::end() {
  poll();
  session_->trace_to(nullptr);
  session_ = nullptr;
}

void BridgeRun::see(const FramePicture& picture) {
  const double time_s = static_cast<double>(picture.index) / session_->rate_Hz();
  bridge_->show_picture(picture, static_cast<std::uint64_t>(std::llround(time_s * kSecond_ns)));
}

void BridgeRun::show(std::span<const double> row) {
  const double time_s = row[time_];
  const auto index = static_cast<std::uint64_t>(std::llround(time_s * session_->rate_Hz()));
  if (index % frames_a_message_ != 0) return;
  bridge_->show_frame(
      {index, static_cast<std::uint64_t>(std::llround(time_s * kSecond_ns)), {row.begin(), row.end()}});
}

void BridgeRun::poll() {
  while (trace_ && trace_->pop(row_)) show(row_);
  if (feed_) {
    for (FrameSample sample; feed_->pop(sample);) {
    }
    if (feed_->look()) see(feed_->picture());
  }
  bridge_->send();
  for (Request request; bridge_->take(request);) {
    if (request.what == Request::What::kAim)
      session_->ask({.kind = SessionCommand::Kind::kAim,
                     .buttons = request.buttons,
                     .p_WH = request.p,
                     .quat_wxyz_WH = request.q});
    else if (request.what == Request::What::kRest)
      session_->ask({.kind = SessionCommand::Kind::kRest});
  }
}

}  // namespace tactum
