#pragma once
/// Force fields and the grasped part: their load on it in this frame, how far that may move it, and the work
/// they have done on it so far.
///
/// A field is felt like weight: it loads the grasped part, and the coupling carries the load. Only the proxy
/// is in the field; the hand feels nothing stiffer than the coupling. The load is that of the pose before the
/// step, so in a field much steeper than the coupling a full step would overshoot. The step
///
///     x = (k d + b v + W) / K,     K = k + b / dt,   but at least  2/3 (k + field)
///
/// with d the displacement to the hand is shorter then; the pose at which the steps end is the same.

#include <span>
#include <string>

#include "tactum/dynamics/force_field.h"
#include "tactum/dynamics/world.h"
#include "tactum/response/coupling.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// The load of force fields on the grasped part, from frame to frame, and the work it did.
struct FieldPull {
  FieldLoad load;        ///< at the pose the frame starts with
  double given_J = 0.0;  ///< work on grasped parts since the start, of either sign [J]
  int body = -1;         ///< on which the load acts; -1: none
  Pose X_WB_start;       ///< its pose at the start of the frame [m]
};

/// Finds the load on the grasped body in this frame, and corrects the work of the last step by the load at
/// its end.
void find_field_load(const World& world, std::span<const Pose> X_WB, GraspedPart& grasped,
                     FieldPull& pull) noexcept;

/// Adds the work of the load over the frame's step.
void add_field_work(std::span<const Pose> X_WB, FieldPull& pull) noexcept;

/// The load, stated at the handle, world axes.
Wrench field_at_handle(const GraspedPart& grasped, std::span<const Pose> X_WB) noexcept;

/// The metric of the coupling over one frame, made as stiff as the load requires for a step that is short
/// enough.
GraspMetric step_metric(const Coupling& coupling, const GraspedPart& grasped, double dt_s) noexcept;

/// In the penalty response: the displacement of the handle to where the coupling carries the load of fields
/// and `constant`, weight and load at the centre of mass, or as far towards it as is safe. X_WB is the
/// grasped body's.
Twist equilibrium_step(const Coupling& coupling, const GraspedPart& grasped, const Wrench& constant,
                       const Pose& X_WB) noexcept;

/// How steep the scene's fields are beside the coupling, in a sentence for people; empty without fields.
std::string field_sentence(const World& world, const Coupling& coupling);

}  // namespace tactum::inline v0_1
