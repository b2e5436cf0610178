#pragma once
/// What `tactum sweep` computes: one scene or recording, many times, over a grid of values of its keys. Read
/// from a TOML file, which docs/sweep.md explains.

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "tactum/recording/recording_visitor.h"
#include "tactum/scene/scene_description.h"

namespace tactum {

/// A value of an axis; it keeps the type that the file has for it.
using SweepValue = std::variant<std::int64_t, double, bool, std::string>;

/// Values that one or more keys of the scene take in turn.
struct SweepAxis {
  std::string name;                ///< of its column in the result; its end is the unit
  std::vector<std::string> paths;  ///< "body[block].part.hole_block.clearance_m"
  std::vector<SweepValue> values;
};

/// When a run counts as jammed: not all goals are met, the grasped part is pushed, the coupling pulls it with
/// at least the force, and it moves no faster than the speed.
struct JamRule {
  double force_N = 1.0;
  double speed_m_per_s = 0.001;
};

/// A recording, whose hand is led through other scenes: everything of it that a run needs.
struct SweptRecording {
  RunHead head;
  std::map<std::string, std::string> files;  ///< by their attachments
  std::vector<RecordedInput> inputs;         ///< up to the first frame that is missing
  std::vector<HandSample> others;            ///< of the second hand and all after it, frame by frame
  std::vector<RecordedCommand> commands;     ///< settings that were changed, in order
};

struct SweepPlan {
  std::string file, text;  ///< the sweep's own
  std::string description;
  std::string scene_name, scene_text;
  SceneSource source;  ///< of the scene: for errors, and where its files are looked for
  std::shared_ptr<const SweptRecording> recording;  ///< null: the scene's own hand moves
  double duration_s = 0.0;                          ///< of a run; 0: as long as the hand's motion [s]
  JamRule jam;
  std::vector<SweepAxis> axes;
  std::uint64_t hash = 0;  ///< of everything that decides the results

  /// How many runs there are: the product of the axes' lengths.
  std::uint64_t runs() const;
  /// The value's place on each axis; the first axis changes last.
  std::vector<std::size_t> places(std::uint64_t run) const;
};

/// Reads a sweep and the scene or recording it names, which is looked for beside the file. An error names
/// file, line and column.
Result<SweepPlan> read_sweep(const std::string& path);

/// The text of the scene of a run. An error names the path that leads nowhere.
Result<std::string> scene_text_of(const SweepPlan& plan, std::uint64_t run);

/// The values of a run as people read them: "clearance_m = 0.0001, tilt_deg = 2".
std::string values_of(const SweepPlan& plan, std::uint64_t run);

/// The scene's text with the value at a path: keys with dots between, and behind the key of a list its
/// place counted from 0, or the name of the item, in brackets. Tables that are not there are made.
Result<std::string> with_value(const std::string& scene_text, const std::string& path,
                               const SweepValue& value);

}  // namespace tactum
