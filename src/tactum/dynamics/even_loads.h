#pragma once
/// The most even of all loads: of the normal forces of touching corners that have the same effect on the
/// bodies, those with the least sum of squares.
///
///      |   ____   |        The exact solver ends with as few corners as carry the bodies. Where more touch,
///    ->|o |    | o|<-      which of them it chose says nothing: jaws that press a box at one corner (o)
///      |  |____|  |        each, opposite to each other, hold it as well as jaws that press it all over.
///      |o        o|        Friction at those two corners would let the box turn about them.

#include <array>

#include "tactum/base/static_vector.h"
#include "tactum/dynamics/contact_problem.h"

namespace tactum::inline v0_1 {

struct EvenLoads {
  static constexpr std::size_t kMost = 64;
  StaticVector<int, kMost> rows;        ///< of the contacts, by their index: those that touch after the step
  std::array<double, kMost> force_N{};  ///< of each, zero or more [N]
};

/// A change of a problem's unknowns, as push() adds to it.
using UnknownChange = std::array<double, kMostUnknowns>;

/// Finds the most even loads that have the effect of the contacts' normal forces in the last answer of the
/// exact solver together with the forces `beside`, which are given by their change of the unknowns. Where
/// more corners touch than there is room for, or no such loads are found, the loads are those of the answer,
/// and the result is false. Cost: that of a linear system in the unknowns, as a rule once or twice.
bool find_even_loads(const RowsInProblem& contacts, const ContactProblem& problem,
                     const UnknownChange& beside, EvenLoads& loads) noexcept;

}  // namespace tactum::inline v0_1
