#include "tactum/response/friction_use.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The sum of the forces at one patch.
struct Forces {
  double load_N = 0.0;
  Vec3 sideways = Vec3::Zero();
  Vec3 twisting = Vec3::Zero();
};

FrictionUse use_of(const FrictionPatch& patch, const Forces& forces) {
  FrictionUse use;
  use.sticks = !patch.slides();
  use.load_N = forces.load_N;
  use.sideways_N = forces.sideways.norm();
  use.twisting_Nm = forces.twisting.norm();
  const double twisting_N = patch.place.radius_m > 0.0 ? use.twisting_Nm / patch.place.radius_m : 0.0;
  if (use.load_N > 0.0)
    use.cone_used = std::min(1.0, std::hypot(use.sideways_N, twisting_N) / (patch.coefficient * use.load_N));
  return use;
}

}  // namespace

void use_of_friction(const Friction& friction, const ContactProblem& problem, Index first,
                     std::span<ContactRow> rows, FrictionUses& uses) noexcept {
  uses.clear();
  if (!friction.acts()) return;
  std::array<Forces, Friction::kMostPatches> forces;
  const std::span<const FrictionPatch> patches = friction.patches();
  for (const QpActive& active : problem.answer().active) {
    const Index row = Index(active.row) - first;
    if (Index(active.row) < first || row >= rows.size() || !(active.multiplier > 0.0)) continue;
    for (Index i = 0; i < patches.size(); ++i) {
      if (!patches[i].acts || !(rows[row].friction_surfaces() == patches[i].surfaces)) continue;
      rows[row].friction_patch = static_cast<int>(i);
      forces[i].load_N += active.multiplier;
    }
  }
  friction.for_each_force(problem, [&](Index i, const Push& push, double multiplier) {
    const double load = push.force.dot(patches[i].place.n_BA_W);
    forces[i].load_N += multiplier * load;
    forces[i].sideways += multiplier * (push.force - load * patches[i].place.n_BA_W);
    forces[i].twisting += multiplier * push.torque;
  });
  for (Index i = 0; i < patches.size(); ++i) uses.push_back(use_of(patches[i], forces[i]));
}

FrictionReport sum_of(const FrictionUses& uses) noexcept {
  FrictionReport sum;
  for (const FrictionUse& use : uses) {
    if (!(use.load_N > 0.0)) continue;
    ++(use.sticks ? sum.sticking : sum.slipping);
    sum.cone_used = std::max(sum.cone_used, use.cone_used);
  }
  return sum;
}

}  // namespace tactum::inline v0_1
