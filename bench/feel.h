#pragma once
/// The wrench that the hand feels, against the correct one: a grasped part is led along a motion on an ideal
/// device, and the wrench at the handle is compared with statics worked out by hand. The same motion goes to
/// rigid-body engines that hold the part by a spring and damper, as haptic programs built on them do.
///
///   hand X_WH(t) --> engine, one step of 1 ms --> wrench on the hand  -- against truth(X_WH), in the judged
///                                             --> pose of the part    -- overlap by separating axes time
///
/// The hand is led, not simulated, so that every engine gets the same motion. Ours is judged with its skin
/// (the gap at which contacts are held) taken as the surface; raw wrenches, before smoothing and safety.

#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/report.h"
#include "bench/shapes.h"
#include "tactum/devices/hand_motion.h"
#include "tactum/response/settings.h"

namespace tactum::bench {

/// A convex piece and its pose in its body's frame.
struct FeelPiece {
  Shape shape;
  Pose X_BP;
};

/// The grasped part's origin is the handle; the other part stands still, its frame is the world's.
struct FeelScene {
  std::vector<FeelPiece> grasped, fixed;
  std::shared_ptr<const HandMotion> hand;  ///< X_WH over time; the part starts at its beginning
  Coupling coupling;
  double friction = 0.0;  ///< mu [-]
  double judged_from_s = 0.0, judged_to_s = 0.0;
  bool begins_to_slide = false;  ///< after the judged time, in which it should not creep
  /// The wrench that should be felt, with contacts held `skin_m` apart; none: only the rest is measured.
  std::function<Wrench(const Pose& X_WH, double skin_m)> truth;
  /// How deep the part is in the other at X_WB; none: by separating axes of all pairs of pieces [m].
  std::function<double(const Pose& X_WB)> depth;
};

/// One of the engines, with the scene's part grasped. `step` is one millisecond, after which the rest is
/// read.
class FeelEngine {
 public:
  virtual ~FeelEngine() = default;
  FeelEngine() = default;
  FeelEngine(const FeelEngine&) = delete;
  FeelEngine& operator=(const FeelEngine&) = delete;
  virtual void step(const Pose& X_WH) = 0;
  virtual Pose X_WB() const = 0;
  virtual Wrench felt() const = 0;  ///< on the hand, at the handle, world axes [N, N m]
  virtual double skin_m() const { return 0.0; }
};

/// The set-ups tried of a rigid-body engine: the best of all is shown.
struct FeelSetup {
  int substeps = 1;  ///< of a millisecond
  double erp = 0.2;  ///< fraction of an overlap that is corrected in a step
};

struct FeelEngineEntry {
  std::string name;
  std::unique_ptr<FeelEngine> (*make)(const FeelScene&, const FeelSetup&);
  std::vector<FeelSetup> setups;
};

/// Ours first, then the peers that were there when the program was built.
std::vector<FeelEngineEntry> feel_engines();

/// Handle and part together, for engines that need a mass: a light device's.
inline constexpr double kFeelStep_s = 1e-3;  ///< between two poses of the hand [s]
inline constexpr double kFeltMass_kg = 0.05;
inline constexpr double kFeltInertia_kg_m2 = 2e-5;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// One scene with one engine. Largest values over the judged time, but for the overlap: over all of it.
struct FeelRow {
  std::string scene, engine;
  FeelSetup setup;
  double force_error_N = 0.0;        ///< |F - truth| [N]
  double direction_error_rad = 0.0;  ///< between F and the truth [rad]
  double torque_error_Nm = 0.0;      ///< [N m]
  double force_step_N = 0.0;         ///< from frame to frame [N]
  double penetration_m = 0.0;        ///< [m]
  double energy_made_J = 0.0;  ///< given to the hand over the whole, closed motion; 0 when it was taken [J]
  double friction_error = kNotMeasured;  ///< of the coefficient at which it begins to slide, relative [-]
  double creep_m_per_s = kNotMeasured;   ///< below it [m/s]
  double frame_us = 0.0;                 ///< mean time of a step [us]
};

/// A peg led into its hole by clumsy hands.
struct PegRow {
  std::string engine;
  FeelSetup setup;
  double clearance_m = 0.0;
  int hands = 0, inserted = 0;  ///< to the floor, and out again
  double penetration_m = 0.0;   ///< worst of all frames [m]
  double force_step_N = 0.0;    ///< largest from frame to frame [N]
  double frame_us = 0.0;        ///< mean time of a step [us]
};

struct FeelOptions {
  std::vector<std::string> scenes;  ///< by name; empty: all
  int hands = 3;                    ///< for each peg; 0: no pegs
  bool peers = true;
};

struct FeelReport {
  std::vector<FeelRow> rows;
  std::vector<PegRow> pegs;
};

/// The scenes with an analytic answer.
struct FeelSceneEntry {
  std::string name;
  FeelScene (*make)();
};
const std::vector<FeelSceneEntry>& feel_scenes();
inline constexpr double kClearances_m[] = {1e-3, 1e-4, 2e-5, 7e-6};
/// A 25 x 25 x 60 mm peg over its hole, 30 mm deep, and hand number `hand`, off by up to 3 mm and 3 degrees.
FeelScene peg_scene(double clearance_m, int hand);

FeelRow feel(const FeelSceneEntry& what, const FeelEngineEntry& entry, const FeelSetup& setup);
FeelReport bench_feel(const FeelOptions& options, const std::function<void(const std::string&)>& progress);

nlohmann::ordered_json to_json(const FeelRow& row);
nlohmann::ordered_json to_json(const PegRow& row);
Table table_of(const std::vector<FeelRow>& rows);
Table table_of(const std::vector<PegRow>& rows);
/// Overlap and force step over the clearance.
std::string peg_plot(const std::vector<PegRow>& rows);

}  // namespace tactum::bench
