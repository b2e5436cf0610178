#pragma once
/// Every number of a FrameReport once, with its name, unit and meaning. The hash of a frame, the sums of a
/// run, the channels of displays, the JSON summary and docs/report-fields.md are made from this list alone.
/// A member that a struct of the report has and this list has not is an error of compilation.
///
///   for_each_report_field([&](auto field) {
///     using Field = decltype(field);
///     print(Field::kInfo.name, Field::of(report));
///   });
///
/// The visits are resolved when compiled: there is neither a table nor a call at run time.

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "tactum/response/frame_report.h"

namespace tactum::inline v0_1 {

/// The value of a field that a run keeps (telemetry/run_record.h).
enum class InRun {
  kNothing,
  kLargest,  ///< the largest value of a frame
  kSum       ///< the sum over the frames, and the largest value of a frame
};

/// How displays show a field as a channel (telemetry/channels.h). Without a key there is no channel.
struct FieldChannel {
  const char* key = nullptr;    ///< "patches"
  const char* label = nullptr;  ///< "Contact patches"
  const char* group = nullptr;  ///< channels of one group belong on one chart
};

struct FieldInfo {
  const char* name;     ///< as in C++, from the report on: "work.near_pairs"
  const char* unit;     ///< SI; "" for counts, flags and ratios
  const char* meaning;  ///< one line
  InRun in_run = InRun::kNothing;
  FieldChannel channel = {};
};

/// A field and the members that lead to it.
template <auto... Path>
struct ReportPath : FieldInfo {
  static constexpr const auto& of(const FrameReport& report) noexcept { return (report.*....*Path); }
};

namespace report_detail {

/// What is known of the fields, and their types apart: a std::tuple of them would cost every file that
/// includes this one a second of compilation.
template <class... Fields>
struct FieldList {
  consteval FieldList(const Fields&... fields) : infos{fields...} {}  // NOLINT: deduced, of any length
  template <std::size_t Place>
  using At = std::tuple_element_t<Place, std::tuple<Fields...>>;
  std::array<FieldInfo, sizeof...(Fields)> infos;
};

using R = FrameReport;
using F = FrictionReport;
using P = PortReport;
using E = EnergyTotals;
using W = ContactWork;
template <auto... Path>
using Of = ReportPath<Path...>;
inline constexpr InRun kNothing = InRun::kNothing, kLargest = InRun::kLargest, kSum = InRun::kSum;

// clang-format off
inline constexpr FieldList kFields{
  Of<&R::index>{{"index", "", "frames since the start"}},
  Of<&R::flags>{{"flags", "", "what the frame could not do in full, as bits", kNothing,
    {"frame_flags", "Frame flags", "flags"}}},
  Of<&R::safety>{{"safety", "", "which limit acted, as bits", kNothing, {"safety_flags", "Safety flags", "flags"}}},
  Of<&R::grasped_body>{{"grasped_body", "", "index of the body that is held; -1: none"}},
  Of<&R::hold>{{"hold", "", "how the hand holds it: 0 firmly, 1 at the centre of a hinged body, 2 as by a rod"}},
  Of<&R::X_WH>{{"X_WH", "m", "where the hand is, in the world"}},
  Of<&R::X_WH_proxy>{{"X_WH_proxy", "m", "where the held part would have the hand, in the world"}},
  Of<&R::restoring>{{"restoring", "N, N m", "contact forces on the held part, at its centre of mass, axes of the world"}},
  Of<&R::field>{{"field", "N, N m", "force fields on the held part, at its centre of mass, axes of the world"}},
  Of<&R::coupling>{{"coupling", "N, N m", "the raw wrench of the coupling in the scene, at the handle, axes of the world"}},
  Of<&R::smoothed>{{"smoothed", "N, N m", "the wrench after smoothing, at the handle, axes of the device"}},
  Of<&R::port, &P::balance_J>{{"port.balance_J", "J", "taken in and not stored, within the credit; negative: energy was generated",
    kNothing, {"port_energy_balance_J", "Energy balance now", "energy"}}},
  Of<&R::port, &P::stored_J>{{"port.stored_J", "J", "by coupling, bodies, joints and contacts, from any zero", kNothing,
    {"energy_stored_J", "Stored by the scene", "stored energy"}}},
  Of<&R::port, &P::generated_J>{{"port.generated_J", "J", "energy that came out and that nobody put in, since the start", kLargest,
    {"energy_generated_J", "Generated", "generated energy"}}},
  Of<&R::port, &P::paid_J>{{"port.paid_J", "J", "of it, given up by the coupling's spring as its stiffness was lowered", kLargest,
    {"energy_paid_J", "Paid by the coupling", "generated energy"}}},
  Of<&R::port, &P::stiffness_share>{{"port.stiffness_share", "", "of the coupling's stiffness that the energy balance leaves", kNothing,
    {"stiffness_share", "Stiffness in use", "stiffness"}}},
  Of<&R::port, &P::added_share>{{"port.added_share", "", "of what the caller's own stage adds that is passed on"}},
  Of<&R::port, &P::total, &E::from_hand_J>{{"port.total.from_hand_J", "J",
    "work the hand has put in, moving against the force", kNothing, {"energy_from_hand_J", "From the hand", "energy"}}},
  Of<&R::port, &P::total, &E::to_hand_J>{{"port.total.to_hand_J", "J",
    "work the hand was given, moved along by the force", kNothing, {"energy_to_hand_J", "To the hand", "energy"}}},
  Of<&R::port, &P::total_turning, &E::from_hand_J>{{"port.total_turning.from_hand_J", "J",
    "work of the hand's turns against the torque, felt or not", kNothing,
    {"energy_from_hand_turning_J", "From the hand, turning", "energy of turning"}}},
  Of<&R::port, &P::total_turning, &E::to_hand_J>{{"port.total_turning.to_hand_J", "J", "work of the torque on the hand",
    kNothing, {"energy_to_hand_turning_J", "To the hand, turning", "energy of turning"}}},
  Of<&R::passive>{{"passive", "N, N m", "with the caller's own stage, before safety, at the handle, axes of the device"}},
  Of<&R::shown>{{"shown", "N, N m", "the wrench after safety, at the handle, axes of the device: what was sent"}},
  Of<&R::tolerance_m>{{"tolerance_m", "m", "distance below which a pair pushes, largest of the pairs in contact",
    kNothing, {"tolerance_m", "Tolerance", "distance"}}},
  Of<&R::min_distance_m>{{"min_distance_m", "m", "of the pairs in contact; negative is overlap, 0 without contact",
    kNothing, {"min_distance_m", "Smallest distance", "distance"}}},
  Of<&R::penetrating>{{"penetrating", "", "whether a pair overlaps by more than its certificate could doubt"}},
  Of<&R::time_of_impact_s>{{"time_of_impact_s", "s", "smallest, from the start of the frame", kNothing,
    {"time_of_impact_s", "Time of impact", "impact"}}},
  Of<&R::contact_points>{{"contact_points", "", "rows of the contact problem", kSum,
    {"contact_points", "Contact points", "contacts"}}},
  Of<&R::grasped_contact_points>{{"grasped_contact_points", "", "contact points that push the held part: those that you can feel",
    kSum, {"grasped_contact_points", "... that push the held part", "contacts"}}},
  Of<&R::work, &W::patches>{{"work.patches", "", "pairs of pieces that touch", kSum,
    {"patches", "Contact patches", "contacts"}}},
  Of<&R::impacts>{{"impacts", "", "pairs of bodies that hit each other", kSum}},
  Of<&R::solver_iterations>{{"solver_iterations", "", "of the contact solver", kSum,
    {"solver_iterations", "Solver rounds", "work"}}},
  Of<&R::solvers>{{"solvers", "", "which solvers were at work: 1 exact, 2 sweeps, 4 penalty, 8 Newton, added up"}},
  Of<&R::active_constraints>{{"active_constraints", "", "rows that hold the bodies", kSum}},
  Of<&R::validation_tests>{{"validation_tests", "", "exact tests of poses before they were taken", kSum}},
  Of<&R::path_tests>{{"path_tests", "",
    "nodes and leaves of surfaces looked at in proofs that steps cross nothing", kSum}},
  Of<&R::unproven_paths>{{"unproven_paths", "", "pairs of surfaces whose step was tested at its end only", kSum}},
  Of<&R::validation_retries>{{"validation_retries", "", "steps that were not taken as they came", kSum}},
  Of<&R::waiting>{{"waiting", "", "bodies that stood still for want of budget", kSum}},
  Of<&R::asleep>{{"asleep", "", "bodies that rest, and were not looked at", kSum}},
  Of<&R::longest_wait>{{"longest_wait", "", "frames on end that a waiting body has stood still", kLargest}},
  Of<&R::cut_short>{{"cut_short", "", "bodies that stayed, because no step of theirs was found open", kSum}},
  Of<&R::momentum_off_Ns>{{"momentum_off_Ns", "N s",
    "by how much the momentum of what moves freely is off from what it was given"}},
  Of<&R::forced_short>{{"forced_short", "", "whether a step was cut short of where the forces would have it"}},
  Of<&R::friction, &F::cone_used>{{"friction.cone_used", "",
    "largest share of a friction cone that forces use; at 1 it slips", kLargest,
    {"friction_used", "Friction in use", "friction"}}},
  Of<&R::friction, &F::sticking>{{"friction.sticking", "", "pairs of surfaces that push, rub and do not slide", kSum,
    {"sticking_patches", "Sticking surfaces", "friction"}}},
  Of<&R::friction, &F::slipping>{{"friction.slipping", "", "the same that slide", kSum,
    {"slipping_patches", "Slipping surfaces", "friction"}}},
  Of<&R::work, &W::broad_phase_runs>{{"work.broad_phase_runs", "", "1 when boxes or lists had to be renewed, else 0", kSum}},
  Of<&R::work, &W::bodies>{{"work.bodies", "", "bodies of the world", kLargest}},
  Of<&R::work, &W::near_pairs>{{"work.near_pairs", "", "pairs of pieces on the lists", kSum,
    {"near_pairs", "Near pairs", "work"}}},
  Of<&R::work, &W::exact_tests>{{"work.exact_tests", "", "pairs of pieces whose distance was computed", kSum,
    {"exact_tests", "Exact tests", "work"}}},
  Of<&R::work, &W::feature_steps>{{"work.feature_steps", "", "feature pairs those tests visited", kSum,
    {"feature_steps", "Feature steps", "work"}}},
  Of<&R::work, &W::surface_queries>{{"work.surface_queries", "",
    "pairs of bodies asked for the local minima of their surfaces", kSum}},
  Of<&R::work, &W::minima>{{"work.minima", "", "local minima found by those queries", kSum}},
  Of<&R::work, &W::dropped_minima>{{"work.dropped_minima", "", "minima left out for want of room", kSum}},
  Of<&R::work, &W::dropped_error>{{"work.dropped_error", "m", "by how much a dropped minimum can be overstepped at most",
    kLargest}},
  Of<&R::work, &W::uncertified>{{"work.uncertified", "", "answers without a certificate", kSum}},
  Of<&R::work, &W::due>{{"work.due", "", "pairs that may be within their tolerance, and whose last answer holds no more", kSum}},
  Of<&R::work, &W::known>{{"work.known", "", "pairs that may be within their tolerance, and whose last answer holds", kSum}},
  Of<&R::work, &W::unchecked>{{"work.unchecked", "", "due pairs beyond the budget", kSum}},
  Of<&R::work, &W::left_unproven>{{"work.left_unproven", "",
    "unchecked pairs that no bound proves to stay apart in this frame", kSum}},
  Of<&R::work, &W::left_of_grasped>{{"work.left_of_grasped", "", "unproven pairs of the held part", kSum}},
  Of<&R::work, &W::longest_unchecked>{{"work.longest_unchecked", "",
    "frames since the last check of a pair that was left unproven", kLargest}},
  Of<&R::work, &W::capacity_reached>{{"work.capacity_reached", "", "whether something was dropped for want of room"}},
};
// clang-format on

}  // namespace report_detail

inline constexpr std::size_t kReportFields = report_detail::kFields.infos.size();

/// The field at a place of the list.
template <std::size_t Place>
struct ReportField {
  static constexpr std::size_t kPlace = Place;
  static constexpr FieldInfo kInfo = report_detail::kFields.infos[Place];
  static constexpr const auto& of(const FrameReport& report) noexcept {
    return decltype(report_detail::kFields)::template At<Place>::of(report);
  }
};

/// Calls `visit` with each ReportField in turn.
template <class Visit>
constexpr void for_each_report_field(const Visit& visit) {
  [&]<std::size_t... Place>(std::index_sequence<Place...>) { (visit(ReportField<Place>{}), ...); }
  (std::make_index_sequence<kReportFields>{});
}

/// The place of a field in the list, by its name; a name that is not there is an error of compilation.
struct ReportFieldName {
  consteval ReportFieldName(const char* name) : place(kReportFields) {  // NOLINT: a name is meant
    for_each_report_field([&](auto field) {
      if (std::string_view(decltype(field)::kInfo.name) == name) place = decltype(field)::kPlace;
    });
    if (place == kReportFields) throw "no field of the report has this name";
  }
  std::size_t place;
};

}  // namespace tactum::inline v0_1
