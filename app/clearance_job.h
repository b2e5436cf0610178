#pragma once
/// The input of `tactum clearance` and `tactum-bench clearance`: two surfaces and a motion of both.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tactum/devices/motion_file.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum {

struct ClearanceFiles {
  std::string mesh_a, mesh_b, motion;
  double scale = 1.0;  ///< metres per unit of the files [m]
};

struct ClearanceJob {
  TriangleMesh a, b;
  TwoBodyMotion motion;    ///< at least one row
  std::vector<Pose> X_AB;  ///< of every row [m]
};

/// Adds the files and the scale to the command's line.
void add_clearance_files(CLI::App& command, ClearanceFiles& files);

/// Reads them, reporting repairs on stderr. Ends the command when they cannot be read.
ClearanceJob read_clearance_job(const ClearanceFiles& files);

}  // namespace tactum
