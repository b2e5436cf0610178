#include "tactum/recording/frame_numbers.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactum/haptics/frame_hash.h"
#include "tactum/telemetry/hand_fields.h"

namespace tactum::inline v0_1 {
namespace {

constexpr const char* kThree[] = {"x", "y", "z"};

/// Collects the names of the numbers of one field.
struct NumberNames {
  std::vector<ReportNumber>& numbers;
  const FieldInfo* field;
  std::string name;
  void add(const std::string& end) { numbers.push_back({name + end, field}); }
  void visit(const Wrench&) {
    for (const char* axis : kThree) add(fmt::format("_f{}_N", axis));
    for (const char* axis : kThree) add(fmt::format("_t{}_Nm", axis));
  }
  void visit(const Pose&) {
    for (const char* axis : kThree) add(fmt::format("_p{}_m", axis));
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) add(fmt::format("_r{}{}", row, column));
  }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void visit(const Number&) { add(""); }
};

struct NumberValues {
  double* next;
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void visit(const Number& value) noexcept { *next++ = static_cast<double>(value) + 0.0; }
  void visit(const Vec3& v) noexcept {
    for (int i = 0; i < 3; ++i) visit(v[i]);
  }
  void visit(const Wrench& F) noexcept {
    visit(F.f);
    visit(F.t);
  }
  void visit(const Twist& V) noexcept {
    visit(V.v);
    visit(V.w);
  }
  void visit(const Pose& X) noexcept {
    visit(X.p);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) visit(X.R(row, column));
  }
};

/// Adds numbers to a hash, by the same calls.
struct HashedValues {
  FrameHash& hash;
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void visit(const Number& value) noexcept { hash.add(static_cast<double>(value) + 0.0); }
  void visit(const Vec3& v) noexcept {
    for (int i = 0; i < 3; ++i) visit(v[i]);
  }
  void visit(const Wrench& F) noexcept {
    visit(F.f);
    visit(F.t);
  }
  void visit(const Twist& V) noexcept {
    visit(V.v);
    visit(V.w);
  }
  void visit(const Pose& X) noexcept {
    visit(X.p);
    for (int i = 0; i < 3; ++i) visit(Vec3(X.R.col(i)));
  }
  template <class... Values>
  void all(const Values&... values) noexcept {
    (visit(values), ...);
  }
};

/// What is hashed of a frame, wherever it lies: rows and hands have the same members in a frame's state and
/// in its copy.
template <class Rows, class Hand>
struct HashedFrame {
  const FrameReport& report;
  const WorldState& world;
  Rows rows;
  double load_work_J, stored_J;
  const Hand& first;
};

template <class Hand>
void add_hand(HashedValues& out, const Hand& own) noexcept {
  const HandTracking& hand = own.hand;
  out.all(hand.X_WD, hand.X_WH, hand.V_WH, hand.time_s, hand.known, hand.clutched);
  const SmoothingState& smoothing = own.smoothing;
  out.all(smoothing.shown, smoothing.step, smoothing.explained.force_N, smoothing.explained.torque_Nm);
  const PortState& port = own.port;
  out.all(port.stored.total_J, port.stored.spring_J, port.stored.force_N, port.stored.torque_Nm, port.tank_J,
          port.added, port.unfelt_Nm, port.X_DH, port.known, port.history.newest);
  for (const Wrench& sent : port.history.wrenches) out.visit(sent);
  const SafetyState& safety = own.safety;
  out.all(safety.sent, safety.gain, safety.invalid_s, safety.X_DH, safety.measured_s, safety.still_s,
          safety.measured);
}

template <class Rows, class Hand>
void add_frame(FrameHash& hash, const HashedFrame<Rows, Hand>& frame) noexcept {
  add_to(hash, frame.report);
  add_to(hash, frame.world);
  HashedValues out{hash};
  for (const auto& row : frame.rows)
    out.all(row.body_a, row.body_b, row.p_W, row.n_BA_W, row.distance, row.impulse);
  out.all(frame.load_work_J, frame.stored_J);
  add_hand(out, frame.first);
}

template <class Field>
void add_names(std::vector<ReportNumber>& numbers, Field) {
  static constexpr FieldInfo info = Field::kInfo;
  std::string name = info.name;
  std::replace(name.begin(), name.end(), '.', '_');
  NumberNames{numbers, &info, name}.visit(Field::of(FrameReport{}));
}

}  // namespace

const std::vector<ReportNumber>& report_numbers() {
  static const std::vector<ReportNumber> all = [] {
    std::vector<ReportNumber> numbers;
    for_each_report_field([&](auto field) { add_names(numbers, field); });
    return numbers;
  }();
  return all;
}

const std::vector<ReportNumber>& hand_numbers() {
  static const std::vector<ReportNumber> all = [] {
    std::vector<ReportNumber> numbers;
    for_each_hand_field([&](auto field) { add_names(numbers, field); });
    return numbers;
  }();
  return all;
}

void put_hand_report(const HandReport& report, double* out) noexcept {
  FrameReport as_first;
  static_cast<HandReport&>(as_first) = report;
  NumberValues values{out};
  for_each_hand_field([&](auto field) { values.visit(decltype(field)::of(as_first)); });
}

void put_report(const FrameReport& report, double* out) noexcept {
  NumberValues values{out};
  for_each_report_field([&](auto field) { values.visit(decltype(field)::of(report)); });
}

std::uint64_t state_hash(const FrameReport& report, const FrameState& state) noexcept {
  FrameHash hash;
  const HandFrameState& first = state;
  add_frame(hash, HashedFrame<std::span<const ContactRow>, HandFrameState>{
                      report, state.world, state.response.rows(), state.load_work_J,
                      state.response.stored_J(), first});
  add_to(hash, state.other_reports);
  HashedValues out{hash};
  for (const HandFrameState& other : state.other_hands) add_hand(out, other);
  return hash.value();
}

std::uint64_t state_hash(const FrameCopy& frame) noexcept {
  FrameHash hash;
  add_frame(hash, HashedFrame<std::span<const CopiedRow>, HandCopy>{frame.report, frame.world, frame.rows,
                                                                    frame.load_work_J, frame.stored_J,
                                                                    frame.hands.front()});
  add_to(hash, frame.other_reports);
  HashedValues out{hash};
  for (std::size_t h = 1; h < frame.hands.size(); ++h) add_hand(out, frame.hands[h]);
  return hash.value();
}

}  // namespace tactum::inline v0_1
