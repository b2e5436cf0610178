#pragma once
/// A box as a part, for tests of bodies.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tactum/geometry/part.h"
#include "tactum/mesh/make_part.h"

namespace tactum {

inline std::shared_ptr<const Part> solid_box(const Vec3& half) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                         i & 4 ? half.z() : -half.z());
  Result<Part> part = part_from_clouds({corners});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

}  // namespace tactum
