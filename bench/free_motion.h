#pragma once
/// Convex bodies that fall, hit, slide and turn on hinges by themselves, moved by our responses or by another
/// engine: a reference for our own motion in tests, and the table of bench/mechanics.h.

#include <memory>
#include <vector>

#include "bench/shapes.h"
#include "tactum/dynamics/world.h"

namespace tactum::bench {

struct FreeMotion {
  World world;                ///< of convex parts of one piece, free, fixed or hinged
  std::vector<Shape> shapes;  ///< of its bodies, in their order
  double friction = 0.0;      ///< between all [-]
  double restitution = 0.0;   ///< ... fraction of the speed that is left [-]
  /// Of each body, where other engines have a true ball for it, else 0; empty: of none [m].
  std::vector<double> ball_radius_m = {};

  double ball_of(std::size_t body) const { return ball_radius_m.empty() ? 0.0 : ball_radius_m[body]; }
};

/// Moves the bodies of a FreeMotion in steps of one length. Frames, units and signs are those of WorldState.
class MotionEngine {
 public:
  virtual ~MotionEngine() = default;
  MotionEngine() = default;
  MotionEngine(const MotionEngine&) = delete;
  MotionEngine& operator=(const MotionEngine&) = delete;

  virtual void step() = 0;
  /// Poses of all bodies; velocities of free ones, zero for others [m, m/s, rad/s].
  virtual WorldState state() const = 0;
  /// The sum of the contact forces on a fixed body in the last step, without its sign [N].
  virtual double load_N(int fixed_body) const = 0;
};

using MakeMotion = std::unique_ptr<MotionEngine> (*)(const FreeMotion& motion, double step_s);

std::unique_ptr<MotionEngine> make_constraint_motion(const FreeMotion& motion, double step_s);
std::unique_ptr<MotionEngine> make_penalty_motion(const FreeMotion& motion, double step_s);

/// The other engines; null where they were not there when the program was built.
struct MotionPeers {
  MakeMotion bullet = nullptr, ode = nullptr, mujoco = nullptr;
};
MotionPeers motion_peers() noexcept;

/// Whether the engine was there when the program was built.
bool has_ode() noexcept;

/// The poses of the world's bodies after `seconds`, in so many steps. Only where has_ode().
WorldState moved_by_ode(const FreeMotion& motion, double seconds, int steps);

}  // namespace tactum::bench
