#include "output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>

namespace tactum {
namespace {

double mean(double sum, std::uint64_t count) { return count == 0 ? 0.0 : sum / static_cast<double>(count); }

/// The settings that kept the held part behind the hand.
std::string limits_of(std::uint32_t flags, ResponseModel response) {
  std::vector<const char*> limits;
  if (flags & frame_flag::kStepLimited)
    limits.push_back(response == ResponseModel::kPenalty ? "penalty.max_step_m" : "constraint.max_step_m");
  if (flags & frame_flag::kTurnLimited) limits.push_back("constraint.max_turn_deg");
  return fmt::format("{}", fmt::join(limits, " and "));
}

/// Frame flags as sentences that name the setting to raise.
std::vector<std::string> frame_notes(const Session& session) {
  const RunRecord& record = session.record();
  std::vector<std::string> notes;
  if (record.flags & frame_flag::kBudgetShort)
    notes.push_back(fmt::format(
        "{} pair checks were left out, {} of them without a proof that nothing could touch; bodies waited "
        "{} times: raise max_exact_tests",
        record.sum("work.unchecked"), record.sum("work.left_unproven"), record.sum("waiting")));
  if (record.flags & frame_flag::kCapacityReached)
    notes.emplace_back("near pairs or patches were dropped: capacity reached");
  if (record.flags & frame_flag::kPointsFull)
    notes.emplace_back("contact points were dropped: raise max_contact_points");
  if (record.flags & frame_flag::kSolverBounded)
    notes.emplace_back("the contact solver did not always converge: raise solver_iterations");
  if (record.flags & frame_flag::kUncertified)
    notes.push_back(fmt::format("{} distances had no certificate", record.sum("work.uncertified")));
  if (record.flags & frame_flag::kPathUnproven)
    notes.push_back(
        fmt::format("{} steps of two surfaces were tested at their ends only, those of the held part kept "
                    "short: raise max_path_tests",
                    record.sum("unproven_paths")));
  if (record.lagging_frames > 0)
    notes.push_back(fmt::format(
        "in {} of {} frames the held part lagged behind a hand that was faster than it may follow: raise {}",
        record.lagging_frames, record.frames, limits_of(record.flags, session.scene().settings.response)));
  return notes;
}

/// The faults for which the last stage before the device has sent no wrench, by name.
std::vector<std::string> safety_events(std::uint32_t flags) {
  std::vector<std::string> events;
  const std::uint32_t faults = flags & safety_flag::kFaults;
  for (int bit = 0; bit < 32; ++bit)
    if (const std::uint32_t flag = 1u << bit; (faults & flag) != 0) events.push_back(safety_flag_names(flag));
  return events;
}

/// Sums and largest values of the report's fields, by the last part of their names.
void add_fields(const RunRecord& record, nlohmann::ordered_json& json) {
  for_each_report_field([&](auto field) {
    using Field = decltype(field);
    const std::string_view name = Field::kInfo.name;
    const std::string key(name.substr(name.rfind('.') + 1));  // npos + 1 is the beginning
    const double largest = record.largest_at(Field::kPlace);
    if constexpr (Field::kInfo.in_run == InRun::kSum) {
      json[key] = record.sum_at(Field::kPlace);
      json["max_" + key] = static_cast<std::uint64_t>(largest);
    } else if constexpr (Field::kInfo.in_run == InRun::kLargest) {
      json["max_" + key] = largest;
    }
  });
}

}  // namespace

nlohmann::ordered_json summary_us(const Summary& summary) {
  return {{"mean", summary.mean_ns * 1e-3},
          {"p50", summary.p50_ns * 1e-3},
          {"p99", summary.p99_ns * 1e-3},
          {"p999", summary.p999_ns * 1e-3},
          {"max", summary.max_ns * 1e-3}};
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

OverlapVerdict overlaps_by_gaps(const Session& session) {
  const RunRecord& record = session.record();
  return {record.penetrating_frames, record.frames, false};
}

void print_summary(std::FILE* out, const Session& session, const OverlapVerdict& overlaps,
                   const Summary& times, const StageClock& stages) {
  const RunRecord& record = session.record();
  fmt::print(out, "\nforce            mean {:8.3f} N     max {:8.3f} N     largest step {:.3f} N\n",
             mean(record.sum_force_N, record.frames), record.max_force_N, record.max_force_step_N);
  fmt::print(out, "torque           mean {:8.3f} mN m  max {:8.3f} mN m  largest step {:.3f} mN m\n",
             mean(record.sum_torque_Nm, record.frames) * 1e3, record.max_torque_Nm * 1e3,
             record.max_torque_step_Nm * 1e3);
  for (std::size_t i = 0; i < record.other_hands.size(); ++i) {
    const HandRun& hand = record.other_hands[i];
    fmt::print(out, "hand {}           max {:8.3f} N  {:8.3f} mN m  largest step {:.3f} N, on {}\n", i + 2,
               hand.max_force_N, hand.max_torque_Nm * 1e3, hand.max_force_step_N,
               session.device_of(i + 1).name);
  }
  fmt::print(out,
             "contact          {} of {} frames; penetrating in {} of {} frames judged by {}; deepest overlap "
             "of a pair {:.4f} mm\n",
             record.colliding_frames, record.frames, overlaps.frames, overlaps.judged_frames,
             overlaps.judge(), record.max_penetration_m * 1e3);
  if (record.max_momentum_off_Ns > 0.0)
    fmt::print(out, "momentum         of free bodies kept to {:.1e} N s; {} frames with a step cut short\n",
               record.max_momentum_off_Ns, record.forced_short_frames);
  fmt::print(out, "frame            mean {:.1f} us   p50 {:.1f}   p99 {:.1f}   p99.9 {:.1f}   max {:.1f}\n",
             times.mean_ns * 1e-3, times.p50_ns * 1e-3, times.p99_ns * 1e-3, times.p999_ns * 1e-3,
             times.max_ns * 1e-3);
  fmt::print(out, "{}", table_of(stages.summaries()));
  fmt::print(
      out,
      "work             {} bodies; mean {:.1f} exact tests, {:.1f} contact pairs; at most {} tests a frame, "
      "{} "
      "pairs unchecked\n",
      record.largest("work.bodies"),
      mean(static_cast<double>(record.sum("work.exact_tests") + record.sum("validation_tests")),
           record.frames),
      mean(static_cast<double>(record.sum("work.patches")), record.frames), record.max_tests,
      record.largest("work.unchecked"));
  if (record.sum("work.surface_queries") > 0)
    fmt::print(
        out,
        "surfaces         {} queries: mean {:.0f} minima, at most {} a frame; mean {:.0f} feature pairs\n",
        record.sum("work.surface_queries"),
        mean(static_cast<double>(record.sum("work.minima")), record.sum("work.surface_queries")),
        record.largest("work.minima"),
        mean(static_cast<double>(record.sum("work.feature_steps")), record.sum("work.surface_queries")));
  const LoopStatus loop = session.loop_status();
  if (loop.frames > 0)
    fmt::print(out, "loop             {} frames, {} missed deadlines, {} late\n", loop.frames,
               loop.missed_deadlines, loop.late_frames);
  if (record.non_finite_frames > 0)
    fmt::print(out, "WRONG            {} frames computed a wrench that is not finite\n",
               record.non_finite_frames);
  if (const std::vector<std::string> events = safety_events(record.safety); !events.empty())
    fmt::print(out, "safety           the wrench was zero for a while: {}; see docs/safety.md\n",
               fmt::join(events, ", "));
  for (const std::string& note : frame_notes(session)) fmt::print(out, "note             {}\n", note);
  for (std::size_t i = 0; i < session.scene().goals.size(); ++i)
    fmt::print(out, "goal             {}\n", session.goals().describe(session.scene().world, i));
  if (loop.frames == 0)
    fmt::print(out, "frames' hash     {}\n", hash_text(record.hash()));  // of a virtual run
}

nlohmann::ordered_json summary_json(const Session& session, const OverlapVerdict& overlaps,
                                    const Summary& times, const StageClock& stages) {
  const RunRecord& record = session.record();
  nlohmann::ordered_json goals = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < session.scene().goals.size(); ++i)
    goals.push_back(
        {{"met", session.goals().met(i)}, {"what", session.goals().describe(session.scene().world, i)}});
  nlohmann::ordered_json stages_us;
  for (const StageSummary& stage : stages.summaries()) stages_us[stage.name] = summary_us(stage.summary);
  const LoopStatus loop = session.loop_status();
  nlohmann::ordered_json json = {{"scene", session.scene().name},
                                 {"device", session.device().name},
                                 {"rate_Hz", session.rate_Hz()},
                                 {"frames", record.frames},
                                 {"colliding_frames", record.colliding_frames},
                                 {"penetrating_frames", overlaps.frames},
                                 {"penetrating_judge", overlaps.judge()},
                                 {"penetrating_judged_frames", overlaps.judged_frames},
                                 {"max_penetration_m", record.max_penetration_m},
                                 {"mean_force_N", mean(record.sum_force_N, record.frames)},
                                 {"max_force_N", record.max_force_N},
                                 {"max_force_step_N", record.max_force_step_N},
                                 {"mean_torque_Nm", mean(record.sum_torque_Nm, record.frames)},
                                 {"max_torque_Nm", record.max_torque_Nm},
                                 {"max_torque_step_Nm", record.max_torque_step_Nm},
                                 {"max_momentum_off_Ns", record.max_momentum_off_Ns},
                                 {"forced_short_frames", record.forced_short_frames},
                                 {"lagging_frames", record.lagging_frames},
                                 {"non_finite_frames", record.non_finite_frames},
                                 {"max_tests", record.max_tests},
                                 {"missed_deadlines", loop.missed_deadlines},
                                 {"frame_us", summary_us(times)},
                                 {"stages_us", stages_us},
                                 {"safety_events", safety_events(record.safety)},
                                 {"notes", frame_notes(session)},
                                 {"goals", goals},
                                 {"goal_met", session.goals().all_met()},
                                 {"frame_hash", hash_text(record.hash())}};
  add_fields(record, json);
  for (std::size_t i = 0; i < record.other_hands.size(); ++i) {
    const HandRun& hand = record.other_hands[i];
    json["other_hands"].push_back({{"device", session.device_of(i + 1).name},
                                   {"grasped_contact_frames", hand.grasped_contact_frames},
                                   {"max_force_N", hand.max_force_N},
                                   {"max_force_step_N", hand.max_force_step_N},
                                   {"max_torque_Nm", hand.max_torque_Nm},
                                   {"safety_events", safety_events(hand.safety)}});
  }
  return json;
}

}  // namespace tactum
