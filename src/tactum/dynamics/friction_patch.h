#pragma once
/// A patch of contact with dry friction: its surfaces, its place, and the cone of its force (drawn in
/// friction.h).

#include "tactum/dynamics/contact_problem.h"
#include "tactum/dynamics/contact_row.h"

namespace tactum::inline v0_1 {

/// The motion of A's point at a patch's centre against B's in an answer of the contact problem, as rows of
/// the problem: off the surface and along two directions in it [m], and the turn about the normal [rad].
struct PatchMotion {
  Vec3 along_W = Vec3::Zero(), across_W = Vec3::Zero();  ///< the two directions, unit [-]
  QpRow off, along, across, about;
};

/// The point of either body at which a sticking patch was anchored, and the displacement between the two.
struct PatchAnchor {
  Vec3 on_A = Vec3::Zero(), on_B = Vec3::Zero();  ///< in either body's frame [m]
  /// a: where the anchor on A is from the one on B, in the surface; zero where it is too small to count [m].
  Vec3 apart_W = Vec3::Zero();
  bool used = true;  ///< false: the anchor was given up in this frame
};

/// How far a patch slides in this step.
struct PatchSlip {
  double displacement_m = 0.0;  ///< allowed without lifting [m]
  double turn_rad = 0.0;        ///< of turning about the normal [rad]
  bool any() const { return displacement_m > 0.0 || turn_rad > 0.0; }
};

/// The friction on A of a patch that slides, as a load of the contact problem in place of the cone.
struct SlidingForce {
  bool acts = false;
  bool sticks = false;          ///< the force is less than mu N: nothing slides
  Vec3 force_W = Vec3::Zero();  ///< in the surface, at the centre [N]
  double torque_Nm = 0.0;       ///< about the normal [N m]
};

/// The patch's forces, as rows of the exact solver.
struct PatchRows {
  std::size_t first = 0;  ///< the number of its cone's first edge
  /// Which of its edges push while it sticks, a bit each; at first those of the last frame.
  std::uint32_t sticking = 0;
};

/// Where a patch pushes.
struct PatchPlace {
  Vec3 n_BA_W = Vec3::Zero();    ///< [-]
  Vec3 centre_W = Vec3::Zero();  ///< c, of the forces [m]
  double radius_m = 0.0;         ///< r, of the forces about their centre [m]
  /// By how much its centre may close; zero where that is too small to count, negative where it has to open
  /// [m].
  double skin_m = 0.0;  ///< of the pair [m]
  double gap_m = 0.0;
};

/// A patch that pushes, in this frame.
struct FrictionPatch {
  SurfacePair surfaces;
  int source_patch = -1;     ///< ContactRow::patch of one of its rows
  double coefficient = 0.0;  ///< mu [-]
  double load_N = 0.0;       ///< N without friction; 0: the patch only pushed in the last frame [N]
  bool rolls = false;        ///< a row of it does (ContactRow::rolls)
  bool acts = true;          ///< false: it was released in this frame
  PatchPlace place;
  PatchAnchor anchor;
  PatchMotion motion;
  PatchSlip slip;
  SlidingForce sliding;
  PatchRows rows;

  /// Whether the bodies slide on each other, or turn.
  bool slides() const { return sliding.acts ? !sliding.sticks : slip.any(); }
};

/// The slide of a patch from its anchor in the step of an answer, and its turn about the normal.
struct Slide {
  Vec3 displacement = Vec3::Zero();  ///< [m]
  double turn = 0.0;                 ///< [rad]
  double lift = 0.0;                 ///< its centre's gap beyond the skin after the step [m]
};

/// The force along edge k of the cone: directions around the normal, then the two senses of turning.
Push cone_edge(const FrictionPatch& patch, std::size_t k) noexcept;
/// The rows of all these forces, from the patch's motion, whose first direction is the d of edge 0. Their
/// offsets are zero.
QpCone cone_of(const FrictionPatch& patch) noexcept;
/// From the patch's normal and centre; `along_W` is in the surface, unit.
PatchMotion motion_of(const FrictionPatch& patch, const Vec3& along_W,
                      const ContactProblem& problem) noexcept;
/// The same motion, stated along other directions in the surface.
void turn_directions(const Vec3& along_W, PatchMotion& motion) noexcept;
Slide slide_of(const FrictionPatch& patch, const ContactProblem& problem) noexcept;

}  // namespace tactum::inline v0_1
