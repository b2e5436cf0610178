#pragma once
/// Finds where the bodies touch. The first half of a frame, from poses to contact patches, in three steps:
///
///   bodies -- sweep and prune --> near bodies -- hierarchies --> near pieces -- exact tests --> patches
///
/// Bodies made of convex pieces are tested piece by piece, by tracked pairs. Where either has none, both are
/// tested by their surfaces: every local minimum of distance is a patch of one point (surface_minima.h).
///
/// Answers are kept from frame to frame: no step is repeated while a bound on the motion proves that its
/// answer cannot have changed. For every body the accumulated motion `travel` is kept: no point of it has
/// moved farther than that since the start. With S the sum of two bodies' accumulated motions, a list of
/// their pairs made with range R at S0 holds all pairs within `tolerance` while (S - S0) + tolerance <= R; a
/// pair found d apart at S0 needs no test while d - (S - S0) > tolerance. Both are proofs, not guesses; they
/// are what makes a frame with coherent motion cheap.
///
/// Exact tests are bounded by a budget (schedule.h). While it is ample, every pair that may be within its
/// tolerance is tested. Where it is not, answers are kept as long as they hold, and the pairs left over are
/// judged:
///
///   found d apart at X_AB, moved by m since    known, when m is a small part of d: no test is needed
///   d - m > what both may move in the frame    left safely: they cannot touch, and their patch is not missed
///   else                                       left unproven: neither body may move, see blocked()
///
/// Pieces of one part share walls that nobody can touch, and true faces that were cut; the contacts of pairs
/// of pieces are settled between them before patches are emitted (seam_settler.h), and those with bodies that
/// lie side by side after that (flush_bodies.h).
///
/// Emitted patches of the grasped part and a body that stands move from frame to frame without a step
/// (steady_contact.h): the normal of an overlap and the centroid of a patch follow the exact ones at a
/// bounded rate.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tactum/base/frame_rate.h"
#include "tactum/base/reserved_vector.h"
#include "tactum/collision/contact.h"
#include "tactum/contact/collision_body.h"
#include "tactum/contact/contact_patch.h"
#include "tactum/contact/contact_reduction.h"
#include "tactum/contact/contact_work.h"
#include "tactum/contact/flush_bodies.h"
#include "tactum/contact/gap_oracle.h"
#include "tactum/contact/schedule.h"
#include "tactum/contact/seam_settler.h"
#include "tactum/contact/steady_contact.h"
#include "tactum/contact/sweep_and_prune.h"
#include "tactum/math/relative_motion.h"
#include "tactum/surface/surface_minima.h"

namespace tactum::inline v0_1 {

/// The kind of points in a patch's manifold. Where a frame asks for kQuadrature and names the grasped part's
/// priority, only its patches are of that kind; the bodies that move by themselves meet in closest points.
enum class PatchPoints {
  kQuadrature,  ///< weighted, for forces over the area; they move without steps
  kClosest      ///< the closest point alone, on the closest features, as they are
};

class ContactFinder final : public GapOracle {
 public:
  /// `dt_s` is the time from frame to frame [s], `scale` how many times as large as a hand's the scene is: so
  /// much faster may the points of PatchPoints::kQuadrature move.
  ContactFinder(std::vector<CollisionBody> bodies, std::span<const Pose> X_WB,
                const ContactFinderCapacity& capacity = {}, double dt_s = kReferenceStep_s,
                double scale = 1.0);

  /// Renews the boxes and lists that the motion since the last frame has made stale. `motion_bound[i]` [m]
  /// bounds how far any point of body i moves in this frame; the tolerance of a pair is the sum of both
  /// bounds, at least `min_tolerance` [m].
  void find_near_pairs(std::span<const Pose> X_WB, std::span<const double> motion_bound,
                       double min_tolerance) noexcept;

  /// Makes exact tests of the near pairs that could be within tolerance, at most `budget` of them, and
  /// manifolds. Of a budget that is not ample, half of what the grasped part leaves is kept for
  /// distances_at(). `priority` has an entry per body (schedule.h), or none.
  void find_patches(std::span<const Pose> X_WB, int budget, PatchPoints points = PatchPoints::kQuadrature,
                    std::span<const std::uint8_t> priority = {}) noexcept;
  bool budget_limited() const noexcept override { return budget_limited_; }
  bool capacity_reached() const noexcept override { return work_.capacity_reached; }
  int tests_left() const noexcept override { return tests_left_; }
  bool blocked(int body) const noexcept override { return blocked_[static_cast<std::size_t>(body)] != 0; }

