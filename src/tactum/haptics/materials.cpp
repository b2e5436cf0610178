#include "tactum/haptics/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

Result<void> check_known(const World& world, const std::string& material, const char* where) {
  const bool known = std::any_of(world.bodies.begin(), world.bodies.end(),
                                 [&](const Body& body) { return body.material == material; });
  if (known && !material.empty()) return {};
  return Error{"no body is of this material", fmt::format("\"{}\"", material), "the material of a body",
               where};
}

}  // namespace

Result<void> set_coefficient(const World& world, const MaterialPair& pair, PairCoefficients& table) {
  if (Result<void> known = check_known(world, pair.material_a, "material_a"); !known) return known;
  if (Result<void> known = check_known(world, pair.material_b, "material_b"); !known) return known;
  if (!(std::isfinite(pair.coefficient) && pair.coefficient >= 0.0))
    return Error{"a coefficient is negative or not finite", fmt::format("{}", pair.coefficient), "0 or more",
                 "coefficient"};
  const std::size_t bodies = world.bodies.size();
  if (table.coefficients.size() != bodies * bodies) {
    table.bodies = static_cast<int>(bodies);
    table.coefficients.assign(bodies * bodies, 0.0);
  }
  for (std::size_t a = 0; a < bodies; ++a)
    for (std::size_t b = 0; b < bodies; ++b)
      if (world.bodies[a].material == pair.material_a && world.bodies[b].material == pair.material_b)
        table.coefficients[a * bodies + b] = table.coefficients[b * bodies + a] = pair.coefficient;
  return {};
}

}  // namespace tactum::inline v0_1
