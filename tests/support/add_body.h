#pragma once
/// A body that a test adds to its world.

#include <gtest/gtest.h>

#include "tactum/dynamics/world.h"

namespace tactum {

/// Adds a body, which must be possible, and returns its number.
inline int add_body(World& world, const BodySpec& spec) {
  const Result<int> added = world.add(spec);
  EXPECT_TRUE(added) << added.error().message();
  return added ? *added : -1;
}

}  // namespace tactum
