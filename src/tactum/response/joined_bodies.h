#pragma once
/// Bodies that joints join to each other (dynamics/pair_joint.h): they are in one island, take the same
/// fraction of its step, sleep and wait together, and end each step where their joints allow them.

#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Makes the velocities of a world that starts, half a frame back, those that the joints allow; nearest in
/// kinetic energy. Chains of more than kMostUnknowns unknowns are left to the first frame.
void begin_joined(const World& world, double dt_s, WorldState& state);

/// What the impulses of the frame add to the mean rate of a body that turns freely by changing the axis about
/// which it turns, beside what they add to its rate at the start [rad/s].
Vec3 change_of_axis(const ConstraintStep& step, std::size_t body) noexcept;

/// The rounds in which a problem is solved again with the errors that its answer leaves in the joints.
class JointErrors {
 public:
  /// Whether another round may be made.
  bool go_on() noexcept { return rounds_++ < kMostRounds; }
  /// Whether the largest error is so small, or so little smaller than in the last round, that none is needed.
  bool closed(double largest) noexcept {
    const bool enough = !(largest > tolerances::kJointClosed) || !(largest < 0.5 * last_);
    last_ = largest;
    return enough;
  }

 private:
  static constexpr int kMostRounds = 8;

  int rounds_ = 0;
  double last_ = std::numeric_limits<double>::infinity();
};

/// Moves the bodies on trial onto their joints, by what is left of the errors after the last solution.
void join_trial(ConstraintStep& step) noexcept;

/// Cuts the steps of joined bodies to the smallest fraction among them.
void cut_together(ConstraintStep& step) noexcept;

/// Lets joined bodies be moved by each other and by the springs of their joints: each may go as far as twice
/// the farthest of its tree.
void bound_joined(const MotionInput& input, const WorldState& bodies,
                  std::vector<double>& motion_bound) noexcept;

/// Lets all bodies of a tree wait where one does, or none where the grasped part is one of them.
void wait_together(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
