#pragma once
/// A SteppedScene as Python has it, and what a step gives.

#include <memory>
#include <string>

#include "conversions.h"
#include "tactum/embedding/stepped_scene.h"

namespace tactum::python {

/// One contact of the structured array; the names are those of tactum.Contacts in the stubs.
struct ContactRecord {
  std::int32_t body_a, body_b, piece_a, piece_b;
  std::int32_t kind_a, feature_a, kind_b, feature_b;
  double point[3], normal[3];
  double distance_m, normal_force_N, friction_N, friction_coefficient, cone_used;
  std::int32_t grip, patch;
  double residual_m;
};

}  // namespace tactum::python
