#pragma once
/// A patch of contact that rubs: which surfaces, where, and the cone its force lies in (friction.h draws it).

#include "tactum/contact/contact_patch.h"
#include "tactum/response/constraint_problem.h"

namespace tactum {

/// Which surfaces touch, by the groups that their parts name: of pieces (Part::surface_group), or, where
/// bodies meet by their surfaces, of coplanar triangles (SurfaceTree::group_of). The corners and edges of one
/// body that touch the same face of the other are one patch, whatever triangles they belong to: kAnyGroup.
struct PatchKey {
  int body_a = -1, body_b = -1, group_a = -1, group_b = -1;
  bool operator==(const PatchKey&) const = default;
};

inline constexpr int kAnyGroup = -1;

/// How far an answer of the contact problem moves A's point at a patch's centre against B's, as rows of the
/// problem: off the surface and along two directions in it [m], and how far it turns about the normal [rad].
struct PatchMotion {
  Vec3 along_W = Vec3::Zero(), across_W = Vec3::Zero();  ///< the two directions, unit [-]
  QpRow off, along, across, about;
};

/// A patch that pushes, in this frame.
struct FrictionPatch {
  PatchKey key;
  int finder_patch = -1;         ///< one of the finder's patches that make it up
  double coefficient = 0.0;      ///< mu [-]
  double load_N = 0.0;           ///< N without friction; 0: it only held in the last frame [N]
  bool acts = true;              ///< false: let go
  double radius_m = 0.0;         ///< r, of the forces about their centre [m]
  double gap_m = 0.0;            ///< at the centre, beyond the skin; none where it is too small to count [m]
  Vec3 n_BA_W = Vec3::Zero();    ///< [-]
  Vec3 centre_W = Vec3::Zero();  ///< c [m]
  Vec3 on_A = Vec3::Zero(), on_B = Vec3::Zero();  ///< the anchor, in either body's frame [m]
  bool anchored = true;                           ///< false: the anchor was taken off
  Vec3 apart_W = Vec3::Zero();                    ///< a; none where it is too small to count [m]
  PatchMotion motion;
  double slip_m = 0.0;    ///< allowed without lifting [m]
  double slip_rad = 0.0;  ///< of turning about the normal [rad]
  std::size_t first_row = 0;
  std::uint32_t sticks_by =
      0;  ///< which of its rows hold while it sticks, a bit each; of the last frame first
};

/// What a patch slides by in the step of an answer, from its anchor, and turns by about its normal.
struct Slide {
  Vec3 displacement = Vec3::Zero();  ///< [m]
  double turn = 0.0;                 ///< [rad]
  double lift = 0.0;                 ///< off the other surface [m]
};

PatchKey key_of(const World& world, const ContactPatch& patch) noexcept;
/// What pushes along edge k of the cone: directions around the normal, then the two senses of turning.
Push cone_edge(const FrictionPatch& patch, std::size_t k) noexcept;
/// The rows of all these pushes, from the patch's motion, which begins with the direction d of edge 0. They
/// ask for nothing yet.
QpCone cone_of(const FrictionPatch& patch) noexcept;
/// By the patch's normal and centre; `along_W` is in the surface, unit.
PatchMotion motion_of(const FrictionPatch& patch, const Vec3& along_W,
                      const ConstraintProblem& problem) noexcept;
/// The same motion, told along other directions in the surface.
void turn_directions(const Vec3& along_W, PatchMotion& motion) noexcept;
Slide slide_of(const FrictionPatch& patch, const ConstraintProblem& problem) noexcept;

}  // namespace tactum
