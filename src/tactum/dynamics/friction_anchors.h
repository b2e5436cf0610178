#pragma once
/// The memory of friction patches from frame to frame: where they stick, and where their forces had their
/// centre.

#include <span>

#include "tactum/base/reserved_vector.h"
#include "tactum/dynamics/friction_patch.h"
#include "tactum/math/pose.h"

namespace tactum::inline v0_1 {

struct FrictionAnchor {
  SurfacePair surfaces;
  Vec3 n_A = Vec3::Zero();                        ///< the patch's normal, in A's frame [-]
  Vec3 on_A = Vec3::Zero(), on_B = Vec3::Zero();  ///< the anchor in either body's frame [m]
  Vec3 centre_A = Vec3::Zero();                   ///< the centre of its forces, in A's frame [m]
  Vec3 apart_W = Vec3::Zero();  ///< of a patch that rolls: what it slid without slipping [m]
  double radius_m = 0.0;        ///< of its forces about their centre [m]
  std::uint32_t sticking = 0;   ///< see PatchRows
  bool pushed = false;          ///< friction pushed
  bool slid = false;            ///< it is anchored anew, at its centre
  Vec3 force_W = Vec3::Zero();  ///< in the surface, on A; the sweeps begin with it [N]
  double torque_Nm = 0.0;       ///< ... and about the normal [N m]
};

class FrictionAnchors {
 public:
  explicit FrictionAnchors(std::size_t most_patches) {
    last_.reserve(most_patches);
    now_.reserve(most_patches);
    order_.reserve(most_patches);
  }
  /// The last frame's anchor of a patch; null when it had none. It is that of the same surfaces; where there
  /// is none, as when a body slides from one piece of a floor on to the next, that of the same bodies in the
  /// same plane, no farther off it than `same_plane_m`. All fixed bodies are the same there: the anchor is in
  /// the frames of the bodies that its own surfaces name.
  const FrictionAnchor* find(const FrictionPatch& patch, std::span<const Pose> X_WB,
                             double same_plane_m) const noexcept;
  /// The last frame's anchor of the same surfaces, null when there is none.
  const FrictionAnchor* find(const SurfacePair& surfaces) const noexcept;
  /// Stores an anchor for the next frame; of several of the same surfaces the last one counts.
  void add(const FrictionAnchor& anchor) noexcept {
    if (now_.size() < now_.capacity()) now_.push_back(anchor);
  }
  /// Ends the frame: the anchors that were added are the last frame's from now on. The anchors of bodies that
  /// do not move in this frame are kept: `moves(body)`.
  template <class Moves>
  void end_frame(const Moves& moves) noexcept {
    for (const FrictionAnchor& anchor : last_)
      if (!moves(anchor.surfaces.body_a) && !moves(anchor.surfaces.body_b)) add(anchor);
    sort_and_exchange();
  }
  void forget() noexcept {
    last_.clear();
    now_.clear();
  }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.last_, self.now_);
  }

 private:
  void sort_and_exchange() noexcept;

  ReservedVector<FrictionAnchor> last_, now_;  // last_ is sorted by surfaces
  ReservedVector<int> order_;                  // scratch
};

}  // namespace tactum::inline v0_1
