#pragma once
/// What MuJoCo reads in a URDF or MJCF file, stated as scenes state it: bodies that are welded together as
/// one, about their common centre of mass.

#include <string>
#include <vector>

#include "tactum/dynamics/world.h"

namespace tactum::import_test {

struct ReadBody {
  std::string name;  ///< empty: the file gives none
  double mass_kg = 0.0;
  Vec3 center_W = Vec3::Zero();
  Mat3 inertia_W = Mat3::Zero();  ///< about the centre of mass
  bool alone = true;              ///< nothing is welded to it
  Joint joint;                    ///< kFree where the body is free
};

struct ReadGeom {
  bool mesh = false;  ///< MuJoCo states its pose in a frame of its own
  Pose X_WG;
};

struct Reading {
  std::string error;             ///< MuJoCo's own words; empty: it has read the file
  std::vector<ReadBody> bodies;  ///< that move
  std::vector<ReadGeom> geoms;   ///< that can touch
  Vec3 gravity_W = Vec3::Zero();
};

/// Joints whose limits leave out the pose of the file stand at the nearest limit.
Reading read_by_mujoco(const std::string& path);

}  // namespace tactum::import_test
