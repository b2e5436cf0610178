#pragma once
/// A world and an ideal device that leads its body 0, frame by frame.

#include <memory>

#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum {

/// No damping, no smoothing: only the stretch of the coupling is felt.
struct Rig {
  World world;             ///< may be changed before the first step
  FrameSettings settings;  ///< may be changed between steps
  std::unique_ptr<Simulation> simulation;
  FrameReport report;
  Pose X_DH;
  int penetrating_frames = 0;

  explicit Rig(std::size_t bodies) {
    world.bodies.resize(bodies);
    // The tests give the bodies parts of several sizes; the wrench must not depend on their inertia.
    if (bodies > 0) {
      world.bodies[0].mass_kg = 0.05;
      world.bodies[0].inertia_B = 1e-5 /* kg m^2 */ * Mat3::Identity();
    }
    settings.tool.body = 0;
    settings.coupling.damping_Ns_per_m = 0.0;
    settings.coupling.damping_Nms_per_rad = 0.0;
    settings.smoothing.on = false;
  }
  const FrameState& begun() {
    if (!simulation) simulation = std::move(*Simulation::make(world, settings));
    return simulation->state();
  }
  const Pose& X_WB() { return begun().world.X_WB[0]; }
  const FrameReport& step(const Pose& X) {
    X_DH = X;
    begun();
    simulation->settings() = settings;
    simulation->step(X);
    report = simulation->report();
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
