#pragma once
/// What a response may ask about poses on trial: the exact gap of every contact patch there. The answers are
/// what lets a step be taken or not; how they are found, and what they cost, is the contact finder's
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
