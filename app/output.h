#pragma once
/// Output functions common to several subcommands.

#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "tactum/session/session.h"
#include "tactum/telemetry/statistics.h"

namespace tactum {

/// mean, p50, p99, p999, max in microseconds.
nlohmann::ordered_json summary_us(const Summary& summary);

/// Sixteen hexadecimal digits.
std::string hash_text(std::uint64_t hash);

/// In how many frames of a run bodies overlapped, and who says so.
struct OverlapVerdict {
  std::uint64_t frames = 0;
  std::uint64_t judged_frames = 0;
  bool by_referee = false;  ///< else by the gaps that the response found at the ends of its steps

  /// "the referee", or "the gaps at the ends of steps".
  const char* judge() const { return by_referee ? "the referee" : "the gaps at the ends of steps"; }
};

/// The verdict of the gaps of the run.
OverlapVerdict overlaps_by_gaps(const Session& session);

/// The run for a person: wrench, contact, times, goals.
void print_summary(std::FILE* out, const Session& session, const OverlapVerdict& overlaps,
                   const Summary& frame_times, const StageClock& stages);

/// The same for machines.
nlohmann::ordered_json summary_json(const Session& session, const OverlapVerdict& overlaps,
                                    const Summary& frame_times, const StageClock& stages);

}  // namespace tactum
