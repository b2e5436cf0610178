#pragma once
/// Real-time scheduling, paper 4.2: when more pairs are near than a frame may check, which go first? Pairs in
/// contact in the last frame, then those unchecked for longest; greedily into an array of fixed length. The
/// length is a work budget, an input of the frame and never a clock reading, so that a cut-short frame
/// replays exactly.

#include <cstdint>
#include <span>

namespace tactum {

/// A pair that may need an exact test this frame.
struct DuePair {
  std::int32_t pair = -1;          ///< index into the finder's pairs
  bool was_in_contact = false;     ///< in the last frame
  std::int64_t last_checked = -1;  ///< frame number of its last exact test
};

/// Moves the `budget` most urgent pairs to the front, in their original order among themselves, and returns
/// how many those are: min(budget, due.size()). Linear in expectation.
int prioritise(std::span<DuePair> due, int budget) noexcept;

}  // namespace tactum
