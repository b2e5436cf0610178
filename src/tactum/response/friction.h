#pragma once
/// Dry friction in the constraint response: one cone per patch of contact, at its centre of pressure.
///
///        \  |n /       a row per direction d:   n . s - mu d . (s_t + a) >= -(gap) - mu slip
///         \ | /        its force on A is along  n - mu d:  the edges of the cone
///     A    \|/
///     -----(c)-----    s  displacement of A's point at c against B's,  s_t  its part in the plane
///     B                a  how far the anchor, a point of each body, has come apart in the plane
///
/// With slip = 0 these rows let the point move sideways only if it lifts by mu times as much, so no force
/// within the cone moves it: it sticks. A step is answered to first order and a turn leaves that by its
/// square, always to the same side: the anchor takes the patch back, or a part rocked on its edge would walk.
/// Where the force lies on the cone, it lifts; slip is then set to the sideways motion it made and the
/// problem solved again, which ends with no lift, sliding, and the force mu N against the motion [Anitescu
/// and Potra 1997; De Saxce and Feng 1998]. A patch that slid is anchored where it came to rest. The forces
/// of a patch's corners count to N, as c is the centre of them all; found from the last frame's, it settles
/// within a few.
///
/// Turning about the normal has two rows of the same kind, with the torque mu N r of the patch's mean radius
/// r; force and torque share the cone linearly, a diamond inside the ellipse that an area has.
///
/// Patches have a cone that would push without friction, and those that held in the last frame and still
/// touch: where the line between two of these lies inside both cones no motion is left, and the part is
/// wedged though nothing presses it there [Simunovic 1975; Whitney 1982]. Forces within the cones could hold
/// it against a turn that takes the points off their walls as well, for ever; so of those that only held, one
/// that would have to slip is let go, and one that the hand's turning does not squeeze: a force through two
/// contacts on opposite walls is what a torque has pressed in, as a push or a pull takes off the one wall
/// what it adds to the other.

#include "tactum/dynamics/contact_row.h"
#include "tactum/response/friction_cone.h"
#include "tactum/response/settings.h"

namespace tactum {

class Friction {
 public:
  static constexpr std::size_t kMostPatches = ConstraintProblem::kMostCones;
  static constexpr std::size_t kDirections = QpCone::kAround;
  static constexpr std::size_t kRowsAPatch = QpCone::kEdges;

  /// The patches that push in the last answer, whose contact rows begin at `first_row`; their rows are added
  /// to the problem. False when there is none.
  bool begin(const World& world, const PairCoefficients& settings, std::span<const ContactRow> rows,
             std::span<const ContactPatch> patches, std::span<const Pose> X_WB, double skin_m,
             std::size_t first_row, ConstraintProblem& problem) noexcept;
  /// Appends the rows that held in the last frame while the patches stuck.
  void rows_that_stuck(StaticVector<int, kMostUnknowns>& rows) const noexcept;
  /// Notes which rows hold: the last answer is that of patches that stick.
  void note_sticking(const ConstraintProblem& problem) noexcept;
  /// Lets patches slip by what they slid in the last answer. True when that changed a row.
  bool let_slip(double skin_m, ConstraintProblem& problem) noexcept;
  /// Takes the anchors off, when they ask for what cannot be.
  void forget_anchors(ConstraintProblem& problem) noexcept;
  /// Remembers anchors and centres; the step led to X_WB.
  void end(const World& world, std::span<const ContactRow> rows, std::span<const ContactPatch> patches,
           std::size_t first_row, const ConstraintProblem& problem, std::span<const Pose> X_WB) noexcept;
  /// Appends a row per cone edge that pushes; returns the torques about normals on `body`.
  Vec3 add_forces(int body, double dt_s, const ConstraintProblem& problem,
                  std::vector<ContactRow>& rows) const noexcept;

  bool acts() const noexcept { return !patches_.empty(); }
  std::span<const FrictionPatch> patches() const noexcept { return {patches_.begin(), patches_.end()}; }
  /// Nothing acts, and nothing is remembered.
  void forget() noexcept {
    patches_.clear();
    anchors_.clear();
  }
  /// Nothing acts.
  void clear() noexcept { patches_.clear(); }

 private:
  /// Of a patch, from frame to frame: its anchor in either body's frame, and the centre as A carries it.
  struct Anchor {
    PatchKey key;
    Vec3 on_A = Vec3::Zero(), on_B = Vec3::Zero(), centre_A = Vec3::Zero();  // [m]
    double radius_m = 0.0;
    std::uint32_t sticks_by = 0;
    bool pushed = false;  ///< its cone pushed
  };
  void find_pushing(const World& world, const PairCoefficients& settings, std::span<const ContactRow> rows,
                    std::span<const ContactPatch> patches, double skin_m, std::size_t first_row,
                    const ConstraintProblem& problem) noexcept;
  void find_holding(const World& world, const PairCoefficients& settings, std::span<const ContactRow> rows,
                    std::span<const ContactPatch> patches, std::span<const Pose> X_WB,
                    double skin_m) noexcept;
  double taken_off(const FrictionPatch& patch, const ConstraintProblem& problem) const noexcept;
  void drop_unsqueezed(const ConstraintProblem& problem) noexcept;
  FrictionPatch* patch_of(const PatchKey& key) noexcept;
  FrictionPatch* patch_of_row(std::size_t row) noexcept;
  void add_cone(FrictionPatch& patch, ConstraintProblem& problem) noexcept;
  void drop_cone(FrictionPatch& patch, ConstraintProblem& problem) noexcept;
  void anchor(FrictionPatch& patch, std::span<const Pose> X_WB, double settled_m) noexcept;

  StaticVector<FrictionPatch, kMostPatches> patches_;
  StaticVector<Anchor, kMostPatches> anchors_;
};

}  // namespace tactum
