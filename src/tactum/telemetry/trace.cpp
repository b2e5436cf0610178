#include "tactum/telemetry/trace.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <type_traits>

#include "tactum/haptics/report_fields.h"
#include "tactum/loop/safety.h"
#include "tactum/math/screw.h"
#include "tactum/response/workspace_scale.h"
#include "tactum/telemetry/hand_fields.h"

namespace tactum::inline v0_1 {
namespace {

/// A frame as one of its hands has it.
struct Row {
  const TracedFrame& frame;
  const FrameReport& report;  // its part of a hand is that of this hand
  const TracedHand& own;
  double dt_s = 0.0;
  Twist V_WH_proxy = {};
};

constexpr const char* kAxes[] = {"x", "y", "z"};

/// Collects the names of the columns.
struct Names {
  std::vector<TraceColumn>& columns;
  template <class Value>
  void number(const std::string& name, const std::string& meaning, const Value&) {
    columns.push_back({name, meaning});
  }
  template <class Value>
  void vector(const std::string& before, const std::string& unit, const std::string& meaning, const Value&) {
    for (const char* axis : kAxes) columns.push_back({fmt::format("{}{}_{}", before, axis, unit), meaning});
  }
  template <class Value>
  void turn(const std::string& before, const std::string& meaning, const Value&) {
    for (const char* part : {"w", "x", "y", "z"}) columns.push_back({before + "_q" + part, meaning});
  }
};

/// Writes the numbers of one row in the same order; names are not looked at.
struct Numbers {
  const Row& row;
  double* next;
  template <class Value>
  void number(const char*, const char*, const Value& value) noexcept {
    *next++ = static_cast<double>(value(row));
  }
  template <class Value>
  void vector(const char*, const char*, const char*, const Value& value) noexcept {
    const Vec3 v = value(row);
    for (int i = 0; i < 3; ++i) *next++ = v[i];
  }
  template <class Value>
  void turn(const char*, const char*, const Value& value) noexcept {
    Eigen::Quaterniond q(value(row));
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    for (const double part : {q.w(), q.x(), q.y(), q.z()}) *next++ = part;
  }
};

/// The column of a field of the report: "work.near_pairs" is work_near_pairs, "port.stored_J"
/// energy_stored_J.
std::string column_of(std::string field) {
  std::replace(field.begin(), field.end(), '.', '_');
  return field.starts_with("port_") ? "energy_" + field.substr(5) : field;
}

double seconds(std::int64_t ns) noexcept {
  return std::chrono::duration<double>(std::chrono::nanoseconds(ns)).count();
}

bool ramps(const FrameReport& report) noexcept {
  return (report.safety & (safety_flag::kStarting | safety_flag::kStopping | safety_flag::kStopped |
                           safety_flag::kFaults)) != 0;
}

/// A wrench of the scene, as the device has it.
Wrench to_handle(const Row& row, const Wrench& in_scene) noexcept {
  return at_device(in_scene, row.frame.workspace_scale);
}
/// A wrench with the axes of D, with those of W.
Wrench to_world(const Row& row, const Wrench& F_D) noexcept { return rotated(row.own.hand->X_WD.R, F_D); }

template <class Visitor, class Of>
void wrench(Visitor& visit, const char* force, const char* torque, const char* meaning, const Of& of) {
  visit.vector(force, "N", meaning, [&](const Row& row) { return of(row).f; });
  visit.vector(torque, "Nm", meaning, [&](const Row& row) { return of(row).t; });
}

/// The motion of a hand, and what it feels.
template <class Visitor>
void visit_hand(Visitor& visit) {
  visit.vector("hand_p", "m", "the handle in the world", [](const Row& row) { return row.report.X_WH.p; });
  visit.turn("hand", "the same: its orientation", [](const Row& row) { return row.report.X_WH.R; });
  visit.vector("hand_v", "m_per_s", "its velocity, as the device tells it",
               [](const Row& row) { return row.own.hand->V_WH.v; });
  visit.vector("hand_w", "rad_per_s", "its angular velocity, as the device tells it",
               [](const Row& row) { return row.own.hand->V_WH.w; });
  visit.vector("device_p", "m", "the handle in the frame of the device",
               [](const Row& row) { return row.own.port->X_DH.p; });
  visit.turn("device", "the same: its orientation", [](const Row& row) { return row.own.port->X_DH.R; });
  visit.vector("proxy_p", "m", "the handle on the held part",
               [](const Row& row) { return row.report.X_WH_proxy.p; });
  visit.turn("proxy", "the same: its orientation", [](const Row& row) { return row.report.X_WH_proxy.R; });
  visit.vector("proxy_v", "m_per_s", "its velocity over the frame",
               [](const Row& row) { return row.V_WH_proxy.v; });
  visit.vector("proxy_w", "rad_per_s", "its angular velocity over the frame",
               [](const Row& row) { return row.V_WH_proxy.w; });
  wrench(visit, "restoring_f", "restoring_t",
         "contacts on the held part, at its centre of mass, in the scene",
         [](const Row& row) { return row.report.restoring; });
  wrench(visit, "field_f", "field_t", "force fields on the held part, at its centre of mass, in the scene",
         [](const Row& row) { return row.report.field; });
  wrench(visit, "computed_f", "computed_t", "what the response lets the hand feel",
         [](const Row& row) { return to_handle(row, row.report.coupling); });
  wrench(visit, "smoothed_f", "smoothed_t", "after smoothing, within what the device can exert",
         [](const Row& row) { return to_world(row, row.report.smoothed); });
  visit.vector("unfelt_t", "Nm", "the smoothed torque that the device cannot exert", [](const Row& row) {
    return to_world(row, {Vec3::Zero(), row.own.port->unfelt_Nm}).t;
  });
  wrench(visit, "passive_f", "passive_t", "after the caller's own stage and the energy balance",
         [](const Row& row) { return to_world(row, row.report.passive); });
  wrench(visit, "sent_f", "sent_t", "after safety: what the device was sent",
         [](const Row& row) { return to_world(row, row.report.shown); });
}

template <class Visitor>
void visit_ramping(Visitor& visit) {
  visit.number("ramping", "1 while safety ramps the wrench, or has set it to zero",
               [](const Row& row) { return ramps(row.report) ? 1.0 : 0.0; });
}

template <class Visitor, class Field>
void visit_field(Visitor& visit, Field) {
  using Value = std::remove_cvref_t<decltype(Field::of(std::declval<const FrameReport&>()))>;
  if constexpr (std::is_arithmetic_v<Value>)
    visit.number(Field::kInfo.name, Field::kInfo.meaning,
                 [](const Row& row) { return static_cast<double>(Field::of(row.report)); });
}

/// The quantities of the second hand, and of every one after it.
template <class Visitor>
void visit_other_hand(Visitor& visit) {
  visit_hand(visit);
  visit_ramping(visit);
  for_each_hand_field([&](auto field) { visit_field(visit, field); });
}

/// The quantities of every trace, in order.
template <class Visitor>
void visit_frame(Visitor& visit) {
  visit.number("time_s", "since the start",
               [](const Row& row) { return static_cast<double>(row.report.index) * row.dt_s; });
  visit_hand(visit);
  visit.number("in_contact", "1 while pieces touch",
               [](const Row& row) { return row.report.in_contact() ? 1.0 : 0.0; });
  visit_ramping(visit);
  for_each_report_field([&](auto field) { visit_field(visit, field); });
  static constexpr const char* kStageColumns[kStageCount] = {"stage_hand_s",       "stage_motion_bounds_s",
                                                             "stage_near_pairs_s", "stage_exact_tests_s",
                                                             "stage_response_s",   "stage_show_s"};
  for (int i = 0; i < kStageCount; ++i)
    visit.number(kStageColumns[i], "duration of the stage; zero where nobody takes it",
                 [i](const Row& row) { return seconds(row.frame.stage_ns[static_cast<std::size_t>(i)]); });
}

/// Those of one body.
template <class Visitor, class Name>
void visit_body(Visitor& visit, std::size_t body, const Name& name) {
  visit.vector(name("_p"), "m", "the body's centre of mass",
               [body](const Row& row) { return row.frame.X_WB[body].p; });
  visit.turn(name(""), "the body's orientation", [body](const Row& row) { return row.frame.X_WB[body].R; });
  visit.vector(name("_v"), "m_per_s", "the velocity of its centre of mass",
               [body](const Row& row) { return row.frame.V_WB[body].v; });
  visit.vector(name("_w"), "rad_per_s", "its angular velocity",
               [body](const Row& row) { return row.frame.V_WB[body].w; });
}

/// A name that can stand in a column's: letters, digits and underscores.
std::string plain_name(const Body& body, std::size_t i) {
  std::string name = body.name.empty() ? "body" + std::to_string(i) : body.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

}  // namespace

std::array<std::int64_t, kStageCount> stage_times(const StageClock* clock) noexcept {
  std::array<std::int64_t, kStageCount> times{};
  for (int i = 0; clock != nullptr && i < kStageCount; ++i)
    times[static_cast<std::size_t>(i)] = clock->stage_ns(static_cast<Stage>(i));
  return times;
}

FrameTrace::FrameTrace(const World& world, double dt_s, bool bodies, std::size_t frames, std::size_t hands)
    : frames_(frames), dt_s_(dt_s), bodies_(bodies), hands_(hands), proxies_(hands) {
  Names names{columns_};
  visit_frame(names);
  for (TraceColumn& column : columns_) column.name = column_of(column.name);
  for (std::size_t h = 1; h < hands; ++h) {
    std::vector<TraceColumn> own;
    Names of_hand{own};
    visit_other_hand(of_hand);
    for (const TraceColumn& column : own)
      columns_.push_back({fmt::format("h{}_{}", h + 1, column_of(column.name)),
                          fmt::format("of hand {}: {}", h + 1, column.meaning)});
  }
  for (std::size_t i = 0; bodies && i < world.bodies.size(); ++i) {
    std::string name = plain_name(world.bodies[i], i);
    if (column(name + "_px_m") >= 0) name += "_" + std::to_string(i);
    visit_body(names, i, [&name](const char* end) { return name + end; });
  }
  rows_.resize(frames_ * width());
}

int FrameTrace::column(std::string_view name) const noexcept {
  const auto found =
      std::find_if(columns_.begin(), columns_.end(), [&](const TraceColumn& c) { return c.name == name; });
  return found == columns_.end() ? -1 : static_cast<int>(found - columns_.begin());
}

void FrameTrace::write(const TracedFrame& frame, std::span<double> row) const noexcept {
  double* next = row.data();
  for (std::size_t h = 0; h < frame.hands.size(); ++h) {
    const TracedHand& own = frame.hands[h];
    Twist V_WH_proxy;  // over this frame
    if (own.X_WH_proxy_before != nullptr && own.report->grasped_body >= 0)
      V_WH_proxy = twist_between(*own.X_WH_proxy_before, own.report->X_WH_proxy, dt_s_);
    FrameReport other;
    if (h > 0) static_cast<HandReport&>(other) = *own.report;
    const Row of_hand{frame, h == 0 ? *frame.report : other, own, dt_s_, V_WH_proxy};
    Numbers numbers{of_hand, next};
    h == 0 ? visit_frame(numbers) : visit_other_hand(numbers);
    next = numbers.next;
  }
  const Row of_bodies{frame, *frame.report, frame.hands.front(), dt_s_};
  Numbers numbers{of_bodies, next};
  for (std::size_t i = 0; bodies_ && i < frame.X_WB.size(); ++i)
    visit_body(numbers, i, [](const char* end) { return end; });
}

/// For the velocities of the next frame, also where this one's row is lost.
void FrameTrace::remember_proxies(const FrameSource& frame) noexcept {
  for (std::size_t h = 0; h < hands_.size(); ++h) {
    const HandReport& report = h == 0 ? frame.report : frame.state.other_reports[h - 1];
    proxies_[h] = report.X_WH_proxy;
    hands_[h].X_WH_proxy_before = report.grasped_body >= 0 ? &proxies_[h] : nullptr;
  }
}

void FrameTrace::take(const FrameSource& frame, const StageClock* clock) noexcept {
  const std::size_t head = head_.load(std::memory_order_relaxed);
  if (head - tail_.load(std::memory_order_acquire) == frames_) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return remember_proxies(frame);
  }
  for (std::size_t h = 0; h < hands_.size(); ++h) {
    const HandFrameState& own = frame.state.of_hand(h);
    hands_[h].report = h == 0 ? &frame.report : &frame.state.other_reports[h - 1];
    hands_[h].hand = &own.hand;
    hands_[h].port = &own.port;
  }
  write({&frame.report, hands_, frame.state.world.X_WB, frame.state.world.V_WB,
         frame.settings.workspace.scale, stage_times(clock)},
        {rows_.data() + head % frames_ * width(), width()});
  head_.store(head + 1, std::memory_order_release);
  remember_proxies(frame);
}

bool FrameTrace::pop(std::span<double> row) noexcept {
  const std::size_t tail = tail_.load(std::memory_order_relaxed);
  if (tail == head_.load(std::memory_order_acquire)) return false;
  const auto from = rows_.begin() + static_cast<std::ptrdiff_t>(tail % frames_ * width());
  std::copy(from, from + static_cast<std::ptrdiff_t>(width()), row.begin());
  tail_.store(tail + 1, std::memory_order_release);
  return true;
}

}  // namespace tactum::inline v0_1
