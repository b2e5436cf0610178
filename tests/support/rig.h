#pragma once
/// A world and an ideal device that leads its body 0, frame by frame.

#include <memory>

#include "tactum/haptics/frame.h"
#include "tactum/math/screw.h"

namespace tactum {

/// No damping, no smoothing: what is felt is the stretch of the coupling alone.
struct Rig {
  World world;
  FrameSettings settings;
  std::unique_ptr<FrameState> state;
  FrameReport report;
  Pose X_DH;
  std::uint64_t frame = 0;
  int penetrating_frames = 0;

  explicit Rig(std::size_t bodies) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    world.bodies.resize(bodies);
    world.bodies[0].mass_kg = 0.05;
    world.bodies[0].inertia_B = 1e-5 /* kg m^2 */ * Mat3::Identity();
    settings.tool.body = 0;
    settings.coupling.damping_Ns_per_m = 0.0;
    settings.coupling.damping_Nms_per_rad = 0.0;
    settings.smoothing = {kInfinity, kInfinity};
  }
  FrameState& begun() {
    if (!state) state = std::make_unique<FrameState>(world, settings);
    return *state;
  }
  const Pose& X_WB() { return begun().world.X_WB[0]; }
  const FrameReport& step(const Pose& X) {
    X_DH = X;
    DeviceSample sample;
    sample.valid = true;
    sample.time_s = static_cast<double>(frame) * settings.dt_s;
    sample.X_DH = X;
    FrameTick tick;
    tick.index = frame++;
    tick.now_s = sample.time_s;
    tick.period_s = settings.dt_s;
    haptic_frame(world, settings, sample, tick, begun(), report);
    penetrating_frames += report.penetrating ? 1 : 0;
    return report;
  }
  /// From where the handle is to X in `frames` frames.
  const FrameReport& go(const Pose& X, int frames) {
    const Pose from = X_DH;
    for (int i = 1; i <= frames; ++i) step(interpolated(from, X, static_cast<double>(i) / frames));
    return report;
  }
};

}  // namespace tactum
