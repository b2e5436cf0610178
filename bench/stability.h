#pragma once
/// The stiffest wall that a device displays stably in a hand. Found by simulation, beside the passivity bound
/// of [Colgate and Schenkel 1994] (haptics/coupling_gains.h).
///
///   wall: a plane with a spring (or a stop with a torsion spring) right at the device, F = - K depth,
///         on the encoder's readings, nothing else in the loop: no proxy, smoothing, ramp
///   hand: taps it twice, then presses and stays                          2.4 s of virtual time
///
/// The handle is *at rest* when, in the last third of the pressing, it moves by less than it did in the third
/// before, or by less than a hand can feel. The wall is *passive* when the balance of the port
/// (loop/passivity.h), with the damping of device and hand and no credit but the energy stored in the spring,
/// never falls 0.01 mJ below zero: no energy was generated. The stiffest of each kind is found by bisection.

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/devices/simulated_device.h"

namespace tactum::bench {

/// One experiment: a device in a hand at a wall.
struct WallSetup {
  SimulatedDeviceModel device;  ///< its command_delay_s is the delay
  HandModel hand;
  double rate_Hz = 1000.0;  ///< [Hz]
  bool turning = false;     ///< a stop for rotation
};

/// The bound with all the damping there is: (b_device + b_hand) / (T / 2 + delay) [N/m or N m/rad].
double wall_bound(const WallSetup& setup);
/// ... and for a handle that nobody holds.
double wall_bound_alone(const WallSetup& setup);

struct WallTrial {
  bool at_rest = false;
  bool passive = false;
  double rest_speed = 0.0;  ///< fastest in the last third [m/s or rad/s]
  double lowest_J = 0.0;    ///< of the balance [J]
  double pressed = 0.0;     ///< mean force (torque) in the last third [N or N m]
};

/// Taps and presses a wall of this stiffness for `seconds` of virtual time.
WallTrial try_wall(const WallSetup& setup, double stiffness, double seconds = 2.4);

struct WallRow {
  std::string device, hand;
  bool turning = false;
  double rate_Hz = 0.0;
  double delay_s = 0.0;
  double alone = 0.0;    ///< bound, nobody holds it [N/m or N m/rad]
  double bound = 0.0;    ///< bound, with the hand's damping
  double passive = 0.0;  ///< stiffest that generated no energy
  double at_rest = 0.0;  ///< stiffest that came to rest
};

/// The stiffest walls of one set-up, to 1 %.
WallRow stiffest_wall(const WallSetup& setup);

struct StabilityOptions {
  std::vector<double> rates_Hz = {1000.0, 2000.0, 4000.0, 10000.0};
  std::vector<double> delays_s = {0.0, 0.5e-3, 1e-3, 2e-3};
  std::vector<std::string> devices;  ///< empty: all presets
};

/// Every preset, hand, rate and delay; turning where there is torque. `progress` is called with each device.
Result<std::vector<WallRow>> bench_stability(const StabilityOptions& options,
                                             const std::function<void(const std::string&)>& progress);

nlohmann::ordered_json to_json(const WallRow& row);

/// A hand that presses a block onto a plate, through the coupling that is chosen for the device and the whole
/// frame, and opens.
struct ReleaseRow {
  std::string device;
  double pressed_N = 0.0;       ///< force before [N]
  double peak_m_per_s = 0.0;    ///< fastest speed of the handle afterwards [m/s]
  double rest_s = 0.0;          ///< from then on it is slower than 1 mm/s [s]
  bool at_rest = false;         ///< it came to rest
  double largest_step_N = 0.0;  ///< of the sent force afterwards [N]
  double slew_limit_N = 0.0;    ///< what the device's slew limit allows in a frame [N]
  double least_share = 1.0;     ///< of the coupling's stiffness [-]
  double travelled_m = 0.0;     ///< from where it was let go of to where it rests [m]
};

/// Pressed with `force_N`, or four fifths of what the device can exert; let go of after a second.
ReleaseRow release_pressed(const SimulatedDeviceModel& device, double force_N = 5.0, double rate_Hz = 1000.0);

nlohmann::ordered_json to_json(const ReleaseRow& row);

/// Stiffness against rate and against delay, simulated and bound: an SVG file's text.
std::string z_width_plot(const std::vector<WallRow>& rows);

}  // namespace tactum::bench
