#pragma once
/// The methods to make the pieces of a part from a repaired mesh, as `tactum prepare --pieces` offers them.

#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/geometry/part.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/mesh_import.h"

namespace tactum::inline v0_1 {

/// The input of a method.
struct PiecesInput {
  const ImportedMesh& given;     ///< as in the file, in metres, with its groups
  const RepairedMesh& repaired;  ///< in metres
  const MeshReport& report;      ///< of the repaired mesh
  const PartOptions& options;
};

struct PieceMethod {
  const char* name;
  /// Why "auto" may take it; empty when it is not for this mesh.
  std::string (*suits)(const PiecesInput& input);
  /// Where the part's frame should stand: its centre of mass [m].
  Result<Vec3> (*center)(const PiecesInput& input);
  /// The volume that its solid pieces must have together [m^3]; negative: none is known.
  double (*volume)(const PiecesInput& input);
  /// The part with its frame at `origin`.
  Result<Part> (*make)(const PiecesInput& input, const Vec3& origin);
};

/// In the order they are tried.
const std::vector<PieceMethod>& all_piece_methods();

}  // namespace tactum::inline v0_1
