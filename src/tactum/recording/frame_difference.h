#pragma once
/// The first thing in which two computations of a frame differ.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactum/recording/frame_slot.h"

namespace tactum::inline v0_1 {

/// Where a run left another one: the first frame, and in it the first field in the order of the stages.
struct FrameDifference {
  std::uint64_t frame = 0;
  std::string stage;    ///< stage_name(), of the frame; "input": what came into it
  std::string field;    ///< "shown_fx_N"; empty: only state that is in no report differs
  std::string meaning;  ///< of the field
  double before = 0.0;  ///< its values: of the first run, as recorded ...
  double after = 0.0;   ///< ... and of the second, as replayed
  std::string carried;  ///< where the field is empty: the part of the state, as words, if it is known
};

/// Of two reports as numbers (put_report); none where all bits are the same.
std::optional<FrameDifference> difference_of(std::uint64_t frame, const std::vector<double>& before,
                                             const std::vector<double>& after);

/// Of what came into a frame, from the device and the loop.
std::optional<FrameDifference> difference_of(const RecordedInput& before, const RecordedInput& after);
/// Of what came in from a further hand, and of what the frame reports of it; the field begins with h2_ for
/// the second hand, and so on.
std::optional<FrameDifference> difference_of(const RecordedHand& before, const RecordedHand& after);

/// "frame 12 is the first that differs: stage "response", field ...", without a full stop.
std::string sentence_of(const FrameDifference& difference);

}  // namespace tactum::inline v0_1
