#pragma once
/// Vector fields on grids in files: a header in TOML and the numbers as they are, in a file beside it.
///
///     schema = 1
///     data = "flow.raw"               three numbers a node, x fastest, then y, then z
///     nodes = [256, 256, 256]
///     spacing_m = [0.001, 0.001, 0.001]
///     origin_m = [-0.1, -0.1, 0]      of the first node, in the field's frame; by default the origin
///     type = "float32"                or "float64"
///     byte_order = "little"           or "big"; by default little
///     components = 3
///     unit_N = 0.01                   the force of a 1 in the file; by default 1
///
/// Read strictly: the data file must have exactly the size that follows from the header, and nothing is
/// allocated before that is known.

#include <string>

#include "tactum/base/result.h"
#include "tactum/dynamics/field_grid.h"

namespace tactum::inline v0_1 {

/// `edge_m` as in FieldGrid::make.
Result<FieldGrid> read_field_file(const std::string& header_path, double edge_m = 0.0);

/// Writes the header, and the numbers beside it with the ending .raw: little-endian, in their precision, in
/// newtons.
Result<void> write_field_file(const std::string& header_path, const GridShape& shape,
                              const FieldGrid::Samples& samples);

}  // namespace tactum::inline v0_1
