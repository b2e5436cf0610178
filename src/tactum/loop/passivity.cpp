#include "tactum/loop/passivity.h"

#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kMostChange_N_per_s = 20.0;
constexpr double kMostChange_Nm_per_s = 0.4;  // the same at a lever of 20 mm
constexpr double kFastest_per_s = 5.0;        // fall of the share
constexpr double kLeastShare = 0.01;          // so that the scene is never lost

/// Below this the coupling's spring is at rest [J]: 600 N/m stretched by 2 um.
constexpr double kAtRest_J = 1e-9;

/// The balance that a port begins with, so that the first touch is not a debt [J].
constexpr double kFirst_J = 2e-4;

/// A deficit is kept up to this part of what the spring holds. It is there to soften a coupling until it
/// generates no more; a debt that grew faster than the stiffness may sink would soften it far beyond that.
constexpr double kMostDebt = 0.1;

/// The mean wrench of the scene that acted on the handle since the last frame: commands come later by the
/// delay.
Wrench acted(const PortSettings& settings, const SentHistory& history, double dt_s) noexcept {
  const double frames = std::clamp(settings.delay_s / dt_s, 0.0, SentHistory::kLongestDelay - 1.0);
  const int whole = static_cast<int>(frames);
  const double rest = frames - whole;
  const auto back = [&history](int count) {
    const int size = SentHistory::kLongestDelay + 1;
    return history.wrenches[static_cast<std::size_t>((history.newest - count + size) % size)];
  };
  const Wrench command = back(whole);
  return rest > 0.0 ? command * (1.0 - rest) + back(whole + 1) * rest : command;
}

/// Adds the work of a force (torque) over a displacement.
void add_up(const Vec3& displacement, const Vec3& force, EnergyTotals& total) noexcept {
  const double work_J = force.dot(displacement);
  (work_J > 0.0 ? total.to_hand_J : total.from_hand_J) += std::abs(work_J);
}

/// What the device itself eats at least, of a displacement in one frame.
double dissipated(double damping, double friction, const Vec3& displacement, double dt_s) noexcept {
  return damping * displacement.squaredNorm() / dt_s + friction * displacement.norm();
}

void book(const PortSettings& settings, PortState& state, const Twist& moved,
          const PortInput& input) noexcept {
  const double added_J = input.ramp * (state.added.f.dot(moved.v) + state.added.t.dot(moved.w));
  state.tank_J = std::min(state.tank_J - added_J, kTank_J);
  if (input.ramp < 1.0 || !input.stored.same_coupling(state.stored)) return;  // changed without work
  const Wrench F = acted(settings, state.history, input.dt_s);
  add_up(moved.v, F.f, state.booked.total);
  add_up(moved.w, F.t, state.booked.total_turning);
  const double passed_J =
      -F.f.dot(moved.v) - F.t.dot(moved.w) +
      dissipated(settings.damping_Ns_per_m, settings.friction_N, moved.v, input.dt_s) +
      dissipated(settings.damping_Nms_per_rad, settings.friction_Nm, moved.w, input.dt_s) -
      (input.stored.total_J - state.stored.total_J);
  const double before_J = state.booked.balance_J;
  state.booked.balance_J = std::min(before_J + passed_J, settings.credit_J);
  state.booked.generated_J += std::max(0.0, std::min(0.0, before_J) - state.booked.balance_J);
  if (settings.keeps_balance)
    state.booked.balance_J = std::max(state.booked.balance_J, -kMostDebt * input.stored.spring_J);
}

/// Lowers the share while energy is missing; raises it while the spring is at rest.
void move_share(PortState& state, const PortInput& input) noexcept {
  const StoredEnergy& stored = input.stored;
  if (stored.spring_J < kAtRest_J) {
    state.booked.stiffness_share = std::min(1.0, state.booked.stiffness_share + input.dt_s / kRestored_s);
    return;
  }
  if (!(state.booked.balance_J < 0.0)) return;
  double fall = std::min(-state.booked.balance_J / stored.spring_J, kFastest_per_s * input.dt_s);
  if (stored.force_N > 0.0) fall = std::min(fall, kMostChange_N_per_s * input.dt_s / stored.force_N);
  if (stored.torque_Nm > 0.0) fall = std::min(fall, kMostChange_Nm_per_s * input.dt_s / stored.torque_Nm);
  const double share = std::max(kLeastShare, state.booked.stiffness_share * (1.0 - fall));
  state.booked.paid_J += stored.spring_J * (1.0 - share / state.booked.stiffness_share);
  state.booked.stiffness_share = share;
}

/// Whether a frame can be booked. What is not a number would stay in the balance for ever; safety sends zero.
bool is_finite(const PortInput& input) noexcept {
  const StoredEnergy& stored = input.stored;
  return input.felt.finite() && input.wanted.finite() && input.unfelt_Nm.allFinite() &&
         std::isfinite(stored.total_J + stored.spring_J + stored.force_N + stored.torque_Nm);
}

}  // namespace

HandleMotion handle_motion(const PortState& state, const DeviceSample& sample) noexcept {
  HandleMotion motion{.X_DH = sample.X_DH, .measured = sample.valid && plausible(sample.X_DH), .moved = {}};
  if (motion.measured && state.known) motion.moved = twist_between(state.X_DH, sample.X_DH, 1.0);
  return motion;
}

Wrench passive_wrench(const PortSettings& settings, PortState& state, const HandleMotion& motion,
                      const PortInput& input, PortReport& report) noexcept {
  SentHistory& history = state.history;
  history.newest = (history.newest + 1) % (SentHistory::kLongestDelay + 1);
  history.wrenches[static_cast<std::size_t>(history.newest)] =
      Wrench{input.sent.f, settings.actuates_torque ? input.sent.t : state.unfelt_Nm} - state.added;
  if (!is_finite(input)) {
    state.added = {};
    state.unfelt_Nm.setZero();
    report = state.booked;
    return input.wanted;
  }
  state.unfelt_Nm = input.unfelt_Nm;
  if (motion.measured && input.dt_s > 0.0) {
    if (state.known) book(settings, state, motion.moved, input);
    if (state.known && settings.keeps_balance) move_share(state, input);
    if (!state.known) state.booked.balance_J = std::min(kFirst_J, settings.credit_J);
    state.X_DH = motion.X_DH;
    state.stored = input.stored;
    state.booked.stored_J = input.stored.total_J;
    state.known = true;
  }
  const double left = 2.0 * (settings.credit_J + state.tank_J) / settings.credit_J;
  const double added_share = settings.keeps_balance ? std::clamp(left, 0.0, 1.0) : 1.0;
  state.added = (input.wanted - input.felt) * added_share;
  state.booked.added_share = added_share;
  report = state.booked;
  return added_share < 1.0 ? input.felt + state.added : input.wanted;
}

}  // namespace tactum::inline v0_1
