#include "bench/feel.h"

#include <algorithm>
#include <cmath>

#include "bench/clock.h"
#include "bench/overlap.h"
#include "bench/peers/feel_peers.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::bench {
namespace {

constexpr double kMoved_m = 1e-5;  // beyond this it has begun to slide

std::shared_ptr<const Part> part_of(const std::vector<FeelPiece>& pieces) {
  std::vector<std::vector<Vec3>> clouds;
  for (const FeelPiece& piece : pieces) {
    clouds.emplace_back();
    for (const Vec3& v : piece.shape.polytope.vertices) clouds.back().push_back(piece.X_BP * v);
  }
  return std::make_shared<const Part>(*part_from_clouds(clouds));
}

/// The haptic frame on an ideal device, without smoothing; the coupling's damper is left out, so that at rest
/// and in motion only the spring acts.
class Ours final : public FeelEngine {
 public:
  explicit Ours(const FeelScene& scene) {
    X_start_ = scene.hand->at(0.0).X_DH;
    World world;
    world.bodies.resize(2);
    world.bodies[0].part = part_of(scene.grasped);
    world.bodies[0].mass_kg = kFeltMass_kg;  // as every engine gets it, whatever the part
    world.bodies[0].inertia_B = kFeltInertia_kg_m2 * Mat3::Identity();
    world.bodies[0].X_WB = X_start_;
    world.bodies[1].part = part_of(scene.fixed);
    world.bodies[1].joint.kind = JointKind::kFixed;
    FrameSettings settings;
    settings.tool.body = 0;
    settings.coupling = scene.coupling;
    settings.coupling.damping_Ns_per_m = 0.0;
    settings.coupling.damping_Nms_per_rad = 0.0;
    settings.smoothing.on = false;
    settings.workspace.X_WD.p = X_start_.p;
    const double mu = scene.friction;
    if (mu > 0.0) settings.friction = {{0.0, mu, mu, 0.0}, 2};
    simulation_ = std::move(*Simulation::make(std::move(world), std::move(settings)));
  }
  void step(const Pose& X_WH) override { simulation_->step(Pose{X_WH.R, X_WH.p - X_start_.p}); }
  Pose X_WB() const override { return simulation_->bodies().X_WB[0]; }
  Wrench felt() const override { return simulation_->report().coupling; }
  double skin_m() const override {  // of body 0, the only one that moves
    return simulation_->state().response.constraint()->memory().constraint.skin_m[0];
  }

 private:
  std::unique_ptr<Simulation> simulation_;
  Pose X_start_;
};

std::unique_ptr<FeelEngine> make_ours(const FeelScene& scene, const FeelSetup&) {
  return std::make_unique<Ours>(scene);
}

/// Measures the overlap of the scene's pieces at any pose of the grasped part.
class Referee {
 public:
  explicit Referee(const FeelScene& scene) : depth_(scene.depth) {
    for (const FeelPiece& piece : scene.grasped)
      grasped_.push_back(overlap_piece(piece.shape.polytope, piece.X_BP));
    for (const FeelPiece& piece : scene.fixed)
      fixed_.push_back(overlap_piece(piece.shape.polytope, piece.X_BP));
  }
  double operator()(const Pose& X_WB) const {
    if (depth_) return depth_(X_WB);
    double deepest = 0.0;
    for (const OverlapPiece& piece : grasped_) {
      const OverlapPiece here = carried(piece, X_WB);
      for (const OverlapPiece& other : fixed_) deepest = std::max(deepest, overlap(here, other));
    }
    return deepest;
  }

 private:
  std::function<double(const Pose&)> depth_;
  std::vector<OverlapPiece> grasped_, fixed_;
};

/// One run, frame by frame: the queries of every engine and scene.
struct FeelRun {
  Pose X_WH, X_WB;
  Wrench felt, last;
  double time_s = 0.0;
};

/// Leads the engine through the scene; returns the mean time of a step [us].
double lead(const FeelScene& scene, FeelEngine& engine, const std::function<void(const FeelRun&)>& look) {
  static const FineClock clock;
  const auto frames = static_cast<int>(scene.hand->duration_s() / kFeelStep_s);
  double ns = 0.0;
  FeelRun run;
  for (int i = 0; i <= frames; ++i) {
    run.time_s = i * kFeelStep_s;
    run.X_WH = scene.hand->at(run.time_s).X_DH;
    const std::uint64_t begun = clock.start();
    engine.step(run.X_WH);
    ns += clock.ns(clock.stop() - begun);
    run.X_WB = engine.X_WB();
    run.last = run.felt;
    run.felt = engine.felt();
    if (i > 0) look(run);
  }
  return 1e-3 * ns / (frames + 1);
}

/// The energy that the hand has put in, with the mean of the forces at the two ends of each step [J].
class EnergyBalance {
 public:
  void add(const FeelRun& run) {
    if (known_) {
      const Vec3 displacement = run.X_WH.p - last_.p;
      const Vec3 turn = log_rotation(run.X_WH.R * last_.R.transpose());
      put_in_J -= 0.5 * ((run.felt.f + run.last.f).dot(displacement) + (run.felt.t + run.last.t).dot(turn));
    }
    known_ = true;
    last_ = run.X_WH;
  }
  double put_in_J = 0.0;