  std::span<const ContactPatch> patches() const noexcept { return patches_; }
  int distances_at(std::span<const Pose> X_WB, std::span<double> distance, std::span<GapAnswer> asked,
                   std::span<const double> enough, int keep_back = 0) noexcept override;
  double depth_along(int patch, std::span<const Pose> X_WB, const Vec3& direction_W) noexcept override;
  FirstImpact first_impact(std::span<const Pose> X_WB, std::span<const Twist> V_WB,
                           double dt_s) noexcept override;
  Passing passes(int patch, std::span<const Pose> X_WB, std::span<const Twist> V_WB, double dt_s,
                 double gap_m) noexcept override;
  PathWork prove_paths(std::span<const Pose> X_WB, std::span<const BodyTurn> turn,
                       std::span<const char> asked, int most_tests, std::span<double> free) noexcept override;
  const ContactWork& work() const noexcept { return work_; }
  /// Largest distance of a point of body i from its origin [m].
  double radius(int i) const noexcept { return radius_[static_cast<std::size_t>(i)]; }
  /// The same of every body [m].
  std::span<const double> radii() const noexcept { return radius_; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.fat_box_, self.travel_, self.last_X_WB_, self.sweep_, self.lists_, self.met_, self.overlaps_,
          self.pairs_, self.blocked_, self.priority_, self.budget_limited_, self.tests_left_, self.patches_,
          self.motion_bound_, self.points_, self.min_tolerance_, self.frame_, self.renewal_);
  }

 private:
  /// What a test found, and the pose of B in A at which it did.
  struct Answer {
    PairDistance found;
    Pose X_AB;               ///< [m]
    bool certified = false;  ///< false: it proves nothing
  };
  struct Pair {
    std::int32_t body_a = -1, body_b = -1, piece_a = -1, piece_b = -1;
    PairCache cache;
    SteadyContact shown;             ///< the contact as the penalty response had it in the last frame
    Answer last;                     ///< of the last test
    Answer trial;                    ///< of a test at a trial pose, which the pair need not have taken
    double free_until = -1e300;      ///< accumulated motion at which the distance may have shrunk to zero [m]
    std::int64_t last_checked = -1;  ///< frame
    bool implied = false;            ///< its contact is ContactPatch::implied, and has no force of its own
    bool in_contact = false;         ///< nearer than its tolerance when it was last looked at
  };
  /// The pieces of two near bodies: pairs_[first, first + count), sorted by piece.
  struct BodyPair {
    std::int32_t body_a = -1, body_b = -1;  ///< whose list it is; a slot is given to another pair when free
    std::int32_t first = 0, count = 0;
    double accumulated_motion = 0.0;  ///< S0, when it was made [m]
    double range = 0.0;               ///< R, with which it was made [m]
    bool cut_short = false;           ///< the room was full: pairs are missing
    std::int64_t renewal = -1;   ///< number of the renewal it was last part of: an older one is not in pairs_
    double free_until = -1e300;  ///< of two surfaces: as in Pair
    bool apart = false;          ///< ... and nothing was within the tolerance at the last query
    bool looked_at = false;      ///< ... and whether they overlap was looked at
    double nearest = 0.0;  ///< ... a lower bound of their distance in this frame, where both are trusted [m]
    std::int64_t unproven_until =
        0;  ///< frame up to which no path is proven: the last one took too many tests
  };

  /// Two surfaces that were in each other when they were first near. What is found to that depth pushes them
  /// apart; until it has, their paths are not proven, since no motion of them is free.
  struct Overlap {
    std::int32_t body_a = -1, body_b = -1;
    double depth = 0.0;  ///< twice the deepest that was found [m]
  };

  /// Two triangles of surfaces that have ended a path (prove_paths): no minimum of the distance stood for
  /// them.
  struct MetTriangles {
    std::int32_t body_a = -1, body_b = -1, triangle_a = -1, triangle_b = -1;
  };

  /// The answer of surfaces_pass() for two bodies with these twists.
  struct SurfacesPassed {
    std::int32_t body_a = -1, body_b = -1;
    std::int64_t frame = -1;
    Twist V_a, V_b;
    Passing passing = Passing::kNot;
  };

  /// The path of a body from the frame's start to another pose.
  struct BodyPath {
    RelativeMotion motion;  ///< as the world sees it
    Pose to;                ///< where it ends, without the error of the turn
    double travel = 0.0;    ///< a bound of how far its points go [m]

    Pose at(double s) const noexcept { return s < 1.0 ? motion.at(s) : to; }
  };

