#pragma once
/// Real-time scheduling, paper 4.2: which pairs go first when more are near than a frame may test. The length
/// of the array is a work budget, an input of the frame and never a clock reading, so that a cut-short frame
/// replays exactly. From the first to the last:
///
///   pairs of the grasped part            always: the forces that the hand feels are never guessed
///   pairs of bodies that touch it        the hand feels them next
///   of the others, by time since the last check; to have been in contact counts as kHeadStart_s more
///
/// The paper puts all pairs in contact before all others. In a heap there are always more of them than the
/// array holds, and the others would never be tested; with a head start every pair is tested some time.

#include <cstdint>
#include <span>

namespace tactum::inline v0_1 {

/// The priority of a body's pairs: of the grasped part, of bodies that touch it, of the rest.
namespace priority {
inline constexpr std::uint8_t kGrasped = 0, kTouchesGrasped = 1, kOther = 2;
}  // namespace priority

/// A pair that may need an exact test this frame.
struct DuePair {
  std::int32_t pair = -1;                    ///< index into the finder's pairs
  std::uint8_t priority = priority::kOther;  ///< the higher of its bodies' priorities, a lower number
  bool was_in_contact = false;               ///< in the last frame
  std::int64_t last_checked = -1;            ///< frame number of its last exact test
};

inline constexpr double kHeadStart_s = 0.008;  ///< [s]

/// Moves the `budget` pairs of the highest priority to the front, in their original order among themselves,
/// and returns how many those are: min(budget, due.size()). `head_start` is kHeadStart_s in frames. Cost:
/// linear in expectation.
int prioritise(std::span<DuePair> due, int budget, int head_start) noexcept;

}  // namespace tactum::inline v0_1
