#pragma once
/// The contact queries that are compared, ours and the peers', behind one small interface. An engine holds
/// one pair of shapes, is placed (not timed), queried (timed) and then gives its answer (not timed).

#include <memory>
#include <span>
#include <string>

#include "bench/motion.h"

namespace tactum::bench {

struct Answer {
  bool answered = false;  ///< the engine gave a value that it does not withdraw
  double distance = 0.0;  ///< signed [m]
  int steps = 0;          ///< of the search, where the engine counts them
};

class Engine {
 public:
  virtual ~Engine() = default;
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  virtual bool reports_distances() const { return true; }  ///< of pieces that are apart
  virtual bool reports_depths() const { return true; }     ///< of pieces that overlap
  /// May refuse pairs that it cannot represent, or would take minutes for.
  virtual bool hold(const Shape& a, const Shape& b) = 0;
  virtual void forget() = 0;                                          ///< drops earlier results
  virtual void place(const Recording& recording, std::size_t i) = 0;  ///< at its i-th pose
  virtual void query() = 0;
  virtual Answer answer() const = 0;
};

struct EngineEntry {
  std::string name;
  std::unique_ptr<Engine> (*make)();
};

inline constexpr const char* kOurs = "tactum";

std::unique_ptr<Engine> make_closest_features();  ///< closest_features, tracked
std::unique_ptr<Engine> make_penetration();       ///< penetration_depth, tracked

/// The peers that were there when the program was built: two solvers of FCL and of Bullet, libccd, ODE.
std::span<const EngineEntry> peers();

}  // namespace tactum::bench
