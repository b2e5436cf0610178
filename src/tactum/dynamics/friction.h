#pragma once
/// Dry friction of the contact problem: one cone per patch of contact, at its centre of pressure.
///
///        \  |n /       a row per direction d:   n . s - mu d . (s_t + a) >= -(gap) - mu slip
///         \ | /        its force on A is along  n - mu d:  the edges of the cone
///     A    \|/
///     -----(c)-----    s  displacement of A's point at c against B's,  s_t  its part in the plane
///     B                a  how far the anchor, a point of each body, has come apart in the plane
///
/// With slip = 0 these rows let the point move sideways only if it lifts by mu times as much, so no force
/// within the cone moves it: it sticks. A step is solved to first order, and a turn leaves an error of its
/// square, always to the same side: the anchor takes the patch back, or a part rocked on its edge would
/// creep. Where the force lies on the cone, the point lifts; slip is then set to its sideways motion and the
/// problem solved again, which ends with no lift, sliding, and the force mu N against the motion [Anitescu
/// and Potra 1997; De Saxce and Feng 1998]. A patch that slid is anchored where it came to rest. The forces
/// of a patch's corners count to N, as c is the centre of them all; it is found from the last frame's forces
/// and settles within a few frames.
/// Turning about the normal has two rows of the same kind, with the torque mu N r of the patch's mean radius
/// r; force and torque share the cone linearly, a diamond inside the ellipse that an area has.
///
/// A patch that slips gets its friction as a load in the end, in place of its cone: mu N against the slide
/// and the turn, on the ellipse, with N from whatever carries it (update_sliding). Cones alone give too
/// little where corners, which have no friction of their own, carry a part of the load.
///
/// A cone is given to patches that push without friction, and to those whose cone pushed in the last frame
/// and that still touch: where the line between two of these lies inside both cones no motion is left, and
/// the part is wedged though nothing presses it there [Simunovic 1975; Whitney 1982]. Forces within the cones
/// could for ever hold it also against a turn that takes the points off their walls. So of the patches that
/// only pushed in the last frame, two kinds are released: one that would have to slip, and one that the
/// target's turn does not squeeze. For the force through two contacts on opposite walls comes from a torque;
/// a push or a pull takes from one wall what it adds to the other.
///
/// This file is friction in the exact solver. The iterative solvers (island_forces.h) use the same
/// patches.

#include "tactum/dynamics/friction_anchors.h"
#include "tactum/dynamics/friction_patch.h"

namespace tactum::inline v0_1 {

class Friction {
 public:
  static constexpr std::size_t kMostPatches = ContactProblem::kMostCones;
  static constexpr std::size_t kDirections = QpCone::kAround;
  static constexpr std::size_t kRowsAPatch = QpCone::kEdges;

  /// Finds the patches that push in the last answer, and those that pushed in the last frame; adds their rows
  /// to the problem. False when there are none. There is room for kMostPatches: all further ones have no
  /// friction in this frame, see no_room().
  bool begin(const RowsInProblem& contacts, std::span<const Pose> X_WB, const FrictionAnchors& anchors,
             ContactProblem& problem) noexcept;
  /// Appends the rows that pushed in the last frame while the patches stuck.
  void rows_that_stuck(StaticVector<int, kMostUnknowns>& rows) const noexcept;
  /// Stores which rows push: the last answer is that of patches that stick.
  void note_sticking(const ContactProblem& problem) noexcept;
  /// Lets patches slip as far as they slid in the last answer. True when that changed a row.
  bool update_slip(ContactProblem& problem) noexcept;
  /// Gives patches that slip the friction of the last answer as a load, in place of their cone: exactly mu N
  /// against the motion, whichever corners carry N. True when that changed a load.
  bool update_sliding(const RowsInProblem& contacts, ContactProblem& problem) noexcept;
  /// Removes all loads.
  void refuse_loads(ContactProblem& problem) noexcept;
  /// Gives up the anchors, when their rows have no solution together.
  void forget_anchors(ContactProblem& problem) noexcept;
  /// Stores anchors and centres. X_WB are the poses at the start of the step.
  void end(const RowsInProblem& contacts, const ContactProblem& problem, std::span<const Pose> X_WB,
           FrictionAnchors& anchors) const noexcept;
  /// Visits the forces of cones and sliding patches in the last answer: visit(patch number, push, multiplier
  /// [N]).
  template <class Visit>
  void for_each_force(const ContactProblem& problem, const Visit& visit) const {
    for (const QpActive& active : problem.answer().active)
      for (std::size_t i = 0; i < patches_.size(); ++i) {
        const std::size_t edge = static_cast<std::size_t>(active.row) - patches_[i].rows.first;
        if (patches_[i].acts && static_cast<std::size_t>(active.row) >= patches_[i].rows.first &&
            edge < kRowsAPatch)
          visit(i, cone_edge(patches_[i], edge), active.multiplier);
      }
    for (std::size_t i = 0; i < patches_.size(); ++i)
      if (const SlidingForce& sliding = patches_[i].sliding; patches_[i].acts && sliding.acts)
        visit(i,
              Push{patches_[i].place.centre_W, sliding.force_W, sliding.torque_Nm * patches_[i].place.n_BA_W},
              1.0);
  }

