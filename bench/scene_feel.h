#pragma once
/// What reaches the hand: every shipped scene on every device preset, in every hand, with both responses, and
/// what each stage makes of the wrench. Judged from the trace of the run, outside the ramps:
///
///   steps          changes of the force from frame to frame by more than 0.05 N
///   to and fro     two steps in turn that go against each other, both above 0.02 N
///   unexplained    steps of the smoothed force that the hand's own motion cannot have made: more than the
///                  coupling's stiffness times the displacement of the hand, within the last 10 ms
///   changed        frames in which the sent wrench is not the smoothed one: off by 0.01 N or 0.2 mN m
///   beyond slew    steps of the sent wrench beyond the device's slew limit, ramps included
///   generated      energy, by the referee (bench/port_referee.h)

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/report.h"
#include "tactum/base/result.h"
#include "tactum/scene/scene.h"

namespace tactum::bench {

/// Of the wrench after one stage.
struct StageSteps {
  double largest_N = 0.0;       ///< step [N]
  double largest_Nm = 0.0;      ///< ... of the torque [N m]
  long steps = 0;               ///< above 0.05 N
  long to_and_fro = 0;          ///< above 0.02 N
  double largest_turn_N = 0.0;  ///< the smaller of two steps in turn that go against each other, at most [N]
};

struct SceneFeelRow {
  std::string scene, device, hand, response;
  long frames = 0;  ///< outside the ramps
  StageSteps computed, smoothed, sent;
  long unexplained = 0;                ///< steps of the smoothed force
  long changed = 0;                    ///< frames
  long beyond_slew = 0;                ///< frames
  double generated_J = 0.0;            ///< [J]
  double generated_by_motors_J = 0.0;  ///< without what the device's damping and friction eat [J]
  double deepest_fall_J = 0.0;         ///< of the referee's balance [J]
  double least_share = 1.0;            ///< of the coupling's stiffness [-]
};

struct SceneFeelOptions {
  std::vector<std::string> scenes;     ///< names or files; empty: every shipped one
  std::vector<std::string> devices;    ///< presets; empty: all
  std::vector<std::string> hands;      ///< grips; empty: all
  std::vector<std::string> responses;  ///< empty: both
  double most_s = 0.0;                 ///< at most so much of a scene's motion; 0: all of it [s]
};

/// One run.
Result<SceneFeelRow> feel_scene(Scene scene, const std::string& device, const std::string& hand,
                                double most_s = 0.0);

Result<std::vector<SceneFeelRow>> bench_scene_feel(const SceneFeelOptions& options,
                                                   const std::function<void(const std::string&)>& progress);

Table table_of(const std::vector<SceneFeelRow>& rows);
nlohmann::ordered_json to_json(const SceneFeelRow& row);

}  // namespace tactum::bench
