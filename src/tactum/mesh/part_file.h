#pragma once
/// Parts on disk, as `tactum prepare` writes and scenes load them.
///
/// One file, versioned and checksummed (array_file.h), mapped into memory to be read. It holds the part about
/// its centre of mass, as bodies need it, and the place of that in the mesh, so loading computes nothing anew
/// but what follows exactly from the arrays: the pieces' planes and the tree over them.
///
/// Loading survives any bytes: sizes, indices and numbers are checked; an error states the fault.

#include <string>
#include <string_view>

#include "tactum/base/result.h"
#include "tactum/geometry/part.h"

namespace tactum::inline v0_1 {

/// Raised whenever the arrays of a part change.
inline constexpr std::uint32_t kPartFileVersion = 4;

struct PartFile {
  Part part;                          ///< relative to its centre of mass
  Vec3 origin = Vec3::Zero();         ///< that centre, in the frame of the mesh [m]
  double density_kg_per_m3 = 1000.0;  ///< that mass and inertia are for
  std::string report;                 ///< findings and changes, as JSON (prepare_part.h)
};

/// Whether the bytes begin as a part file does.
bool looks_like_part(std::string_view bytes);

std::string part_bytes(const PartFile& file);
Result<PartFile> read_part(std::string_view bytes, const std::string& name);

/// The same to and from disk. Written whole or not at all.
Result<void> save_part(const std::string& path, const PartFile& file);
Result<PartFile> load_part(const std::string& path);

/// Whether the file begins as a part file does; false when it cannot be read.
bool is_part_file(const std::string& path);

/// The part's mass and inertia for another density.
void set_density(PartFile& file, double density_kg_per_m3);

/// The surface of the part in the frame of the mesh it was made from, to rounding.
TriangleMesh surface_in_mesh_frame(const PartFile& file);

}  // namespace tactum::inline v0_1
