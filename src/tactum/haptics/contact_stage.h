#pragma once
/// The stage of a frame that finds where bodies touch: the contact finder, with the priorities of bodies, and
/// the shading of their faces.

#include <vector>

#include "tactum/response/frame_report.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

struct ContactStage {
  ContactStage(const World& world, const FrameSettings& settings, std::span<const Pose> X_WB);

  ContactFinder finder;
  std::vector<std::uint8_t> priority;   ///< of each body (contact/schedule.h)
  std::vector<ShadingNormals> shading;  ///< one per body; empty when shading is off, or bends no normal

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.finder, self.priority);
  }
};

/// Finds which pairs could touch, when no point of body i moves farther than `motion_bound[i]` [m]. Grasped
/// parts, and bodies that touched one in the last frame, go first: fills stage.priority.
void find_near_pairs(const FrameSettings& settings, std::span<const Pose> X_WB,
                     std::span<const double> motion_bound, std::span<const HandInput> hands,
                     ContactStage& stage) noexcept;

/// Finds where the near pairs touch. Adds the work, the smallest distance and the flags to the report.
std::span<const ContactPatch> find_patches(const World& world, const FrameSettings& settings,
                                           std::span<const Pose> X_WB, PatchPoints points,
                                           ContactStage& stage, FrameReport& report) noexcept;

}  // namespace tactum::inline v0_1
