#pragma once
/// The bodies that may push each other in a frame: an island is a set of bodies that move and that contacts
/// join. A body that does not move joins nothing. Islands are solved independently of each other.

#include <span>
#include <vector>

#include "tactum/dynamics/world.h"

namespace tactum::inline v0_1 {

class Islands {
 public:
  explicit Islands(const World& world) : parent_(world.bodies.size()), moves_(world.bodies.size()) {
    for (std::size_t i = 0; i < parent_.size(); ++i) set_alone(i, world.bodies[i].moves());
  }
  /// Puts every body on its own; those with an entry in `waits` that is not 0 do not move in this frame.
  void clear(const World& world, std::span<const char> waits) noexcept {
    for (std::size_t i = 0; i < parent_.size(); ++i) set_alone(i, world.bodies[i].moves() && waits[i] == 0);
  }
  void join(int a, int b) noexcept {
    if (!moves(a) || !moves(b)) return;
    const int root_a = of(a);
    const int root_b = of(b);
    // The smaller number becomes the root, so that the order of contacts does not matter.
    parent_[static_cast<std::size_t>(std::max(root_a, root_b))] = std::min(root_a, root_b);
  }
  /// The number of a body's island: its first body.
  int of(int body) const noexcept {
    while (parent_[static_cast<std::size_t>(body)] != body) body = parent_[static_cast<std::size_t>(body)];
    return body;
  }
  bool moves(int body) const noexcept { return moves_[static_cast<std::size_t>(body)] != 0; }
  /// The island that a contact of two bodies belongs to; -1 when neither moves.
  int of_contact(int a, int b) const noexcept { return moves(a) ? of(a) : moves(b) ? of(b) : -1; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.parent_, self.moves_);
  }

 private:
  void set_alone(std::size_t body, bool moves) noexcept {
    parent_[body] = static_cast<int>(body);
    moves_[body] = moves ? 1 : 0;
  }

  std::vector<int> parent_;
  std::vector<char> moves_;
};

}  // namespace tactum::inline v0_1