  void move_boxes(std::span<const Pose> X_WB) noexcept;
  bool may_touch(const SweepAndPrune::Pair& near) const noexcept;
  bool list_holds(const SweepAndPrune::Pair& near) noexcept;
  void renew_lists(std::span<const Pose> X_WB) noexcept;
  bool collect(int a, int b, const Pose& X_AB, double range) noexcept;
  void append_pairs(int a, int b, const BodyPair& old) noexcept;
  double bound_at(const Pair& pair, const Answer& answer, const Pose& X_AB) const noexcept;
  void answer(Pair& pair, const Pose& X_AB, Answer& into) noexcept;
  /// Fills due_ with the pairs that may be within their tolerance; the others are not in contact.
  void list_due_pairs() noexcept;
  int skip_still_valid(std::span<const Pose> X_WB) noexcept;
  void skip(int a, int b, double gap, std::int64_t last_checked) noexcept;
  void drop(int a, int b) noexcept;
  void block_unlisted() noexcept;
  bool of_grasped(int a, int b) const noexcept { return priority_of(a, b) == priority::kGrasped; }
  bool over_areas(int a, int b) const noexcept {
    return points_ == PatchPoints::kQuadrature && (priority_.empty() || of_grasped(a, b));
  }
  std::uint8_t priority_of(int a, int b) const noexcept;
  void test(Pair& pair, const Pose& X_AB) noexcept;
  SeamCandidate candidate_of(Pair& pair, const PairDistance& found, bool internal) const noexcept;
  void settle_candidates(std::span<const Pose> X_WB) noexcept;
  void leave_out_implied(std::span<const Pose> X_WB) noexcept;
  void emit_patch(Pair& pair, PairDistance found, const Pose& X_AB) noexcept;
  GapAnswer distance_at(const ContactPatch& patch, std::span<const Pose> X_WB, double enough, int keep_back,
                        double& distance) noexcept;
  bool has_surface(int a, int b) const noexcept {
    return bodies_[std::size_t(a)].part->is_surface() || bodies_[std::size_t(b)].part->is_surface();
  }
  /// Where either is a surface, and where a turned part that is made of pieces moves by itself: its circles
  /// are those of its surface.
  bool meet_by_surfaces(int a, int b) const noexcept { return has_surface(a, b) || rolls_by_circles(a, b); }
  bool rolls_by_circles(int a, int b) const noexcept {
    return (turned_[std::size_t(a)] || turned_[std::size_t(b)]) && !of_grasped(a, b) && !over_areas(a, b);
  }
  void test_surfaces(const SweepAndPrune::Pair& near, std::span<const Pose> X_WB) noexcept;
  double cone_inflation(int a, int b) const noexcept;
  void look_for_overlap(int a, int b, const Pose& X_AB, double watched) noexcept;
  bool follow_overlap(int a, int b, double watched) noexcept;
  double deepest_minimum() const noexcept;
  double overlap(int a, int b) const noexcept;
  bool find_minima(int a, int b, const Pose& X_AB, const MinimaQuery& query) noexcept;
  void add_minima(int a, int b, double margin) noexcept;
  std::size_t reduce_minima(int a, int b, double margin) noexcept;
  bool test_ball(int a, int b, const Pose& X_AB, double margin) noexcept;
  void test_balls(int a, int b, const Pose& X_AB, double margin) noexcept;
  void take_revolved(int a, int b, const Pose& X_AB, double margin) noexcept;
  ContactPatch* add_surface_patch(int a, int b, const SurfaceMinimum& minimum, bool second_end,
                                  double margin) noexcept;
  /// Of a body that is a ball its centre, as a surface; else nothing.
  static SurfaceTree core_of(const CollisionBody& body);
  void surface_distances_at(std::span<const ContactPatch> patches, std::span<const Pose> X_WB,
                            std::span<double> distance, std::span<GapAnswer> asked, int keep_back) noexcept;
  BodyPath path_of(int body, const RelativeMotion& motion, const Pose& to) const noexcept;
  BodyPath path_for(int body, const Pose& X_WB, const Twist& V_WB, double dt_s) const noexcept;
  bool stays_beside(const ContactPatch& at, const Vec3& n_W, double distance, std::span<const Twist> V_WB,
                    double dt_s) const noexcept;
  bool slides(const ContactPatch& at, std::span<const Pose> X_WB, std::span<const Twist> V_WB,
              double dt_s) noexcept;
  Passing surfaces_pass(const ContactPatch& at, std::span<const Pose> X_WB, std::span<const Twist> V_WB,
                        double dt_s, double gap_m) noexcept;
  Passing ball_passes(const ContactPatch& at, std::span<const Pose> X_WB, std::span<const Twist> V_WB,
                      double dt_s, double gap_m) noexcept;
  bool stay_apart(int a, int b, const BodyPath& of_a, const BodyPath& of_b) const noexcept;
  double path_free(const Pair& pair, const BodyPath& a, const BodyPath& b) const noexcept;
  double path_free(const SweepAndPrune::Pair& near, int most_tests, PathWork& work) noexcept;
  StaticVector<Vec3, 4> ridden_planes(int a, int b) const noexcept;
  double ridden_height(int a, int b) const noexcept;
  void remember(const MetTriangles& met) noexcept;
  void add_met_triangles(int a, int b, const Pose& X_AB, double margin) noexcept;
  double distance_of_met(const ContactPatch& patch, const Pose& X_AB) const noexcept;
  double accumulated_motion(int a, int b) const noexcept {
    return travel_[std::size_t(a)] + travel_[std::size_t(b)];
  }
  double tolerance(int a, int b) const noexcept;
  /// The distance of facets within which pieces may be in contact: the curved surfaces that they stand for
  /// are nearer by their bulges [m].
  double facet_tolerance(int a, int b) const noexcept { return tolerance(a, b) + bulge(a, b); }
  /// By how much curved surfaces are nearer than facets; the grasped part meets by its facets [m].
  const SteadyLimits& steady_limits(int a, int b) const noexcept;
  double bulge(int a, int b) const noexcept { return of_grasped(a, b) ? 0.0 : greatest_bulge(a, b); }
  /// The same for lists that outlast a grasp [m].
  double greatest_bulge(int a, int b) const noexcept {
    return bulge_[std::size_t(a)] + bulge_[std::size_t(b)];
  }
  BodyPair& list_of(const SweepAndPrune::Pair& near) noexcept {
    BodyPair& list = lists_[std::size_t(near.slot)];
    if (list.body_a != near.a || list.body_b != near.b) list = {near.a, near.b};
    return list;
  }

