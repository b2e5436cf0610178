#pragma once
/// Two computations of the same run, side by side, down to the first frame, stage and field in which they
/// differ: two recordings, as of two builds; or a recording replayed with other settings, and which of them
/// it is.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactum/recording/frame_difference.h"
#include "tactum/recording/mcap_reader.h"
#include "tactum/recording/recorded_scene.h"

namespace tactum::inline v0_1 {

/// A setting that differs between the two sides.
struct DifferingSetting {
  std::string key;
  double before = 0.0, after = 0.0;
  /// With this one changed alone: what differs first. None: no frame does. Not looked for between recordings.
  std::optional<FrameDifference> alone;
};

struct Bisection {
  std::uint64_t frames = 0;  ///< that are the same on both sides, from the first on
  std::optional<FrameDifference> difference;
  std::vector<DifferingSetting> settings;
  std::vector<std::string> notes;  ///< what else the two recordings say differently, as sentences
};

/// Compares the frames as they were recorded. An error where one of the files is no recording, or they have
/// no frame in common. `name` is a file's, for errors.
Result<Bisection> bisect_recordings(const McapSource& before, const std::string& name_before,
                                    const McapSource& after, const std::string& name_after);

/// Replays the recording with both options, and with each setting that differs alone.
Result<Bisection> bisect_settings(const McapSource& source, const std::string& name,
                                  const ReplayOptions& before, const ReplayOptions& after);

}  // namespace tactum::inline v0_1
