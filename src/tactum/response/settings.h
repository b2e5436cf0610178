#pragma once
/// Everything about the response that can be set, each with its unit, its default and, where there is one,
/// the paper's value. Constant during a frame; settings that setting_table.h calls live may change between
/// two frames. [Gregory 2000]: "Six Degree-of-Freedom Haptic Display of Polygonal Models".

#include <algorithm>
#include <vector>

#include "tactum/contact/contact_work.h"
#include "tactum/loop/passivity.h"
#include "tactum/loop/safety.h"
#include "tactum/loop/smoothing.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// How the device's handle H maps into the world (hand.h).
struct Workspace {
  Pose X_WD;               ///< device frame in the world [m]
  double scale = 1.0;      ///< world metres per device metre, see workspace_scale.h [-]
  int clutch_button = -1;  ///< bit of DeviceSample::buttons that disengages the handle; -1: none
};

/// The virtual coupling: the spring and damper between the probe and the proxy of the grasped part, as the
/// device meets them; in_scene() gives those of the scene.
struct Coupling {
  double stiffness_N_per_m = 600.0;     ///< k_t [N/m]
  double stiffness_Nm_per_rad = 0.3;    ///< k_r [N m/rad]
  double damping_Ns_per_m = 1.0;        ///< b_t [N s/m]
  double damping_Nms_per_rad = 0.0005;  ///< b_r [N m s/rad]
};

/// Which depth of an overlap loads the springs of the penalty response.
enum class OverlapDepth {
  kShortest,    ///< of the shortest translation that separates the two pieces
  kAlongMotion  ///< back along the relative motion, as published, 4.1; the force keeps the contact normal
};

/// The penalty response as published. Stiffness and lengths are stated at the device (workspace_scale.h).
struct Penalty {
  double stiffness_N_per_m = 600.0;  ///< k_s, 0.6 N/mm in the paper, 5.1 [N/m]
  double max_step_m = 0.5e-3;        ///< the "safe threshold distance" of the proxy's travel in 1 ms, 3.2 [m]
  double min_tolerance_m = 2e-5;     ///< smallest delta, so that a resting part keeps its contacts [m]
  OverlapDepth depth = OverlapDepth::kShortest;
};

/// Which of the two responses moves the grasped part.
enum class ResponseModel {
  kPenalty,    ///< as published: contacts are springs, which penetration loads
  kConstraint  ///< no part penetrates another
};

/// The constraint response. The hand feels its coupling's stiffness and nothing else. Lengths are stated at
/// the device, for a part of a hand's size; step_limits() gives those of the scene and the part.
struct Constraint {
  /// Farthest that a point of the grasped part goes in 1 ms; the opening of gaps below the skin comes before
  /// it [m].
  double max_step_m = 1e-3;
  /// The least that the limit sinks to, from which it doubles; kLeastOnSurfaces of it while surfaces without
  /// pieces touch: the number of contacts within a step, and the time to find them, grow with the step [m].
  double least_step_m = 5e-5;
  static constexpr double kLeastOnSurfaces = 0.6;
  double max_turn_rad = 0.020;  ///< farthest that the grasped part turns in 1 ms [rad]
};

/// A coefficient for every pair of bodies (scene files give it for pairs of materials).
struct PairCoefficients {
  std::vector<double> coefficients;  ///< bodies x bodies, row after row; empty: none [-]
  int bodies = 0;

  double between(int a, int b) const noexcept {
    return coefficients.empty() ? 0.0 : coefficients[static_cast<std::size_t>(a * bodies + b)];
  }
};

/// Impacts: bodies that hit each other in the constraint response, and how the hand feels those that hit the
/// grasped part. "We are considering the possibility of force expansion over time or force amplification",
/// 6.2.
struct Impacts {
  PairCoefficients restitution;  ///< fraction of the speed of approach that is left [-]
  /// An impact is felt as a pulse of the same momentum, this long, but at most 1024 frames [s].
  double expansion_s = 0.02;
  double amplification = 1.0;  ///< the momentum of that pulse is multiplied by it [-]
};

/// Which part is grasped, and where.
struct Tool {
  int body = -1;                  ///< index into World::bodies; -1: nothing grasped, the hand feels nothing
  Pose X_BH;                      ///< the handle in the grasped body's frame while grasped [m]
  bool picks = false;             ///< the primary button grasps and releases (picking.h)
  double pick_distance_m = 0.01;  ///< how far from the handle [m]
  /// A hinged body that is taken nearer to its axis than this fraction of its radius about the axis is held
  /// at its centre, else as by a rod (Hold) [-].
  double centre_fraction = 0.25;
};

/// Force shading by interpolated normals, 5.3 [Ruspini 1997].
struct Shading {
  bool on = true;
  double crease_rad = 0.6;  ///< facets that meet at less than this are parts of one curved surface [rad]
};

/// The budget of a frame; part of the recorded input, never a clock reading.
struct WorkBudget {
  int max_exact_tests = 4096;  ///< exact tests a frame (paper 4.2: the array of fixed length) [-]
  /// Tests of nodes and leaves a frame in the proof that surfaces do not cross on their paths, some 0.2 us
  /// each. Where that is not enough, steps are short, and are tested at their ends only [-].
  int max_path_tests = 2048;
  int max_contact_points = 2048;   ///< contact points a frame [-]
  ContactFinderCapacity capacity;  ///< near pairs and patches there is memory for
  /// Sweeps of the contact solver, or rows added and dropped, at most in each solution; a frame has several
  /// [-].
  int solver_iterations = 120;
  bool sleep = true;  ///< bodies at rest are not tested, where nothing could show (sleep.h)
};

/// What each hand has of its own: the place of its device, its grasp, and the chain from the coupling to the
/// device.
struct HandSettings {
  Workspace workspace;
  Tool tool;
  Coupling coupling;
  SmoothingSettings smoothing;
  PortSettings port;
  SafetyLimits safety;
};

/// All of it; the inherited members are those of the first hand.
struct FrameSettings : HandSettings {
  double dt_s = 0.001;                    ///< time from frame to frame [s]
  std::vector<HandSettings> other_hands;  ///< of the second hand and all after it; constant in a simulation
  ResponseModel response = ResponseModel::kConstraint;
  Penalty penalty;
  Constraint constraint;
  PairCoefficients friction;  ///< Coulomb's, in the constraint response
  Impacts impacts;
  Shading shading;
  WorkBudget budget;

  std::size_t hands() const noexcept { return 1 + other_hands.size(); }
  /// The settings of a hand, counted from 0.
  const HandSettings& hand(std::size_t number) const noexcept {
    return number == 0 ? *this : other_hands[number - 1];
  }
  /// The smallest workspace scale of all hands: lengths of the scene that belong to no hand go by it [-].
  double smallest_scale() const noexcept {
    double smallest = workspace.scale;
    for (const HandSettings& other : other_hands) smallest = std::min(smallest, other.workspace.scale);
    return smallest;
  }
};

}  // namespace tactum::inline v0_1
