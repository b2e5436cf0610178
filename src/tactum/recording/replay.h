#pragma once
/// The same frames again, from a recording alone: the scene and its parts are those inside the file, the
/// device is what the device told, frame by frame. Where nothing else is asked for, every bit is the same,
/// with every compiler and build type.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactum/recording/frame_difference.h"
#include "tactum/recording/mcap_reader.h"
#include "tactum/recording/recorded_scene.h"
#include "tactum/recording/run_head.h"

namespace tactum::inline v0_1 {

/// What a run comes to, as recorded or as replayed.
struct RunExtremes {
  double max_force_N = 0.0;          ///< sent [N]
  double max_torque_Nm = 0.0;        ///< sent [N m]
  double max_stretch_m = 0.0;        ///< hand to proxy, while something is held [m]
  std::uint64_t contact_frames = 0;  ///< in which something pushed the held part
};

struct ReplayResult {
  std::uint64_t first = 0;   ///< the frame that it began with
  std::uint64_t frames = 0;  ///< replayed
  std::uint64_t same = 0;    ///< of them, the same to the bit, from the first on
  std::uint64_t states = 0;  ///< snapshots that were compared, and are the same to the bit
  std::optional<FrameDifference> difference;
  std::optional<std::uint64_t> gap;  ///< the frame before which some were not recorded: the replay ends there
  RunExtremes recorded, replayed;
  RunHead head;
  std::vector<std::string> notes;  ///< settings that were changed before the start, as sentences
  McapEnd end;                     ///< how the file ended
};

/// An error where nothing can be replayed: no head, a file that is not the recorded one, a scene that does
/// not build. `name` is the file's, for errors.
Result<ReplayResult> replay(const McapSource& source, const std::string& name, const ReplayOptions& options);

}  // namespace tactum::inline v0_1
