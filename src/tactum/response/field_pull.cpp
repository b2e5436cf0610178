#include "tactum/response/field_pull.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// A step is at most so many times the one that would end at the balance: at one and a half an error changes
/// its sign and halves.
constexpr double kOvershoot = 1.5;
/// From which fraction of the coupling's stiffness on a field is called steep beside it.
constexpr double kSteep = 0.5;

double work_over_step(const Wrench& load, std::span<const Pose> X_WB, const FieldPull& pull) {
  return power(load, twist_between(pull.X_WB_start, X_WB[Index(pull.body)], 1.0));
}

/// How stiff the field is beside the coupling, both against displacements and against turns [-].
double stiffness_beside(const Coupling& coupling, const FieldLoad& load) {
  return load.stiffness_N_per_m / coupling.stiffness_N_per_m +
         load.stiffness_Nm_per_rad / coupling.stiffness_Nm_per_rad;
}

}  // namespace

void find_field_load(const World& world, std::span<const Pose> X_WB, GraspedPart& grasped,
                     FieldPull& pull) noexcept {
  if (world.fields.empty()) return;
  const FieldLoad before = pull.load;
  const bool goes_on = grasped.body >= 0 && grasped.body == pull.body;
  pull.load = {};
  pull.body = grasped.body;
  if (grasped.body < 0) return;
  const Body& body = world.bodies[Index(grasped.body)];
  const Pose& X_WB_now = X_WB[Index(grasped.body)];
  pull.load = field_load(world.fields, body.field_points, X_WB_now, grasped.X_BH.p);
  if (goes_on) pull.given_J += 0.5 * work_over_step(pull.load.at_centre - before.at_centre, X_WB, pull);
  pull.X_WB_start = X_WB_now;
  grasped.in_field = true;
  grasped.field = pull.load;
}

void add_field_work(std::span<const Pose> X_WB, FieldPull& pull) noexcept {
  if (pull.body >= 0) pull.given_J += work_over_step(pull.load.at_centre, X_WB, pull);
}

Wrench field_at_handle(const GraspedPart& grasped, std::span<const Pose> X_WB) noexcept {
  if (!grasped.in_field) return {};
  return moved(grasped.field.at_centre, X_WB[Index(grasped.body)].R * grasped.X_BH.p);
}

GraspMetric step_metric(const Coupling& coupling, const GraspedPart& grasped, double dt_s) noexcept {
  const GraspMetric metric = grasp_metric(coupling, dt_s);
  const double needed = (1.0 + stiffness_beside(coupling, grasped.field)) / kOvershoot;
  return {std::max(metric.stiffness_N_per_m, coupling.stiffness_N_per_m * needed),
          std::max(metric.stiffness_Nm_per_rad, coupling.stiffness_Nm_per_rad * needed)};
}

Twist equilibrium_step(const Coupling& coupling, const GraspedPart& grasped, const Wrench& constant,
                       const Pose& X_WB) noexcept {
  const Twist missing = handle_at(grasped, X_WB).to_hand;
  if (!grasped.in_field && constant.f.isZero(0.0) && constant.t.isZero(0.0)) return missing;
  const double stiffer = std::max(1.0, (1.0 + stiffness_beside(coupling, grasped.field)) / kOvershoot);
  const Wrench load = moved(grasped.field.at_centre + constant, X_WB.R * grasped.X_BH.p);
  return {(missing.v + load.f / coupling.stiffness_N_per_m) / stiffer,
          (missing.w + load.t / coupling.stiffness_Nm_per_rad) / stiffer};
}

std::string field_sentence(const World& world, const Coupling& coupling) {
  if (world.fields.empty()) return "";
  double steep = 0.0;
  for (const ForceField& field : world.fields) steep += steepest(field);
  const double share = steep / coupling.stiffness_N_per_m;
  return fmt::format("force fields: up to {:.3g} N/m, {:.0f} % of the coupling{}", steep, 100.0 * share,
                     share > kSteep ? ": steeper than it can follow at full stiffness; lower their scale, or "
                                      "smooth them"
                                    : "");
}

}  // namespace tactum::inline v0_1
