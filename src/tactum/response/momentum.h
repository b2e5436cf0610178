#pragma once
/// The balance of momentum of the bodies that move freely in the constraint response: in every frame it must
/// change by the impulses of weight, constant forces, impacts and contacts, and by nothing else.
///
///     after - before = (m g + F) h + sum of impulses from bodies that do not count
///
/// Those that count are free, and neither joined to another body, nor grasped, damped or asleep.
/// Impulses between the free bodies cancel, so only those from outside are summed, and an error anywhere
/// shows. A body whose step was cut short has not gone where the forces would have had it, and forces along
/// normals that shading bends are not those that kept its gaps open; such frames are marked, and their
/// balance says nothing. Cost: some additions for each body and contact.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Call it when it is known which bodies move, and the first half of weight and load is added
/// (free_bodies.h).
void begin_balance(ConstraintStep& step) noexcept;

/// Call it when all have moved. `as_forced`: the grasped part's island went where its contact forces would
/// have it.
void end_balance(bool as_forced, ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
