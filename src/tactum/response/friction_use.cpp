#include "tactum/response/friction_use.h"

#include <algorithm>
#include <cmath>

namespace tactum {
namespace {

using Index = std::size_t;

/// What the active rows of one patch add up to.
struct Forces {
  double load_N = 0.0;
  Vec3 sideways = Vec3::Zero();
  Vec3 twisting = Vec3::Zero();
};

FrictionUse use_of(const FrictionPatch& patch, const Forces& forces) {
  FrictionUse use;
  use.sticks = !(patch.slip_m > 0.0 || patch.slip_rad > 0.0);
  use.load_N = forces.load_N;
  use.sideways_N = forces.sideways.norm();
  use.twisting_Nm = forces.twisting.norm();
  const double twisting_N = patch.radius_m > 0.0 ? use.twisting_Nm / patch.radius_m : 0.0;
  if (use.load_N > 0.0)
    use.cone_used = std::min(1.0, (use.sideways_N + twisting_N) / (patch.coefficient * use.load_N));
  return use;
}

}  // namespace

void use_of_friction(const World& world, const Friction& friction, std::span<const ContactPatch> patches,
                     Index first_row, const ConstraintProblem& problem, std::span<ContactRow> rows,
                     FrictionUses& uses) noexcept {
  uses.clear();
  if (!friction.acts()) return;
  std::array<Forces, Friction::kMostPatches> forces;
  const std::span<const FrictionPatch> rubbing = friction.patches();
  for (const QpActive& active : problem.answer().active) {
    const Index row = Index(active.row);
    if (row < first_row || !(active.multiplier > 0.0)) continue;
    const bool of_contact = row - first_row < rows.size();
    const PatchKey key = of_contact ? key_of(world, patches[Index(rows[row - first_row].patch)]) : PatchKey{};
    for (Index i = 0; i < rubbing.size(); ++i) {
      const FrictionPatch& patch = rubbing[i];
      if (!patch.acts) continue;
      if (of_contact) {
        if (!(key == patch.key)) continue;
        rows[row - first_row].grip = static_cast<int>(i);
        forces[i].load_N += active.multiplier;
      } else if (row >= patch.first_row && row < patch.first_row + Friction::kRowsAPatch) {
        const Push push = cone_edge(patch, row - patch.first_row);
        forces[i].load_N += active.multiplier;
        forces[i].sideways += active.multiplier * (push.force - patch.n_BA_W);
        forces[i].twisting += active.multiplier * push.torque;
      }
    }
  }
  for (Index i = 0; i < rubbing.size(); ++i) uses.push_back(use_of(rubbing[i], forces[i]));
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

}  // namespace tactum
