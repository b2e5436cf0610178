#pragma once
/// Everything about the response that can be set, each with its unit, its default and, where there is one,
/// the paper's value. Constant while frames run. [Gregory 2000]: "Six Degree-of-Freedom Haptic Display of
/// Polygonal Models".

#include "tactum/collision/contact_finder.h"
#include "tactum/haptics/safety.h"
#include "tactum/haptics/smoothing.h"
#include "tactum/math/spatial.h"

namespace tactum {

/// How the device's handle H maps into the world.
struct Workspace {
  Pose X_WD;               ///< device frame in the world [m]
  double scale = 1.0;      ///< world metres per device metre; rotation is never scaled [-]
  int clutch_button = -1;  ///< bit of DeviceSample::buttons that lets the handle slip; -1: none
};

/// The virtual coupling: the spring and damper between the hand's pose and the held part's proxy.
struct Coupling {
  double stiffness_N_per_m = 600.0;     ///< k_t [N/m]
  double stiffness_Nm_per_rad = 0.3;    ///< k_r [N m/rad]
  double damping_Ns_per_m = 1.0;        ///< b_t [N s/m]
  double damping_Nms_per_rad = 0.0005;  ///< b_r [N m s/rad]
};

/// The penalty response as published.
struct Penalty {
  double stiffness_N_per_m = 600.0;  ///< k_s, 0.6 N/mm in the paper, 5.1 [N/m]
  double max_step_m = 0.5e-3;     ///< the "safe threshold distance" the proxy may travel in a frame, 3.2 [m]
  double min_tolerance_m = 2e-5;  ///< smallest delta, so that a resting part keeps its contacts [m]
};

/// Which part is held, and where.
struct Tool {
  int body = -1;  ///< index into World::bodies; -1: nothing is held, the hand feels nothing
  Pose X_BH;      ///< the handle in the held body's frame while grasped [m]
};

/// Force shading by interpolated normals, 5.3 [Ruspini 1997].
struct Shading {
  bool on = true;
  double crease_rad = 0.6;  ///< facets that meet at less than this are parts of one curved surface [rad]
};

/// What the frame may spend; part of the recorded input, never a clock reading.
struct WorkBudget {
  int max_exact_tests = 4096;    ///< exact tests a frame (paper 4.2: the array of fixed length) [-]
  int max_contact_points = 512;  ///< contact points a frame [-]
  ContactFinderRooms rooms;      ///< near pairs and patches there is memory for
  int solver_iterations = 60;    ///< sweeps of the contact solver over many rows, at most [-]
};

/// All of it.
struct FrameSettings {
  double dt_s = 0.001;  ///< time from frame to frame [s]
  Workspace workspace;
  Tool tool;
  Coupling coupling;
  Penalty penalty;
  Shading shading;
  SmoothingSettings smoothing;
  SafetyLimits safety;
  WorkBudget budget;
};

}  // namespace tactum
