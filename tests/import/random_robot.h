#pragma once
/// Random robots as texts of URDF and MJCF, with every spelling of poses, units, classes and inertias that
/// both programs read.

#include <cstdint>
#include <string>

namespace tactum::import_test {

/// Odd seeds have no products of inertia, no bodies of several shapes in MJCF, and links that MuJoCo does
/// not fuse.
std::string random_mjcf(std::uint64_t seed);
std::string random_urdf(std::uint64_t seed);

}  // namespace tactum::import_test
