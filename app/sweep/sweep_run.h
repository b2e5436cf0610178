#pragma once
/// One run of a sweep, and what is kept of it.

#include <array>
#include <cstdint>
#include <string>

#include "app/sweep/sweep_plan.h"

namespace tactum {

/// A number that is kept of every run.
struct SweepMetric {
  const char* name;  ///< its end is the unit
  const char* unit;
  const char* meaning;
};

inline constexpr std::array kSweepMetrics = {
    SweepMetric{"success", "1", "1 when all goals of the scene were met at the end, else 0"},
    SweepMetric{"success_time_s", "s", "when they were; not a number without success"},
    SweepMetric{"peak_force_N", "N", "largest force sent to the device"},
    SweepMetric{"peak_torque_Nm", "N m", "largest torque sent to the device"},
    SweepMetric{"mean_force_N", "N", "mean of the magnitude of the force sent"},
    SweepMetric{"contact_share", "1", "share of the frames in which something pushed the grasped part"},
    SweepMetric{"jam_s", "s", "how long the grasped part was jammed, as the sweep's [jam] says"},
    SweepMetric{"longest_jam_s", "s", "the longest time on end that it was"},
    SweepMetric{"jam_px_m", "m",
                "where the handle was when that began, x of the world; not a number without"},
    SweepMetric{"jam_py_m", "m", "the same, y"},
    SweepMetric{"jam_pz_m", "m", "the same, z"},
    SweepMetric{"largest_stretch_m", "m", "largest distance of hand and proxy"},
    SweepMetric{"first_goal", "SI", "the number that decides the first goal: an angle, a way or a distance"},
    SweepMetric{"penetrating_frames", "1", "frames in which pieces overlapped"},
    SweepMetric{"energy_from_hand_J", "J", "work of the hand on the scene"},
    SweepMetric{"energy_to_hand_J", "J", "work of the scene on the hand"},
    SweepMetric{"energy_generated_J", "J", "energy that came out and that nobody had put in"},
    SweepMetric{"slipping", "1", "pairs of surfaces that slid, summed over the frames"},
    SweepMetric{"lagging_frames", "1", "frames in which the part lagged behind a hand that was too fast"},
    SweepMetric{"frames", "1", "frames of the run"},
};

struct SweepResult {
  std::uint64_t run = 0;
  std::array<double, kSweepMetrics.size()> numbers{};  ///< as kSweepMetrics; none is a number after an error
  std::uint64_t hash = 0;                              ///< of all frames: equal bits everywhere
  std::string error;                                   ///< why there was no run; empty: there was one
};

/// Builds the scene of a run and plays it on the virtual clock. Depends on nothing but the plan and the
/// number: any thread of any machine gives the same bits. Safe to call from several threads.
SweepResult run_of_sweep(const SweepPlan& plan, std::uint64_t run);

}  // namespace tactum
