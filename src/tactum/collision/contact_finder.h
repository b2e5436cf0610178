#pragma once
/// Where do the bodies touch? The first half of a frame, from poses to contact patches, in three steps:
///
///   bodies  --- sweep and prune --->  near bodies  --- hierarchies --->  near pieces  --- exact tests --->
///   patches
///
/// Bodies made of convex pieces meet piece by piece, by tracked pairs. Where either has none, both meet by
/// their surfaces: every local minimum of distance is a patch of one point (surface_minima.h).
///
/// What holds from frame to frame is kept: no step is repeated while a bound on the motion proves that its
/// answer cannot have changed. Every body carries an odometer, `travel`: no point of it has moved farther
/// than that since the start. A list of pairs made with reach R at the odometers' sum S0 holds all pairs
/// within `tolerance` while  (S - S0) + tolerance <= R;  a pair found d apart at S0 needs no test while  d -
/// (S - S0) > tolerance. Both are proofs, not guesses; they are what makes a frame with coherent motion
/// cheap.
///
/// Exact tests are bounded by a budget (schedule.h). While it is ample, every pair that may be within its
/// tolerance is tested. Where it is not, answers are kept as long as they hold, and what is left over is
/// judged:
///
///   found d apart at X_AB, moved by m since    known, when m is a small share of d: no test is needed
///   d - m > what both may move in the frame    left safely: they cannot touch, and their patch is not missed
///   else                                       left unproven: neither body may move in this frame, see
///   blocked()
///
/// Pieces of one part share walls that nobody can touch, and true faces that were cut; what pairs of pieces
/// answer is settled between them before it is handed on (seam_settler.h).
///
/// What is handed on moves from frame to frame without a step (steady_contact.h): the normal of an overlap
/// and the centroid of a patch follow the exact ones at a bounded rate.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tactum/base/frame_rate.h"
#include "tactum/collision/contact.h"
#include "tactum/collision/contact_patch.h"
#include "tactum/collision/contact_reduction.h"
#include "tactum/collision/schedule.h"
#include "tactum/collision/seam_settler.h"
#include "tactum/collision/steady_contact.h"
#include "tactum/collision/surface_minima.h"
#include "tactum/collision/sweep_and_prune.h"
#include "tactum/geometry/part.h"

namespace tactum {

/// A body as the finder sees it. The part must outlive the finder.
struct CollisionBody {
  const Part* part = nullptr;
  bool moves = true;  ///< two bodies that do not move are never tested
};

/// Rooms reserved at load time; a full one sets a flag and drops the rest of that step.
struct ContactFinderRooms {
  std::size_t pairs = 1 << 16;     ///< near piece pairs
  std::size_t patches = 4096;      ///< contact patches of a frame
  std::size_t minima = 8192;       ///< local minima of two surfaces
  std::size_t kept_minima = 1024;  ///< ... of which so many are handed on (contact_reduction.h)
};

/// What the points of a patch's manifold are.
enum class PatchPoints {
  kQuadrature,  ///< weighted, for forces over the area; they move without steps
  kClosest      ///< the closest point alone, on the closest features, as they are
};

/// What is asked and known of a patch's distance at other poses.
enum class GapAnswer : std::uint8_t {
  kNotAsked,
  kAsked,
  kExact,   ///< the distance has been computed
  kProven,  ///< what has moved since it was computed proves that it is enough
  kUnknown  ///< the budget was spent
};

/// Counted work of one frame: N, K and M of the paper's T_h = N t_s + K t_c + M t_f, and what was left.
struct ContactWork {
  int broad_phase_runs = 0;    ///< 1 when boxes or lists had to be renewed, else 0 ("N-body tests")
  int bodies = 0;              ///< N
  int near_pairs = 0;          ///< pairs on the lists
  int exact_tests = 0;         ///< K: of near pairs; pairs of surfaces that were asked count as one each
  int feature_steps = 0;       ///< feature pairs visited by the exact tests
  int surface_queries = 0;     ///< pairs of bodies asked for the local minima of their surfaces
  int minima = 0;              ///< found by them
  int dropped_minima = 0;      ///< of these, left out for want of room
  double dropped_error = 0.0;  ///< a dropped one can be overstepped by this at most [m]
  int patches = 0;             ///< M
  int uncertified = 0;         ///< answers without a certificate
  int due = 0;            ///< pairs that may be within their tolerance, and whose last answer holds no more
  int known = 0;          ///< ... and those whose last answer holds
  int unchecked = 0;      ///< due pairs beyond the budget
  int left_unproven = 0;  ///< ... that no bound proves to stay apart in this frame
  int left_of_held = 0;   ///< ... of these, pairs of the held part
  int longest_unchecked = 0;  ///< frames since the last check of a pair that was left unproven
  bool rooms_full = false;    ///< something was dropped: raise the rooms
};

class ContactFinder {
 public:
  /// `dt_s` is the time from frame to frame [s].
  ContactFinder(std::vector<CollisionBody> bodies, std::span<const Pose> X_WB,
                const ContactFinderRooms& rooms = {}, double dt_s = kReferenceStep_s);

