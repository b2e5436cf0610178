#pragma once
/// Scheduling: the effect of a work budget. A heap of jacks (heap.h) is stirred by a hand that is led, once
/// for each budget, given as a fraction of the most pairs that are near at once.
///
///   force error     the same frame computed again from a copy of the state, with all the budget it wants
///   overlap         by all separating axes of every pair of pieces, in frames picked evenly
///   times           of the frame alone; p50 and p99 over all frames of one run
///
/// And the paper's bound of a frame's time, T_h = N t_s + K t_c + M t_f [Gregory 2000, 4.2]: constants by
/// least squares of relative errors over frames of heaps of several sizes, each frame with its fastest of
/// identical replays. Beside it, the same with a fourth term for the additional work of this response:
/// contact points times sweeps.

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/report.h"
#include "tactum/base/result.h"

namespace tactum::bench {

struct ScheduleOptions {
  int bodies = 200;                                         ///< that fall [-]
  double seconds = 0.0;                                     ///< of the motion; 0: all of it [s]
  std::vector<double> shares = {1.0, 0.5, 0.2, 0.1, 0.05};  ///< of the pairs [-]
  int replays = 3;                                          ///< for the model [-]
  int looks = 40;  ///< frames of each run that the referee checks [-]
};

/// One run with one budget.
struct ScheduleRow {
  double share = 0.0;
  int budget = 0, most_near = 0, most_tests = 0, left_of_grasped = 0;
  int frames = 0, grasped_frames = 0;  ///< ... with contact of the grasped part
  double force_error_mean_N = 0.0,
         force_error_max_N = 0.0;  ///< over frames with contact of the grasped part [N]
  double unchecked_mean = 0.0, unproven_mean = 0.0, waiting_mean = 0.0;
  int unchecked_max = 0, unproven_max = 0, longest_unchecked = 0, longest_wait = 0;
  int unchecked_at_end = 0;           ///< in the last frame
  double fastest_at_end = 0.0;        ///< body in the last frame [m/s]
  double overlap_m = 0.0;             ///< worst that the referee found [m]
  double overlap_of_grasped_m = 0.0;  ///< [m]
  double p50_us = 0.0, p99_us = 0.0;  ///< [us]
  std::uint64_t frame_hash = 0;       ///< of what every frame computed
};

/// The model of a frame's time.
struct TimeModel {
  std::array<double, 4> constants_ns{};           ///< t_s, t_c, t_f, and of a contact point's sweep [ns]
  double typical_error = 0.0, worst_error = 0.0;  ///< median and largest of |predicted / measured - 1| [-]
};
struct ModelRow {
  int bodies = 0;
  double pieces = 0.0, tests = 0.0, patches = 0.0, sweeps = 0.0;  ///< means over frames
  double measured_us = 0.0, paper_us = 0.0, swept_us = 0.0;       ///< means [us]
};
struct ScheduleReport {
  std::vector<ScheduleRow> rows;
  std::vector<ModelRow> heaps;
  TimeModel paper, swept;
  int model_frames = 0;
};

Result<ScheduleReport> bench_schedule(const ScheduleOptions& options,
                                      const std::function<void(const std::string&)>& progress);

nlohmann::ordered_json to_json(const ScheduleReport& report);
Table table_of(const std::vector<ScheduleRow>& rows);
Table table_of(const std::vector<ModelRow>& rows);
/// The constants and how far off they are, in sentences.
std::string describe(const ScheduleReport& report);

}  // namespace tactum::bench
