#pragma once
/// The energy balance of a run, computed from its trace alone (telemetry/trace.h) and from what the scene's
/// bodies are. It shares no code with the balance that the frame keeps (loop/passivity.h): stretches, angles
/// and energies are worked out here from positions, quaternions and velocities.
///
///   D = work of the hand at the device - (what the scene holds now - what it held at first)
///
/// A scene that generates nothing keeps D from sinking below zero; what it dissipates raises D, and so does
/// what the device's own damping and friction eat at least, over the displacement of a frame.

#include <span>
#include <vector>

#include "tactum/dynamics/world.h"
#include "tactum/response/settings.h"
#include "tactum/telemetry/trace.h"

namespace tactum::bench {

class PortReferee {
 public:
  /// The trace must have its bodies.
  PortReferee(const World& world, const FrameSettings& settings, const FrameTrace& trace);

  /// The rows in their order. Frames in which a ramp or a fault changes the wrench are left out.
  void look(std::span<const double> row);

  double balance_J() const { return balance_J_; }    ///< D, now [J]
  double generated_J() const { return -lowest_J_; }  ///< by how much D has been below zero at most [J]
  /// The same at the motors: without what the device eats [J].
  double generated_by_motors_J() const { return -lowest_of_motors_J_; }
  /// The most by which D has sunk from where it had been, at any time: with everything that was dissipated
  /// before forgotten [J].
  double deepest_fall_J() const { return fall_J_; }

 private:
  struct Columns {
    int ramping, device_p, device_q, hand_p, hand_q, proxy_p, proxy_q, sent_f, sent_t, computed_f, computed_t,
        smoothed_f, unfelt, hand_v, hand_w, share, grasped, hold, field_f, field_t;
    std::vector<int> body_p, body_q, body_v, body_w;
  };
  struct Angle {
    double now = 0.0, before = 0.0;
  };

  double stored(std::span<const double> row);
  double body_energy(std::span<const double> row, std::size_t body, bool grasped);
  double spring_energy(std::span<const double> row, std::size_t body, bool grasped);
  double given_from_outside(std::span<const double> row, int grasped);

  const World& world_;
  const FrameSettings& settings_;
  Columns at_;
  std::vector<Angle> joints_;
  Vec3 twist_ = Vec3::Zero();  // from the proxy to the hand, followed over full turns
  bool known_ = false;
  std::vector<double> last_;  // row
  double stored_J_ = 0.0, balance_J_ = 0.0, lowest_J_ = 0.0, eaten_J_ = 0.0, lowest_of_motors_J_ = 0.0,
         highest_J_ = 0.0, fall_J_ = 0.0;
};

}  // namespace tactum::bench
