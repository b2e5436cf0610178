#pragma once
/// A STEP file as triangles. STEP describes exact surfaces (planes, cylinders, splines); what is felt are
/// triangles whose corners lie on them, so how far the triangles may be off is the caller's choice, and what
/// they are off is measured.

#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum {

struct StepOptions {
  /// The triangles' distance from the exact surface asked for [m]; 0: a ten-thousandth of the file's
  /// diagonal.
  double deviation_m = 0.0;
  /// Between the normals of two neighbouring facets of a curve, at most [rad].
  double angle_rad = 0.2;
};

/// A solid, or a shell that encloses none.
struct StepBody {
  int first_triangle = 0, triangles = 0;
  int faces = 0;       ///< of the STEP file
  bool solid = false;  ///< else an open shell
};

struct StepMesh {
  TriangleMesh mesh;  ///< [m], outward; corners on common edges are one vertex
  std::vector<StepBody> bodies;
  double asked_deviation_m = 0.0;
  /// The largest distance from the exact surface at the middles of triangles and of their sides [m].
  double deviation_m = 0.0;
};

/// Reads and triangulates with OpenCASCADE. Errors: not a STEP file, nothing with faces in it, a face that
/// cannot be triangulated. Units are those the file declares.
Result<StepMesh> read_step(const std::string& path, const StepOptions& options);

/// Writes an OBJ in metres, an object (`o body_1`) for each body.
Result<void> write_obj(const std::string& path, const StepMesh& step);

}  // namespace tactum
