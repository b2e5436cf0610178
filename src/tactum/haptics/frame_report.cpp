#include "tactum/haptics/frame_report.h"

namespace tactum {
namespace {

void add(FrameHash& hash, const Vec3& v) {
  for (int i = 0; i < 3; ++i) hash.add(v[i] + 0.0);  // one zero, whatever its sign
}

void add(FrameHash& hash, const Wrench& F) {
  add(hash, F.f);
  add(hash, F.t);
}

void add(FrameHash& hash, const Pose& X) {
  add(hash, X.p);
  for (int i = 0; i < 3; ++i) add(hash, Vec3(X.R.col(i)));
}

}  // namespace

void add_to(FrameHash& hash, const FrameReport& report) noexcept {
  hash.add(report.index);
  hash.add(report.flags);
  hash.add(report.safety);
  add(hash, report.X_WH);
  add(hash, report.X_WH_proxy);
  add(hash, report.restoring);
  add(hash, report.field);
  add(hash, report.coupling);
  add(hash, report.smoothed);
  hash.add(report.port.ledger_J + 0.0);
  hash.add(report.port.ledger_turning_J + 0.0);
  hash.add(report.port.injected_Ns_per_m + 0.0);
  hash.add(report.port.injected_Nms_per_rad + 0.0);
  for (const EnergyTotals& total : {report.port.total, report.port.total_turning})
    for (double energy_J : {total.from_hand_J, total.to_hand_J, total.damped_J}) hash.add(energy_J + 0.0);
  add(hash, report.shown);
  hash.add(report.tolerance_m);
  hash.add(report.min_distance_m);
  hash.add(report.time_of_impact_s);
  hash.add(report.contact_points);
  hash.add(report.solver_iterations);
  hash.add(report.active_constraints);
  hash.add(report.validation_tests);
  hash.add(report.validation_retries);
  hash.add(report.waiting);
  hash.add(report.cut_short);
  hash.add(report.momentum_off_Ns);
  hash.add(report.friction.sticking);
  hash.add(report.friction.slipping);
  hash.add(report.friction.cone_used + 0.0);
  hash.add(report.work.near_pairs);
  hash.add(report.work.exact_tests);
  hash.add(report.work.feature_steps);
  hash.add(report.work.patches);
  hash.add(report.held_contact_points);
  hash.add(report.penetrating);
  hash.add(report.work.broad_phase_runs);
  hash.add(report.work.known);
  hash.add(report.work.unchecked);
  hash.add(report.work.left_unproven);
  hash.add(report.work.uncertified);
}

void add_to(FrameHash& hash, const WorldState& state) noexcept {
  for (const Pose& X_WB : state.X_WB) add(hash, X_WB);
  for (const Twist& V_WB : state.V_WB) {
    add(hash, V_WB.v);
    add(hash, V_WB.w);
  }
}

}  // namespace tactum
