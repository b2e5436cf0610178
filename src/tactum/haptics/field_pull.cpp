#include "tactum/haptics/field_pull.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactum/haptics/frame_state.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// A step is at most so much more than what would end at the balance: at one and a half an error changes its
/// sign and halves.
constexpr double kOvershoot = 1.5;
/// From where on a field is called steep beside the coupling, a share of its stiffness.
constexpr double kSteep = 0.5;

double work_over_step(const Wrench& load, const FrameState& state) {
  const Index held = Index(state.field.body);
  return power(load, twist_between(state.X_WB_start[held], state.world.X_WB[held], 1.0));
}

/// How stiff the field is beside the coupling, both against ways and against turns [-].
double stiffness_beside(const Coupling& coupling, const FieldLoad& load) {
  return load.stiffness_N_per_m / coupling.stiffness_N_per_m +
         load.stiffness_Nm_per_rad / coupling.stiffness_Nm_per_rad;
}

}  // namespace

void pull_by_fields(const World& world, FrameState& state) noexcept {
  FieldPull& pull = state.field;
  const int held = state.tool.body;
  if (world.fields.empty()) return;
  const FieldLoad before = pull.load;
  const bool goes_on = held >= 0 && held == pull.body;
  pull.load = {};
  pull.body = held;
  if (held < 0) return;
  const Body& body = world.bodies[Index(held)];
  pull.load = field_load(world.fields, body.field_points, state.world.X_WB[Index(held)], state.tool.X_BH.p);
  if (goes_on) pull.given_J += 0.5 * work_over_step(pull.load.at_centre - before.at_centre, state);
}

void book_field_work(FrameState& state) noexcept {
  if (state.field.body >= 0) state.field.given_J += work_over_step(state.field.load.at_centre, state);
}

Wrench field_at_handle(const FrameState& state) noexcept {
  if (state.field.body < 0) return {};
  const Pose& X_WB = state.world.X_WB[Index(state.field.body)];
  return moved(state.field.load.at_centre, X_WB.R * state.tool.X_BH.p);
}

HeldMetric step_metric(const FrameSettings& settings, double dt_s, const FrameState& state) noexcept {
  const Coupling& coupling = settings.coupling;
  const HeldMetric metric = held_metric(coupling, dt_s);
  const double needed = (1.0 + stiffness_beside(coupling, state.field.load)) / kOvershoot;
  return {std::max(metric.stiffness_N_per_m, coupling.stiffness_N_per_m * needed),
          std::max(metric.stiffness_Nm_per_rad, coupling.stiffness_Nm_per_rad * needed)};
}

Pose loaded_hand(const FrameSettings& settings, const FrameState& state) noexcept {
  if (state.field.body < 0) return state.hand.X_WH;
  const Coupling& coupling = settings.coupling;
  const double stiffer = std::max(1.0, (1.0 + stiffness_beside(coupling, state.field.load)) / kOvershoot);
  const Pose X_WH_proxy = state.world.X_WB[Index(state.field.body)] * state.tool.X_BH;
  const Twist way = twist_between(X_WH_proxy, state.hand.X_WH, 1.0);
  const Wrench load = field_at_handle(state);
  const Twist step{(way.v + load.f / coupling.stiffness_N_per_m) / stiffer,
                   (way.w + load.t / coupling.stiffness_Nm_per_rad) / stiffer};
  return advanced(X_WH_proxy, step, 1.0);
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

}  // namespace tactum
