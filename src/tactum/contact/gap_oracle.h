#pragma once
/// The queries of a response beyond the patches of a frame: the exact gap of every patch at trial poses, how
/// deep an overlap is along a motion, and when moving bodies first touch. The contact finder decides how
/// answers are found, and what they cost.

#include <cstdint>
#include <span>

#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The state of a query for a patch's distance at other poses.
enum class GapAnswer : std::uint8_t {
  kNotAsked,
  kAsked,
  kExact,  ///< the distance has been computed; of surfaces, or that it is no less than what was searched for
  kElsewhere,  ///< it is that of a contact of the two surfaces which the frame had not found
  kProven,     ///< the motion since the last test proves that it is enough
  kUnknown     ///< the budget was spent
};

/// When moving bodies first touch.
struct FirstImpact {
  double time_s = 0.0;   ///< no two of the queried pieces touch before [s]
  bool complete = true;  ///< false: the budget was spent before all pairs were tested
};

/// Bodies that turn by less in a frame are taken to move on lines in the search for an impact: distance over
/// closing speed then mistakes a distance by at most half this fraction of the margin delta = v_c dt [rad].
inline constexpr double kLeastTurn = 0.025;

/// Whether two bodies turn so much in `dt_s` that the estimate of an impact must not neglect it.
inline bool turns_in(double dt_s, const Twist& V_WA, const Twist& V_WB) noexcept {
  return (V_WA.w.norm() + V_WB.w.norm()) * dt_s > kLeastTurn;
}

/// How a body turns on its path from one pose to another.
struct BodyTurn {
  Vec3 turn = Vec3::Zero();     ///< about which axis and how far, full turns included [rad]
  Vec3 pivot_W = Vec3::Zero();  ///< the point that goes on a line: its origin, or a point of its hinge [m]
};

/// The work of proving paths.
struct PathWork {
  int tests = 0;     ///< nodes and pairs of leaves of surfaces looked at
  int unproven = 0;  ///< pairs of surfaces whose path was tested at its end only
};

/// How two pieces pass each other.
enum class Passing : std::uint8_t {
  kNot,    ///< they meet, or it is not known
  kApart,  ///< with the gap that was asked for
  kSlides  ///< by sliding along each other, through a gap as narrow as one likes
};

class GapOracle {
 public:
  virtual ~GapOracle() = default;
  /// The exact signed distance of the pieces of every patch with the bodies at other poses, near those of the
  /// patches: the distance that a step has to keep positive. `distance` has an entry per patch [m]. A
  /// distance that could not be certified counts as zero at most. Between surfaces it is that of every local
  /// minimum there is at the other poses, entered for the patches of the same features; where there is none,
  /// for the nearest patch, with the answer kElsewhere if that one is not implied. Only minima within a
  /// fraction of the margin are searched there: a patch that has none gets that length, which is then a lower
  /// bound of its distance, with the answer kExact. Patches of met triangles get the distance of all corners
  /// of these, with the answer kElsewhere.
  ///
  /// `asked` has an entry per patch and is answered in place. No test is made, when the budget is not ample,
  /// where the motion since the last one proves that the distance is at least `enough`, nor when only
  /// `keep_back` tests are left: then the distance is the bound. Pairs of the grasped part are tested first.
  /// The patches of two bodies that meet by their surfaces are answered together, so all of them or none must
  /// be asked for. Returns how many tests were made.
  virtual int distances_at(std::span<const Pose> X_WB, std::span<double> distance, std::span<GapAnswer> asked,
                           std::span<const double> enough, int keep_back) noexcept = 0;
  /// The depth of an overlapping patch along a motion: how far A must move along unit `direction_W` until the
  /// two pieces of the patch are apart [m]. Where they separate at a wall between pieces of a part, which
  /// nothing can touch, it is the distance out through the plane of the patch instead. `patch` is the number
  /// of a patch of this frame, and the bodies are at the poses where it was found. Zero where no depth is
  /// known: for surfaces without pieces, for a motion that never separates them, and where no test is left.
  /// One test.
  virtual double depth_along(int patch, std::span<const Pose> X_WB, const Vec3& direction_W) noexcept = 0;
  /// When the first two pieces touch, if every body moves as advanced(X_WB, V_WB, t), turns included; `dt_s`
  /// when none does by then. Tested are the pairs of pieces that this frame found apart and within the
  /// margin, of bodies that turn (turns_in), with the bodies where they were found; surfaces without pieces
  /// are not. The time is that of the contact to rounding; where that takes too many steps, before it. Costs
  /// the tests of time_of_impact.h for pairs that may touch in that time, and nothing for others.
  virtual FirstImpact first_impact(std::span<const Pose> X_WB, std::span<const Twist> V_WB,
                                   double dt_s) noexcept = 0;
  /// Whether the two pieces of a patch stay apart, by more than `gap_m`, or slide along each other, while
  /// their bodies move for `dt_s` as advanced(X_WB, V_WB, t), from the poses where the patch was found. Of
  /// surfaces it is asked of all that the two bodies have: they stay apart, and where they turn they end with
  /// that gap; of a ball on a surface it is asked of the triangle at the contact. Not known where no test is
  /// left. Costs the tests of time_of_impact.h, or of surface_path.h once a frame for two bodies.
  virtual Passing passes(int patch, std::span<const Pose> X_WB, std::span<const Twist> V_WB, double dt_s,
                         double gap_m) noexcept = 0;
  /// How far bodies may go on their paths from where the frame found them to other poses without touching:
  /// the path is proven, not its end, with any turn. `turn` has an entry per body, and `asked` whether it is
  /// asked for. `free[i]` becomes the fraction of the path of body i that is proven, 1 for the others. Pairs
  /// of pieces that overlap already are left out. Pieces cost next to nothing: what the frame has found near
  /// settles nearly all of them. Of surfaces whose proof would take more than `most_tests` nothing is proven,
  /// for a while, but what distances_at() finds at the end.
  virtual PathWork prove_paths(std::span<const Pose> X_WB, std::span<const BodyTurn> turn,
                               std::span<const char> asked, int most_tests,
                               std::span<double> free) noexcept = 0;
  /// Whether something found no memory in this frame, in a trial too.
  virtual bool capacity_reached() const noexcept = 0;
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

}  // namespace tactum::inline v0_1
