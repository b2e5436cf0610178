#pragma once
/// Vectors of VTK image data (.vti, or .vtk with structured points) as a field on a grid. VTK knows no units:
/// what a 1 means in lengths and in values is the caller's to tell.

#include <string>

#include "tactum/base/result.h"
#include "tactum/dynamics/field_grid.h"

namespace tactum {

struct VtkOptions {
  std::string array;              ///< of the point data; empty: the only one of three components
  double metres_per_unit = 1.0;   ///< of spacing and origin [m]
  double newtons_per_unit = 1.0;  ///< of the vectors [N]
};

struct VtkField {
  std::string array;  ///< that was read
  FieldGrid grid;
};

/// Errors: not a VTK image, nothing or too much in it, no vectors at its points, not the axes' directions,
/// and what FieldGrid refuses. Single precision stays single, all else becomes double.
Result<VtkField> read_vtk_image(const std::string& path, const VtkOptions& options = {});

}  // namespace tactum
