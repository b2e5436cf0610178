#include "tactum/recording/frame_numbers.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactum/haptics/frame_hash.h"

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

void add_contacts(HashedValues& out, std::span<const ContactRow> rows) noexcept {
  for (const ContactRow& row : rows)
    out.all(row.body_a, row.body_b, row.p_W, row.n_BA_W, row.distance, row.impulse);
}

}  // namespace

const std::vector<ReportNumber>& report_numbers() {
  static const std::vector<ReportNumber> all = [] {
    std::vector<ReportNumber> numbers;
    const FrameReport report;
    for_each_report_field([&](auto field) {
      using Field = decltype(field);
      static constexpr FieldInfo info = Field::kInfo;
      std::string name = info.name;
      std::replace(name.begin(), name.end(), '.', '_');
      NumberNames{numbers, &info, name}.visit(Field::of(report));
    });
    return numbers;
  }();
  return all;
}

void put_report(const FrameReport& report, double* out) noexcept {
  NumberValues values{out};
  for_each_report_field([&](auto field) { values.visit(decltype(field)::of(report)); });
}

std::uint64_t state_hash(const FrameReport& report, const FrameState& state) noexcept {
  FrameHash hash;
  add_to(hash, report);
  add_to(hash, state.world);
  HashedValues out{hash};
  add_contacts(out, state.response.rows());
  out.all(state.load_work_J, state.response.stored_J());
  const HandStage& hand = state.hand;
  out.all(hand.X_WD, hand.X_WH, hand.V_WH, hand.time_s, hand.known, hand.clutched);
  const SmoothingState& smoothing = state.smoothing;
  out.all(smoothing.shown, smoothing.step, smoothing.explained.force_N, smoothing.explained.torque_Nm);
  const PortState& port = state.port;
  out.all(port.stored.total_J, port.stored.spring_J, port.stored.force_N, port.stored.torque_Nm, port.tank_J,
          port.added, port.unfelt_Nm, port.X_DH, port.known, port.history.newest);
  for (const Wrench& sent : port.history.wrenches) out.visit(sent);
  const SafetyState& safety = state.safety;
  out.all(safety.sent, safety.gain, safety.invalid_s, safety.X_DH, safety.measured_s, safety.still_s,
          safety.measured);
  return hash.value();
}

}  // namespace tactum::inline v0_1
