#include "tactum/haptics/frame_hash.h"

#include "tactum/base/member_count.h"
#include "tactum/haptics/report_fields.h"

namespace tactum::inline v0_1 {
namespace {

// Checks that no member of the report is missing in the list of its fields: as many are listed as there are.

template <auto Member>
constexpr char kMemberId = 0;

template <class Struct>
struct NamedMembers {
  std::array<const char*, 2 * kReportFields> seen{};
  std::size_t count = 0;

  template <class Value>
  constexpr void see(Value Struct::*, const char* id) {
    for (std::size_t i = 0; i < count; ++i)
      if (seen[i] == id) return;
    seen[count++] = id;
  }
  template <class Other, class Value>
  constexpr void see(Value Other::*, const char*) {}
  template <auto... Path>
  constexpr void see_all(const ReportPath<Path...>&) {
    (see(Path, &kMemberId<Path>), ...);
  }
};

template <class Struct, class... Fields>
consteval std::size_t named_members_of(const report_detail::FieldList<Fields...>&) {
  NamedMembers<Struct> named;
  (named.see_all(Fields{}), ...);
  return named.count;
}

// The report begins with that of the first hand, which counts as one member.
static_assert(named_members_of<FrameReport>(report_detail::kFields) + 1 == kMemberCount<FrameReport>);
static_assert(named_members_of<HandReport>(report_detail::kFields) == kMemberCount<HandReport>);
static_assert(named_members_of<FrictionReport>(report_detail::kFields) == kMemberCount<FrictionReport>);
static_assert(named_members_of<PortReport>(report_detail::kFields) == kMemberCount<PortReport>);
static_assert(named_members_of<EnergyTotals>(report_detail::kFields) == kMemberCount<EnergyTotals>);
static_assert(named_members_of<ContactWork>(report_detail::kFields) == kMemberCount<ContactWork>);

void add(FrameHash& hash, double value) { hash.add(value + 0.0); }  // one zero, whatever its sign

template <class Count>
requires std::is_integral_v<Count>
void add(FrameHash& hash, Count value) { hash.add(value); }

void add(FrameHash& hash, const Vec3& v) {
  for (int i = 0; i < 3; ++i) add(hash, v[i]);
}

void add(FrameHash& hash, const Wrench& F) {
  add(hash, F.f);
  add(hash, F.t);
}

void add(FrameHash& hash, const Pose& X) {
  add(hash, X.p);
  for (int i = 0; i < 3; ++i) add(hash, Vec3(X.R.col(i)));
}

}  // namespace

void add_to(FrameHash& hash, const FrameReport& report) noexcept {
  for_each_report_field([&](auto field) { add(hash, decltype(field)::of(report)); });
}

void add_to(FrameHash& hash, std::span<const HandReport> others) noexcept {
  for (const HandReport& other : others) {
    FrameReport as_first;
    static_cast<HandReport&>(as_first) = other;
    add_to(hash, as_first);
  }
}

void add_to(FrameHash& hash, const WorldState& state) noexcept {
  for (const Pose& X_WB : state.X_WB) add(hash, X_WB);
  for (const Twist& V_WB : state.V_WB) {
    add(hash, V_WB.v);
    add(hash, V_WB.w);
  }
}

}  // namespace tactum::inline v0_1
