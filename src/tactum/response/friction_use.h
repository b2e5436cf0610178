#pragma once
/// Friction at every patch of the grasped part's island, for displays: whether the patch sticks or slips, and
/// which fraction of its friction cone is in use.
///
///        \  |  /       used:  sqrt( |F_t|^2 + (|T_n| / r)^2 )  /  (mu F_n)
///         \ | * F
///     A    \|/         0: nothing pushes along the surface; 1: at the edge of the cone, where it slips next.
///     -----(c)-----    A patch that slips uses 1; one that sticks may be there, too.
///     B
///
/// F_n counts everything that presses the two surfaces together, also what a wedged part presses by itself.

#include "tactum/dynamics/friction.h"
#include "tactum/response/frame_report.h"

namespace tactum::inline v0_1 {

struct FrictionUse {
  bool sticks = true;        ///< false: it slips
  double load_N = 0.0;       ///< F_n [N]
  double sideways_N = 0.0;   ///< F_t, along the surface [N]
  double twisting_Nm = 0.0;  ///< T_n, about the normal, without sign [N m]
  double cone_used = 0.0;    ///< [-]
};

/// By number of ContactRow::friction_patch; empty where there is no friction.
using FrictionUses = StaticVector<FrictionUse, Friction::kMostPatches>;

/// Fills `uses` from the problem's answer, and gives every row that pushes the number of the patch it belongs
/// to. `rows` are the contact rows of the problem, which begin at number `first` there.
void use_of_friction(const Friction& friction, const ContactProblem& problem, std::size_t first,
                     std::span<ContactRow> rows, FrictionUses& uses) noexcept;

/// Over all patches that push.
FrictionReport sum_of(const FrictionUses& uses) noexcept;

}  // namespace tactum::inline v0_1