  /// Renews what the motion since the last frame has made stale. `reach[i]` [m] bounds how far any point of
  /// body i moves in this frame; the tolerance of a pair is the sum of its reaches, at least `min_tolerance`
  /// [m].
  void find_near_pairs(std::span<const Pose> X_WB, std::span<const double> reach,
                       double min_tolerance) noexcept;

  /// Exact tests of the near pairs that could be within tolerance, at most `budget` of them, and manifolds.
  /// Of a budget that is not ample, half of what the held part leaves is kept for distances_at(). `urgency`
  /// has an entry per body (schedule.h), or none.
  void find_patches(std::span<const Pose> X_WB, int budget, PatchPoints points = PatchPoints::kQuadrature,
                    std::span<const std::uint8_t> urgency = {}) noexcept;
  /// Whether the budget was not ample in this frame.
  bool thrifty() const noexcept { return thrifty_; }
  /// Exact tests that are left of the frame's budget.
  int tests_left() const noexcept { return tests_left_; }
  /// Whether some pair of the body was left unproven: it may only stay where it is.
  bool blocked(int body) const noexcept { return blocked_[static_cast<std::size_t>(body)] != 0; }

  std::span<const ContactPatch> patches() const noexcept { return patches_; }
  /// The exact signed distance of the pieces of every patch with the bodies at other poses, near those of
  /// the patches: what a step has to keep positive. `distance` has an entry per patch [m]. A distance that
  /// could not be certified counts as none. Between surfaces it is that of every local minimum there is at
  /// the other poses, told by the patches of the same features; where there is none, by the nearest patch.
  ///
  /// `asked` has an entry per patch and is answered in place. No test is made, when the budget is not ample,
  /// where what moved since the last one proves that the distance is at least `enough`, nor when only
  /// `keep_back` tests are left: then the distance is the bound. Pairs of the held part are asked first.
  /// Returns how many tests were made.
  int distances_at(std::span<const Pose> X_WB, std::span<double> distance, std::span<GapAnswer> asked,
                   std::span<const double> enough, int keep_back = 0) noexcept;
  const ContactWork& work() const noexcept { return work_; }
  /// Largest distance of a point of body i from its origin [m].
  double radius(int i) const noexcept { return radius_[static_cast<std::size_t>(i)]; }

 private:
  struct Answer {
    PairDistance found;
    Pose X_AB;
    bool certified = false;  ///< false: it tells nothing
  };
  struct Pair {
    std::int32_t body_a = -1, body_b = -1, piece_a = -1, piece_b = -1;
    PairCache cache;
    SteadyContact shown;
    Answer last;                     ///< where the pair is, or was not long ago
    Answer trial;                    ///< where it was on trial; nothing says that it went there
    double free_until = -1e300;      ///< odometer sum at which the distance may have shrunk to zero
    std::int64_t last_checked = -1;  ///< frame
    bool in_contact = false;
  };
  /// The pieces of two near bodies: pairs_[first, first + count), sorted by piece.
  struct BodyPair {
    std::int32_t first = 0, count = 0;
    double odometers = 0.0;      ///< S0
    double reach = 0.0;          ///< R
    bool cut_short = false;      ///< the room was full: pairs are missing
    std::int64_t renewal = -1;   ///< the renewal it was last part of
    double free_until = -1e300;  ///< of two surfaces: as in Pair
    bool apart = false;          ///< ... and nothing was within the tolerance when last asked
  };

