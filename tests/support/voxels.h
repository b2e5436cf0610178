#pragma once
/// Solids of unit cells, whose volume, area and centre are known by counting.

#include <algorithm>
#include <array>
#include <cstddef>

#include "tactum/base/random.h"

namespace tactum::testing {

inline constexpr int kCells = 3;  ///< along each side

/// Which cells of a cube of unit cells are solid.
struct Voxels {
  std::array<bool, kCells * kCells * kCells> solid{};

  bool at(int x, int y, int z) const {
    const auto inside = [](int i) { return i >= 0 && i < kCells; };
    return inside(x) && inside(y) && inside(z) && solid[std::size_t((x * kCells + y) * kCells + z)];
  }
  template <class Visitor>
  void for_each(Visitor&& visit) const {
    for (int x = 0; x < kCells; ++x)
      for (int y = 0; y < kCells; ++y)
        for (int z = 0; z < kCells; ++z)
          if (at(x, y, z)) visit(x, y, z);
  }
  int count() const { return static_cast<int>(std::count(solid.begin(), solid.end(), true)); }
  int exposed_faces() const {
    int faces = 0;
    for_each([&](int x, int y, int z) {
      for (const int step : {-1, 1}) faces += !at(x + step, y, z) + !at(x, y + step, z) + !at(x, y, z + step);
    });
    return faces;
  }
};

inline Voxels random_voxels(Random& random) {
  Voxels voxels;
  for (bool& solid : voxels.solid) solid = random.unit() < 0.55;
  voxels.solid[0] = true;
  return voxels;
}

}  // namespace tactum::testing
