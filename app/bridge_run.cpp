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

BridgeRun::BridgeRun(const BridgeOptions& options, Session& session, TraceFile* trace)
    : session_(session),
      trace_file_(trace),
      trace_(own_trace(session, trace)),
      feed_(session.scene().world, session.rate_Hz(), session.hands()),
      frames_a_message_(
          static_cast<std::uint64_t>(std::max(1.0, std::round(session.rate_Hz() / options.rate_Hz)))) {
  const FrameTrace& rows = trace_ ? *trace_ : trace->rows_of_frames();
  row_.resize(rows.width());
  time_ = static_cast<std::size_t>(rows.column("time_s"));
  Result<std::unique_ptr<Bridge>> bridge =
      Bridge::start(choices_of(options), BridgeTopics(session.scene().world, rows.columns(), session.hands()),
                    session.can_be_led());
  if (!bridge) fail(bridge.error());
  bridge_ = std::move(*bridge);
  session_.show_to(&feed_);
  if (trace_)
    session_.trace_to(trace_.get());
  else
    trace->pass_rows_to([this](std::span<const double> row) { show(row); });
}

BridgeRun::~BridgeRun() {
  session_.show_to(nullptr);
  if (trace_)
    session_.trace_to(nullptr);
  else
    trace_file_->pass_rows_to({});
}

void BridgeRun::show(std::span<const double> row) {
  const double time_s = row[time_];
  const auto index = static_cast<std::uint64_t>(std::llround(time_s * session_.rate_Hz()));
  if (index % frames_a_message_ != 0) return;
  bridge_->show_frame(
      {index, static_cast<std::uint64_t>(std::llround(time_s * kSecond_ns)), {row.begin(), row.end()}});
}

void BridgeRun::poll() {
  while (trace_ && trace_->pop(row_)) show(row_);
  for (FrameSample sample; feed_.pop(sample);) {
  }
  if (feed_.look()) {
    const FramePicture& picture = feed_.picture();
    const double time_s = static_cast<double>(picture.index) / session_.rate_Hz();
    bridge_->show_picture(picture, static_cast<std::uint64_t>(std::llround(time_s * kSecond_ns)));
  }
  bridge_->send();
  for (Request request; bridge_->take(request);) {
    if (request.what == Request::What::kAim)
      session_.ask({.kind = SessionCommand::Kind::kAim,
                    .buttons = request.buttons,
                    .p_WH = request.p,
                    .quat_wxyz_WH = request.q});
    else if (request.what == Request::What::kRest)
      session_.ask({.kind = SessionCommand::Kind::kRest});
  }
}

}  // namespace tactum
