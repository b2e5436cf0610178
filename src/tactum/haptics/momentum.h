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

#include <vector>

#include "tactum/dynamics/world.h"
#include "tactum/haptics/frame_report.h"

namespace tactum {

struct ConstraintStep;

/// Scratch of one frame, allocated at load time.
struct Momentum {
  explicit Momentum(const World& world) : counts(world.bodies.size(), 0) {}

  /// `impulse` acts on body_a, its opposite on body_b [N s].
  void give(int body_a, int body_b, const Vec3& impulse) noexcept {
    const bool a = counts[static_cast<std::size_t>(body_a)] != 0;
    const bool b = counts[static_cast<std::size_t>(body_b)] != 0;
    if (a == b) return;
    due_Ns += a ? impulse : Vec3(-impulse);
  }

  std::vector<char> counts;    ///< bodies that are free, awake and not held
  Vec3 due_Ns = Vec3::Zero();  ///< what they should have at the end of the frame
};

/// Once it is known who moves, and gravity has had half its say (free_bodies.h).
void begin_balance(ConstraintStep& step) noexcept;

/// When all have moved. `as_forced`: the held part's island has gone where its contact forces would have it.
void end_balance(bool as_forced, ConstraintStep& step) noexcept;

}  // namespace tactum
