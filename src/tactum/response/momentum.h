#pragma once
/// The balance of momentum of the bodies that move freely in the constraint response: in every frame it must
/// change by what gravity, blows and contacts gave them, and by nothing else.
///
///     after - before = m g h + sum of impulses between them and what is held, jointed, asleep or fixed
///
/// What they give each other cancels, so the books are kept from outside: an error anywhere shows. A body
/// whose step was cut short has not gone where the forces would have had it, and forces along normals that
/// shading bends are not those that held it off; such frames are marked, and their balance says nothing.
/// Cost: some additions a body and a contact.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Once it is known who moves, and gravity has had half its say (free_bodies.h).
void begin_balance(ConstraintStep& step) noexcept;

/// When all have moved. `as_forced`: the held part's island has gone where its contact forces would have it.
void end_balance(bool as_forced, ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
