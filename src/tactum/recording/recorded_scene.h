#pragma once
/// The scene inside a recording, ready to be stepped.

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tactum/haptics/simulation.h"
#include "tactum/recording/frame_slot.h"
#include "tactum/recording/run_head.h"
#include "tactum/scene/goal.h"

namespace tactum::inline v0_1 {

/// Other settings than those of the recording, for comparison.
struct ReplayOptions {
  std::string response = {};  ///< "constraint" or "penalty"; empty: the recorded one
  std::string settings = {};  ///< a file as of `tactum feel --settings`, put over the scene's; empty: none
  std::vector<std::pair<int, double>> changed = {};  ///< places in setting_table(), and values put over all
  double from_s = 0.0;  ///< begins at the last snapshot up to there, at the start where there is none [s]
};

struct RecordedScene {
  /// Puts the user's limits on those of the devices.
  void tighten(FrameSettings& settings) const;
  /// Goes on from a snapshot of this recording, with the settings in force then, unless others are asked for.
  /// An error where it is of another program or response.
  Result<void> restore(const RecordedSnapshot& snapshot, const ReplayOptions& options,
                       const std::string& where);

  std::string name, description;
  std::unique_ptr<Simulation> simulation;
  SafetySettings safety;                    ///< the user's limits
  std::vector<SafetyLimits> device_limits;  ///< which they tighten, by hand
  std::vector<Goal> goals;                  ///< of the scene
  std::vector<std::string> notes;           ///< ReplayResult::notes
};

/// Builds it from the files of the recording, by the names of their attachments. They are unpacked into a
/// folder of its own under the system's for temporary files, which is gone when this returns.
Result<RecordedScene> build_recorded(const RunHead& head, const std::map<std::string, std::string>& files,
                                     const ReplayOptions& options, const std::string& where);

}  // namespace tactum::inline v0_1