 private:
  bool known_ = false;
  Pose last_;
};

void judge(const FeelScene& scene, const FeelEngine& engine, const FeelRun& run, FeelRow& row) {
  const Wrench truth = scene.truth(run.X_WH, engine.skin_m());
  row.force_error_N = std::max(row.force_error_N, (run.felt.f - truth.f).norm());
  row.torque_error_Nm = std::max(row.torque_error_Nm, (run.felt.t - truth.t).norm());
  row.direction_error_rad = std::max(row.direction_error_rad,
                                     std::atan2(run.felt.f.cross(truth.f).norm(), run.felt.f.dot(truth.f)));
  row.force_step_N = std::max(row.force_step_N, (run.felt.f - run.last.f).norm());
}

/// Watches a part with friction: its creep while judged, and the force at which it begins to slide after
/// that.
class Sliding {
 public:
  explicit Sliding(const FeelScene& scene) : scene_(scene) {}
  void look(const FeelRun& run, FeelRow& row) {
    const Vec3 in_plane(run.X_WB.p.x(), run.X_WB.p.y(), 0);
    if (run.time_s < scene_.judged_from_s) rested_ = in_plane;
    if (run.time_s <= scene_.judged_to_s) {
      crept_ = in_plane;
      return;
    }
    if (slides_ || (in_plane - crept_).norm() < kMoved_m) return;
    slides_ = true;
    // The frame before it began to move carried the most.
    const double carried = run.last.f.head<2>().norm() / run.last.f.z();
    row.friction_error = std::abs(carried / scene_.friction - 1.0);
    row.creep_m_per_s = (crept_ - rested_).norm() / (scene_.judged_to_s - scene_.judged_from_s);
  }

 private:
  const FeelScene& scene_;
  Vec3 rested_ = Vec3::Zero(), crept_ = Vec3::Zero();
  bool slides_ = false;
};

PegRow insert(double clearance_m, int hands, const FeelEngineEntry& entry, const FeelSetup& setup) {
  constexpr double kAtFloor_m = 1e-4;
  constexpr double kOut_m = 0.069;  // its middle, when the tip is 9 mm above the floor's block
  PegRow row;
  row.engine = entry.name;
  row.setup = setup;
  row.clearance_m = clearance_m;
  row.hands = hands;
  for (int hand = 0; hand < hands; ++hand) {
    const FeelScene scene = peg_scene(clearance_m, hand);
    const std::unique_ptr<FeelEngine> engine = entry.make(scene, setup);
    const Referee depth(scene);
    double lowest = 1.0, last = 1.0;
    const double us = lead(scene, *engine, [&](const FeelRun& run) {
      row.penetration_m = std::max(row.penetration_m, depth(run.X_WB));
      row.force_step_N = std::max(row.force_step_N, (run.felt.f - run.last.f).norm());
      lowest = std::min(lowest, run.X_WB.p.z());
      last = run.X_WB.p.z();
    });
    row.frame_us += us / hands;
    row.inserted += lowest < 0.03 + kAtFloor_m && last > kOut_m ? 1 : 0;
  }
  return row;
}

bool better(const PegRow& a, const PegRow& b) {
  if (a.inserted != b.inserted) return a.inserted > b.inserted;
  return a.penetration_m < b.penetration_m;
}

}  // namespace

std::vector<FeelEngineEntry> feel_engines() {
  std::vector<FeelEngineEntry> engines = {{"tactum", make_ours, {{}}}};
  std::vector<FeelSetup> setups;
  for (const int substeps : {1, 4})
    for (const double erp : {0.2, 0.8}) setups.push_back({substeps, erp});
#ifdef TACTUM_PEER_BULLET
  engines.push_back({"bullet", make_bullet_feel, setups});
#endif
#ifdef TACTUM_PEER_ODE
  engines.push_back({"ode", make_ode_feel, setups});
#endif
  return engines;
}

FeelRow feel(const FeelSceneEntry& what, const FeelEngineEntry& entry, const FeelSetup& setup) {
  const FeelScene scene = what.make();
  FeelRow row;
  row.scene = what.name;
  row.engine = entry.name;
  row.setup = setup;
  const std::unique_ptr<FeelEngine> engine = entry.make(scene, setup);
  const Referee depth(scene);
  EnergyBalance balance;
  Sliding sliding(scene);
  row.frame_us = lead(scene, *engine, [&](const FeelRun& run) {
    row.penetration_m = std::max(row.penetration_m, depth(run.X_WB));
    balance.add(run);
    if (scene.begins_to_slide) sliding.look(run, row);
    if (run.time_s >= scene.judged_from_s && run.time_s <= scene.judged_to_s) judge(scene, *engine, run, row);
  });
  row.energy_made_J = std::max(0.0, -balance.put_in_J);
  return row;
}

FeelReport bench_feel(const FeelOptions& options, const std::function<void(const std::string&)>& progress) {
  FeelReport report;
  std::vector<FeelEngineEntry> engines = feel_engines();
  if (!options.peers) engines.resize(1);
  for (const FeelSceneEntry& scene : feel_scenes()) {
    if (!wanted(options.scenes, scene.name)) continue;
    progress(scene.name);
    for (const FeelEngineEntry& entry : engines) {
      std::vector<FeelRow> tried;
      for (const FeelSetup& setup : entry.setups) tried.push_back(feel(scene, entry, setup));
      report.rows.push_back(*std::min_element(tried.begin(), tried.end(), [](const auto& a, const auto& b) {
        return a.force_error_N < b.force_error_N;
      }));
    }
  }
  if (options.hands == 0) return report;
  for (const double clearance : kClearances_m) {
    progress("peg, " + length_text(clearance));
    for (const FeelEngineEntry& entry : engines) {
      std::vector<PegRow> tried;
      for (const FeelSetup& setup : entry.setups)
        tried.push_back(insert(clearance, options.hands, entry, setup));
      report.pegs.push_back(*std::min_element(tried.begin(), tried.end(), better));
    }
  }
  return report;
}

}  // namespace tactum::bench