  void move_boxes(std::span<const Pose> X_WB) noexcept;
  bool list_holds(const BodyPair& list, int a, int b) const noexcept;
  void renew_lists(std::span<const Pose> X_WB) noexcept;
  bool collect(int a, int b, const Pose& X_AB, double reach) noexcept;
  void append_pairs(int a, int b, const BodyPair& old) noexcept;
  double bound_at(const Pair& pair, const Answer& answer, const Pose& X_AB) const noexcept;
  void answer(Pair& pair, const Pose& X_AB, Answer& into) noexcept;
  int leave_known(std::span<const Pose> X_WB) noexcept;
  void leave(int a, int b, double gap, std::int64_t last_checked) noexcept;
  bool of_held(int a, int b) const noexcept { return urgency_of(a, b) == urgency::kHeld; }
  std::uint8_t urgency_of(int a, int b) const noexcept;
  void test(Pair& pair, const Pose& X_AB) noexcept;
  void hand_on(Pair& pair, const PairDistance& found, const Pose& X_AB) noexcept;
  /// A neighbour across the seam is nearer than what is objected to. Where its normal parts these pieces as
  /// well it leads: of this patch, without a point, only the stretch of the same true faces counts, along the
  /// leader's normal, of an edge or corner that of its most level face; where there is none it has no
  /// features, and is only watched. Where no neighbour leads, as between the walls of a corner, it is a
  /// contact of its own.
  void settle_objected(ContactPatch& patch, std::span<const Pose> X_WB) const noexcept;
  GapAnswer distance_at(const ContactPatch& patch, std::span<const Pose> X_WB, double enough, int keep_back,
                        double& distance) noexcept;
  bool meet_by_surfaces(int a, int b) const noexcept {
    return bodies_[std::size_t(a)].part->is_surface() || bodies_[std::size_t(b)].part->is_surface();
  }
  void test_surfaces(int a, int b, std::span<const Pose> X_WB) noexcept;
  void add_surface_patch(int a, int b, const SurfaceMinimum& minimum, bool second_end, double reach) noexcept;
  void surface_distances_at(std::span<const ContactPatch> patches, std::span<const Pose> X_WB,
                            std::span<double> distance, std::span<GapAnswer> asked, int keep_back) noexcept;
  double odometers(int a, int b) const noexcept { return travel_[std::size_t(a)] + travel_[std::size_t(b)]; }
  double tolerance(int a, int b) const noexcept;
  BodyPair& list_of(int a, int b) noexcept {
    return lists_[std::size_t(a) * bodies_.size() + std::size_t(b)];
  }

  std::vector<CollisionBody> bodies_;
  std::vector<Aabb> part_box_;  // of the part, in its own frame
  std::vector<double> radius_;
  std::vector<Aabb> fat_box_;  // in the world, grown by slack
  std::vector<double> slack_;  // how far boxes and lists are grown
  std::vector<double> travel_;
  std::vector<Pose> last_X_WB_;
  SweepAndPrune sweep_;
  std::vector<BodyPair> lists_;
  std::vector<Pair> pairs_, renewed_;
  std::vector<std::pair<std::int32_t, std::int32_t>> near_pieces_;  // of the two bodies in work
  std::vector<DuePair> due_;
  std::vector<std::int32_t> handed_on_;  // pairs with an answer, or that had one
  std::vector<char> blocked_;            // by body
  std::span<const std::uint8_t> urgency_;
  bool thrifty_ = false;
  int tests_left_ = 0;
  std::vector<ContactPatch> patches_;
  std::vector<int> objected_;  // patches of pieces that are apart, of points that are no contact of the parts
  std::vector<SeamCandidate> candidates_;
  std::vector<SeamCandidate*> candidate_order_;
  std::vector<SurfaceMinimum> minima_;
  std::vector<ReductionScratch> reduction_scratch_;
  std::size_t kept_minima_ = 0;
  SteadyLimits steady_;
  int head_start_;  // frames
  std::span<const double> reach_;
  PatchPoints points_ = PatchPoints::kQuadrature;
  double min_tolerance_ = 0.0;
  std::int64_t frame_ = 0;
  std::int64_t renewal_ = 0;
  ContactWork work_;
};

}  // namespace tactum
