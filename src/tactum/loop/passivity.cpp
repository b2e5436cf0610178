#include "tactum/loop/passivity.h"

#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

/// One of the two balances over one step.
struct Step {
  Vec3 displacement;  // made since the last frame
  Vec3 sent;          // force (torque) that acted meanwhile
  double damping;     // the device's own
  double given_J;     // by the scene's bodies
  double highest_J;   // upper bound of the balance
  double credit_J;
  double max_injected;
  double dt_s;
};

void book(const Step& step, double& energy_balance_J) noexcept {
  const double passed_J = -step.sent.dot(step.displacement) +
                          step.damping * step.displacement.squaredNorm() / step.dt_s + step.given_J;
  energy_balance_J = std::clamp(energy_balance_J + passed_J, -step.credit_J, step.highest_J);
}

/// Adds the work of the wrench, and of the controller's part of it, over a displacement.
void add_up(const Vec3& displacement, const Vec3& sent, const Vec3& damper, EnergyTotals& total) noexcept {
  const double work_J = sent.dot(displacement);
  (work_J > 0.0 ? total.to_hand_J : total.from_hand_J) += std::abs(work_J);
  total.damped_J -= damper.dot(displacement);
}

/// A thread turns one kind of work into the other: a deficit of one balance is covered by the other as far as
/// it can.
void settle(double& energy_balance_J, double& other_J) noexcept {
  const double paid_J = std::max(0.0, std::min(-energy_balance_J, other_J));
  energy_balance_J += paid_J;
  other_J -= paid_J;
}

/// The damping to add.
double injected(const Step& step, double energy_balance_J) noexcept {
  const double length_sq = step.displacement.squaredNorm();
  if (!(energy_balance_J < 0.0) || length_sq == 0.0) return 0.0;
  // a |V|^2 dt = - balance, with V = displacement / dt; a huge quotient is cut to what is allowed
  return std::min(-energy_balance_J * step.dt_s / length_sq, step.max_injected);
}

}  // namespace

Wrench passive_wrench(const PortSettings& settings, PortState& state, const DeviceSample& sample,
                      const PortInput& input, PortReport& report) noexcept {
  Wrench F = input.wanted;
  if (!settings.actuates_torque) F.t.setZero();
  report = {};
  if (sample.valid && plausible(sample.X_DH) && input.dt_s > 0.0) {
    const Twist displacement = state.known ? twist_between(state.X_DH, sample.X_DH, 1.0) : Twist{};
    const double given_J = state.known ? std::max(0.0, state.bodies_J - input.bodies_J) : 0.0;
    const Step moved{displacement.v,
                     input.sent.f,
                     settings.damping_Ns_per_m,
                     given_J,
                     settings.credit_J + input.spring_J,
                     settings.credit_J,
                     settings.max_injected_Ns_per_m,
                     input.dt_s};
    const Step turned{displacement.w,
                      input.sent.t,
                      settings.damping_Nms_per_rad,
                      given_J,
                      settings.credit_turning_J + input.spring_turning_J,
                      settings.credit_turning_J,
                      settings.actuates_torque ? settings.max_injected_Nms_per_rad : 0.0,
                      input.dt_s};
    add_up(displacement.v, input.sent.f, state.damper.f, state.total);
    add_up(displacement.w, input.sent.t, state.damper.t, state.total_turning);
    book(moved, state.energy_balance_J);
    book(turned, state.energy_balance_turning_J);
    if (settings.actuates_torque) {
      settle(state.energy_balance_J, state.energy_balance_turning_J);
      settle(state.energy_balance_turning_J, state.energy_balance_J);
    }
    report.injected_Ns_per_m = injected(moved, state.energy_balance_J);
    report.injected_Nms_per_rad = injected(turned, state.energy_balance_turning_J);
    state.damper = {-report.injected_Ns_per_m / input.dt_s * displacement.v,
                    -report.injected_Nms_per_rad / input.dt_s * displacement.w};
    F = F + state.damper;
    state.X_DH = sample.X_DH;
    state.bodies_J = input.bodies_J;
    state.known = true;
  } else {
    state.damper = {};
  }
  report.total = state.total;
  report.total_turning = state.total_turning;
  report.energy_balance_J = state.energy_balance_J;
  report.energy_balance_turning_J = state.energy_balance_turning_J;
  return F;
}

}  // namespace tactum::inline v0_1