  bool acts() const noexcept { return !patches_.empty(); }
  /// Whether a patch has no friction in this frame for want of room.
  bool no_room() const noexcept { return no_room_; }
  std::span<const FrictionPatch> patches() const noexcept { return {patches_.begin(), patches_.end()}; }
  /// Removes all patches.
  void clear() noexcept {
    patches_.clear();
    no_room_ = false;
  }

 private:
  /// The forces at one patch, on A: of its cone, and of its corners along their normals.
  struct Loads {
    double cone_N = 0.0, corners_N = 0.0;  // along the normal [N]
    Vec3 cone_force = Vec3::Zero();        // in the surface [N]
    Vec3 cone_torque = Vec3::Zero();       // about the normal [N m]
  };
  static Loads loads_of(const FrictionPatch& patch, const RowsInProblem& contacts,
                        const ContactProblem& problem) noexcept;
  static double give_of(const FrictionPatch& patch) noexcept;
  SlidingForce next_force(const FrictionPatch& patch, const SlidingForce& last, double most_N,
                          const ContactProblem& problem) const noexcept;
  static void set_load(const SlidingForce& force, FrictionPatch& patch, ContactProblem& problem) noexcept;
  static void refuse_load(FrictionPatch& patch, ContactProblem& problem) noexcept;
  static void release_cone(const FrictionPatch& patch, ContactProblem& problem) noexcept;
  void find_pushing(const RowsInProblem& contacts, const ContactProblem& problem) noexcept;
  void find_last_pushing(const RowsInProblem& contacts, const FrictionAnchors& anchors,
                         std::span<const Pose> X_WB) noexcept;
  double taken_off(const FrictionPatch& patch, const ContactProblem& problem) const noexcept;
  void anchor_patches(const RowsInProblem& contacts, const ContactProblem& problem,
                      std::span<const Pose> X_WB, FrictionAnchors& anchors) const noexcept;
  void note_pressed(const RowsInProblem& contacts, const ContactProblem& problem, std::span<const Pose> X_WB,
                    FrictionAnchors& anchors) const noexcept;
  void drop_unsqueezed(const ContactProblem& problem) noexcept;
  FrictionPatch* patch_of(const SurfacePair& surfaces) noexcept;
  FrictionPatch* patch_of_row(std::size_t row) noexcept;
  static QpCone cone_now(const FrictionPatch& patch) noexcept;
  void release(FrictionPatch& patch, ContactProblem& problem) noexcept;

  StaticVector<FrictionPatch, kMostPatches> patches_;
  bool no_room_ = false;
};

/// Sets the anchor of a patch, and its centre in the patch's plane, to the last frame's; a patch that had
/// none is anchored at its centre, and so is one that rolls, in every frame, with what it slid before.
/// Returns the last frame's anchor, or null.
const FrictionAnchor* take_anchor(const FrictionAnchors& anchors, std::span<const Pose> X_WB,
                                  FrictionPatch& patch) noexcept;

/// The anchor of a patch for the next frame, when its forces had their centre at `centre_W` and the step
/// began at X_WB: that of a patch that stuck goes with the centre, that of one that slid is set anew.
/// `problem` has the answer.
FrictionAnchor next_anchor(const FrictionPatch& patch, const Vec3& centre_W, bool pushed,
                           std::span<const Pose> X_WB, const ContactProblem& problem) noexcept;

}  // namespace tactum::inline v0_1
