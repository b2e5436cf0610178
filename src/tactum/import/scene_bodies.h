#pragma once
/// The bodies of a scene, from the links of a model. For src/tactum/import/*.cpp only.

#include <string>
#include <vector>

#include "tactum/import/import_log.h"
#include "tactum/import/import_model.h"
#include "tactum/import/model_mass.h"

namespace tactum::inline v0_1 {

/// Links that are fixed to each other and to a joint, or one link that never moves.
struct SceneBody {
  std::string name;
  int link = -1;                   ///< the one at the joint
  int parent = -1;                 ///< index of the body that the joint is to; -1: the world
  Pose X_WP;                       ///< the frame of its one shape, or that of `link` [m]
  ModelInertial inertial;          ///< in P; of a body that moves
  ModelJoint joint;                ///< in P
  std::vector<ModelShape> shapes;  ///< those that are felt; their poses are in P
  double friction = -1.0;          ///< sliding; below zero: none is stated [-]
};

/// In the order of their links; a parent stands before what hangs on it. Errors and notes go to the log.
std::vector<SceneBody> scene_bodies(const ImportModel& model, ImportLog& log);

}  // namespace tactum::inline v0_1