  std::vector<CollisionBody> bodies_;
  std::vector<Aabb> part_box_;  // of the part, in its own frame
  std::vector<double> radius_;
  std::vector<SurfaceTree> cores_;  // see core_of()
  std::vector<char> trusted_;       // its surface is closed and outward: cones see all of it
  std::vector<char> turned_;   // it moves, is made of pieces that are not round, has circles and is trusted
  std::vector<double> bulge_;  // greatest of its curved surfaces, beyond their facets [m]
  std::vector<Aabb> fat_box_;  // in the world, grown
  std::vector<double> box_growth_;  // how far boxes and lists are grown [m]
  std::vector<double> travel_;      // accumulated motion of each body [m]
  std::vector<double> turn_;        // of each body in the last frame, about; a short one [rad]
  std::vector<Pose> last_X_WB_;     // at which travel_ was last added to
  SweepAndPrune sweep_;
  std::vector<BodyPair> lists_;       // by slot of a near pair
  int unproven_frames_ = 0;           // kUnproven_s in frames
  std::vector<BodyPath> paths_;       // by body: see prove_paths()
  ReservedVector<MetTriangles> met_;  // those that may be contacts
  ReservedVector<Overlap> overlaps_;
  SurfacesPassed surfaces_passed_;  // the last answer
  ReservedVector<Pair> pairs_, renewed_;
  ReservedVector<std::pair<std::int32_t, std::int32_t>> near_pieces_;  // of the two bodies being tested
  ReservedVector<DuePair> due_;
  // Pairs that may give a patch in this frame: tested, with an answer that still holds, or left unchecked
  // with one from an earlier frame.
  ReservedVector<std::int32_t> emitted_;
  std::vector<char> blocked_;              // by body: see blocked()
  ReservedVector<std::uint8_t> priority_;  // by body; empty: all alike
  bool budget_limited_ = false;
  int tests_left_ = 0;
  ReservedVector<ContactPatch> patches_;
  ReservedVector<SeamCandidate> candidates_;  // over areas
  ReservedVector<SeamCandidate> internal_;    // closest points on walls between pieces
  ReservedVector<SeamCandidate*> candidate_order_;
  FlushBodies flush_bodies_;
  ReservedVector<SurfaceMinimum> minima_;
  ReservedVector<ReductionScratch> reduction_scratch_;
  std::size_t kept_minima_ = 0;  // most minima of two bodies that become patches
  SteadyLimits steady_;
  SteadyLimits not_steady_ = SteadyLimits::none();
  int head_start_;                       // kHeadStart_s in frames
  ReservedVector<double> motion_bound_;  // by body [m]
  PatchPoints points_ = PatchPoints::kQuadrature;
  double min_tolerance_ = 0.0;
  std::int64_t frame_ = 0;
  std::int64_t renewal_ = 0;
  ContactWork work_;
};

}  // namespace tactum::inline v0_1
