#pragma once
/// Output functions common to several subcommands.

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

/// The run for a person: wrench, contact, times, goals.
void print_summary(std::FILE* out, const Session& session, const Summary& frame_times,
                   const StageClock& stages);

/// The same for machines.
nlohmann::ordered_json summary_json(const Session& session, const Summary& frame_times,
                                    const StageClock& stages);

}  // namespace tactum
