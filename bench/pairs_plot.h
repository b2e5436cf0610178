#pragma once
/// The picture of `tactum-bench pairs`: cost against the number of vertices, both logarithmic, in the regime
/// "near", a box and then spheres; the median as a line, the 99.9th percentile dashed, ours and the peers'.
/// Hollow dots are measurements in which a query was missed or wrong by more than a micrometre.

#include <string>
#include <vector>

#include "bench/measure.h"

namespace tactum::bench {

/// An SVG file's text.
std::string pairs_plot(const std::vector<Row>& rows);

/// False when the file cannot be written.
bool write_text(const std::string& path, const std::string& text);

}  // namespace tactum::bench
