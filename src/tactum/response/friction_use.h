#pragma once
/// What friction does at every patch of a frame, told for displays: whether it sticks or slips, and how much
/// of its cone the forces use.
///
///        \  |  /       cone used:  ( |F_t| + |T_n| / r )  /  (mu F_n)
///         \ | * F
///     A    \|/         0: nothing is held sideways, 1: at the edge, where it slips next. A patch slips at 1;
///     -----(c)-----    one that sticks may be there, too.
///     B
///
/// F_n counts everything that presses the two surfaces together, also what a wedged part presses by itself.

#include "tactum/response/frame_report.h"
#include "tactum/response/friction.h"

namespace tactum {

struct FrictionUse {
  bool sticks = true;        ///< false: it slips
  double load_N = 0.0;       ///< F_n [N]
  double sideways_N = 0.0;   ///< F_t, along the surface [N]
  double twisting_Nm = 0.0;  ///< T_n, about the normal, without sign [N m]
  double cone_used = 0.0;    ///< [-]
};

/// By number of ContactRow::grip; empty where nothing rubs.
using FrictionUses = StaticVector<FrictionUse, Friction::kMostPatches>;

/// Fills `uses` from the problem's answer, and gives every row that pushes the number of the patch it counts
/// to. The rows are the contact rows of the problem, that begin at `first_row`.
void use_of_friction(const World& world, const Friction& friction, std::span<const ContactPatch> patches,
                     std::size_t first_row, const ConstraintProblem& problem, std::span<ContactRow> rows,
                     FrictionUses& uses) noexcept;

/// Over all patches that push.
FrictionReport sum_of(const FrictionUses& uses) noexcept;

}  // namespace tactum
