#pragma once
/// What a response may ask beyond the patches of a frame: the exact gap of every patch at poses on trial, and
/// how deep an overlap is along a motion. How answers are found, and what they cost, is the contact finder's
/// business.

#include <cstdint>
#include <span>

#include "tactum/math/pose.h"

namespace tactum {

/// What is asked and known of a patch's distance at other poses.
enum class GapAnswer : std::uint8_t {
  kNotAsked,
  kAsked,
  kExact,   ///< the distance has been computed
  kProven,  ///< what has moved since it was computed proves that it is enough
  kUnknown  ///< the budget was spent
};

class GapOracle {
 public:
  virtual ~GapOracle() = default;
  /// The exact signed distance of the pieces of every patch with the bodies at other poses, near those of
  /// the patches: what a step has to keep positive. `distance` has an entry per patch [m]. A distance that
  /// could not be certified counts as none. Between surfaces it is that of every local minimum there is at
  /// the other poses, told by the patches of the same features; where there is none, by the nearest patch.
  ///
  /// `asked` has an entry per patch and is answered in place. No test is made, when the budget is not ample,
  /// where what moved since the last one proves that the distance is at least `enough`, nor when only
  /// `keep_back` tests are left: then the distance is the bound. Pairs of the held part are asked first.
  /// Returns how many tests were made.
  virtual int distances_at(std::span<const Pose> X_WB, std::span<double> distance, std::span<GapAnswer> asked,
                           std::span<const double> enough, int keep_back) noexcept = 0;
  /// The depth of an overlapping patch along a motion: how far A must move along unit `direction_W` until
  /// the two pieces of the patch are apart [m]. Where they come apart at a wall between pieces of a part,
  /// which nothing can touch, it is the distance out through the plane of the patch instead. `patch` is the
  /// number of a patch of this frame, and the bodies are where it was found. Zero where no depth is known:
  /// for surfaces without pieces, for a motion that leads no way out, and where no test is left. One test.
  virtual double depth_along(int patch, std::span<const Pose> X_WB, const Vec3& direction_W) noexcept = 0;
  /// Exact tests that are left of the frame's budget.
  virtual int tests_left() const noexcept = 0;
  /// Whether the budget was not ample in this frame.
  virtual bool budget_limited() const noexcept = 0;
  /// Whether some pair of the body was left unproven: it may only stay where it is.
  virtual bool blocked(int body) const noexcept = 0;

 protected:
  GapOracle() = default;
  GapOracle(const GapOracle&) = default;
  GapOracle(GapOracle&&) = default;
  GapOracle& operator=(const GapOracle&) = default;
  GapOracle& operator=(GapOracle&&) = default;
};

}  // namespace tactum
