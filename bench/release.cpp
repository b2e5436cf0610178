#include <algorithm>
#include <cmath>

#include "bench/stability.h"
#include "tactum/geometry/primitives.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::bench {
namespace {

constexpr double kUntilRelease_s = 1.0;  // so long it presses
constexpr double kAfterRelease_s = 6.0;  // and so long it is watched afterwards
constexpr double kDropped_m = 0.002;     // the block begins so far above the plate
constexpr double kAtRest_m_per_s = 1e-3;

/// A block over a plate whose top is at z = 0.
Result<World> block_over_plate() {
  const auto box = [](const Vec3& half_m) {
    return std::make_shared<const Part>(
        *part_from_clouds({make_box(half_m).vertices}, {.about_center_of_mass = true}));
  };
  World world;
  const Result<int> block = world.add({.part = box({0.02, 0.02, 0.02}),
                                       .mass_kg = 0.1,
                                       .X_WP = {Mat3::Identity(), {0, 0, 0.02 + kDropped_m}}});
  if (!block) return block.error();
  const Result<int> plate = world.add({.part = box({0.2, 0.2, 0.01}),
                                       .X_WP = {Mat3::Identity(), {0, 0, -0.01}},
                                       .joint = {.kind = JointKind::kFixed}});
  if (!plate) return plate.error();
  return world;
}

}  // namespace

ReleaseRow release_pressed(const SimulatedDeviceModel& model, double force_N, double rate_Hz) {
  ReleaseRow row;
  row.device = model.name;
  const HandModel hand = *hand_model("medium");
  const double wanted_N = std::min(force_N, 0.8 * model.max_force_N);
  SimulatedDevice probe(model, hand, nullptr);
  FrameSettings settings = settings_for(probe.info(), rate_Hz);
  settings.tool.body = 0;
  // The hand aims so far into the plate that its own spring and the coupling balance at the wanted force.
  const double aim_m =
      kDropped_m + wanted_N / settings.coupling.stiffness_N_per_m + wanted_N / hand.stiffness_N_per_m;
  auto motion = std::make_shared<ScriptedMotion>();
  motion->move_to(0.7 * kUntilRelease_s, {Mat3::Identity(), {0, 0, -aim_m}}).hold(kUntilRelease_s);
  SimulatedDevice device(model, hand, motion);
  Result<World> world = block_over_plate();
  if (!world) return row;
  Result<std::unique_ptr<Simulation>> made = Simulation::make(std::move(*world), settings);
  if (!made || !device.open()) return row;
  Simulation& simulation = **made;
  row.slew_limit_N = settings.safety.max_force_slew_N_per_s * settings.dt_s;
  Wrench sent;
  Vec3 released = Vec3::Zero();
  const auto frames = static_cast<long>((kUntilRelease_s + kAfterRelease_s) * rate_Hz);
  const auto opens = static_cast<long>(kUntilRelease_s * rate_Hz);
  for (long i = 0; i < frames; ++i) {
    const double now_s = static_cast<double>(i) / rate_Hz;
    if (i == opens) {
      device.hold_with(no_hand());
      row.pressed_N = sent.f.norm();
      released = device.true_pose().p;
    }
    DeviceSample sample;
    device.read(now_s, sample);
    const Wrench next = simulation.step(sample);
    device.write(next);
    if (i >= opens) {
      const double speed = device.true_twist().v.norm();
      row.peak_m_per_s = std::max(row.peak_m_per_s, speed);
      row.largest_step_N = std::max(row.largest_step_N, (next.f - sent.f).norm());
      row.least_share = std::min(row.least_share, simulation.report().port.stiffness_share);
      if (speed > kAtRest_m_per_s) row.rest_s = now_s - kUntilRelease_s;
    }
    sent = next;
  }
  row.at_rest = row.rest_s < kAfterRelease_s - 0.5;
  row.travelled_m = (device.true_pose().p - released).norm();
  return row;
}

nlohmann::ordered_json to_json(const ReleaseRow& row) {
  return {{"device", row.device},
          {"released_at_N", row.pressed_N},
          {"peak_speed_m_per_s", row.peak_m_per_s},
          {"rests_after_s", row.rest_s},
          {"at_rest", row.at_rest},
          {"largest_step_N", row.largest_step_N},
          {"slew_limit_N", row.slew_limit_N},
          {"least_stiffness_share", row.least_share},
          {"travelled_m", row.travelled_m}};
}

}  // namespace tactum::bench
