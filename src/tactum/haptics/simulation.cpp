#include "tactum/haptics/simulation.h"

#include <algorithm>
#include <utility>

#include "tactum/haptics/coupling_gains.h"
#include "tactum/haptics/frame_snapshot.h"

namespace tactum::inline v0_1 {

namespace {

/// Whether the hand holds, or may pick up, a body that a pair joint joins to another one.
bool may_hold_joined(const World& world, const Tool& tool) {
  return std::any_of(world.pair_joints.begin(), world.pair_joints.end(), [&](const PairJoint& pair) {
    return tool.picks || pair.body == tool.body || pair.parent == tool.body;
  });
}

}  // namespace

Result<void> check_world(const World& world, const FrameSettings& settings) {
  for (const Body& body : world.bodies) {
    if (!body.part || body.part->surface.triangles.empty())
      return Error{"a body has no part", "none", "convex pieces or a surface", body.name};
    if (body.moves() && !(body.mass_kg > 0.0 && body.inertia_B.allFinite() && body.inertia_B.trace() > 0.0))
      return Error{"a body that moves has no mass or inertia", std::to_string(body.mass_kg) + " kg", "more",
                   body.name};
    if (!body.X_WB.finite()) return Error{"a body's pose is not finite", "", "numbers", body.name};
  }
  const int bodies = static_cast<int>(world.bodies.size());
  for (std::size_t h = 0; h < settings.hands(); ++h)
    if (const int tool = settings.hand(h).tool.body; tool >= bodies)
      return Error{"the tool holds a body that is not there", std::to_string(tool),
                   "less than " + std::to_string(bodies), ""};
  for (const PairCoefficients* table : {&settings.friction, &settings.impacts.restitution})
    if (!table->coefficients.empty() &&
        (table->bodies != bodies || table->coefficients.size() != world.bodies.size() * world.bodies.size()))
      return Error{"a table of friction or restitution is of another world",
                   std::to_string(table->bodies) + " bodies", std::to_string(bodies), ""};
  for (std::size_t h = 0; h < settings.hands(); ++h)
    if (const Tool& tool = settings.hand(h).tool;
        settings.response == ResponseModel::kPenalty && may_hold_joined(world, tool))
      return Error{
          "in the penalty response the hand cannot hold a body that is jointed to another one that moves",
          tool.picks ? "a tool that picks up any body" : "such a body as the tool",
          "response = \"constraint\", or a body without such joints as the tool", ""};
  if (!(settings.dt_s > 0.0))
    return Error{"the frame's step is not positive", std::to_string(settings.dt_s) + " s", "more", ""};
  return {};
}

FrameSettings settings_for(const DeviceInfo& info, double rate_Hz) {
  FrameSettings settings;
  settings.dt_s = 1.0 / rate_Hz;
  settings.safety = safety_limits(info);
  settings.port = port_settings(info);
  settings.coupling = coupling_gains(info, rate_Hz).coupling;
  return settings;
}

Result<std::unique_ptr<Simulation>> Simulation::make(World world, FrameSettings settings) {
  if (Result<void> sound = check_world(world, settings); !sound) return sound.error();
  return std::unique_ptr<Simulation>(new Simulation(std::move(world), std::move(settings)));
}

Simulation::Simulation(World world, FrameSettings settings)
    : world_(std::move(world)), settings_(std::move(settings)), state_(world_, settings_) {}

Wrench Simulation::step(const DeviceSample& sample) noexcept {
  FrameTick tick;
  tick.index = next_index_;
  tick.now_s = time_s();
  tick.period_s = settings_.dt_s;
  DeviceSample now = sample;
  now.time_s = tick.now_s;
  return run(now, tick);
}

Wrench Simulation::step(const Pose& X_DH) noexcept {
  DeviceSample sample;
  sample.valid = true;
  sample.X_DH = X_DH;
  return step(sample);
}

void Simulation::step(std::span<const HandSample> samples, std::span<Wrench> wrenches) noexcept {
  FrameTick tick;
  tick.index = next_index_;
  tick.now_s = time_s();
  tick.period_s = settings_.dt_s;
  run(samples, tick, wrenches);
}

void Simulation::run(std::span<const HandSample> samples, const FrameTick& tick,
                     std::span<Wrench> wrenches) noexcept {
  next_index_ = tick.index + 1;
  haptic_frame(world_, settings_, samples, tick, state_, report_, wrenches);
}

Wrench Simulation::run(const DeviceSample& sample, const FrameTick& tick) noexcept {
  next_index_ = tick.index + 1;
  return haptic_frame(world_, settings_, sample, tick, state_, report_);
}

Result<void> Simulation::restore(std::string_view snapshot, std::uint64_t next_index) {
  next_index_ = next_index;
  return read_snapshot(snapshot, state_);
}

}  // namespace tactum::inline v0_1
