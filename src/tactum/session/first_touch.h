#pragma once
/// The guided first touch of a device: `tactum devices --try NAME`. Before every step the person is asked,
/// and may stop at any time; every step begins with a ramp from zero (touch_server.h). It ends at the first
/// step that is not good, so that no force follows axes that are wrong.
///
///   read      the device gives plausible, changing samples; nothing is sent but zero
///   move      to the right, up, toward the person: which axis read it, with which sign
///   turn      the same of the orientation, where it is sensed
///   wall      a soft floor under the handle, with little force
///   push      let go: a small, slowly growing force along each axis, until the handle has moved by 5 mm
///   answer    let go: short pushes to and fro; mass, damping, friction and delay (handle_response.h); the
///             same of turning, where the device turns its handle
///   limits    the floor with the coupling that was chosen for the device, and the forces that it states
///
/// Steps that the device cannot do are left out: what only leads the hand ends after `turn`.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tactum/session/handle_response.h"
#include "tactum/session/touch_server.h"

namespace tactum::inline v0_1 {

/// What the person is asked to do while a step runs.
enum class TouchTask {
  kHoldStill,
  kMove,       ///< along TouchRequest::axis
  kTurn,       ///< about it
  kPressDown,  ///< onto the floor under the handle
  kRelease     ///< nobody touches the handle
};

/// A question to the person, before a step.
struct TouchRequest {
  TouchTask task = TouchTask::kHoldStill;
  int axis = 0;      ///< of the device frame, 0 to 2; the direction is its positive one
  std::string text;  ///< what will happen, and what the person shall do
};

/// The person at the device.
class TouchPerson {
 public:
  enum class Word { kNothing, kGoOn, kStop };

  virtual ~TouchPerson() = default;
  virtual void report(const std::string& sentence) = 0;
  /// The step begins when heard() says so.
  virtual void ask(const TouchRequest& request) = 0;
  /// What was said since the last call. Called in every frame, so it must not wait.
  virtual Word heard() = 0;

 protected:
  TouchPerson() = default;
  TouchPerson(const TouchPerson&) = default;
  TouchPerson& operator=(const TouchPerson&) = default;
};

struct TouchPlanSettings {
  double rate_Hz = 1000.0;
  double patience_s = 20.0;       ///< how long a step waits for the person to do its task [s]
  double answer_s = 3600.0;       ///< how long a question waits for its answer [s]
  double small_force_N = 1.5;     ///< of the soft wall and the pushes, or a quarter of the device's [N]
  double small_torque_Nm = 0.03;  ///< the same of torques [N m]
};

/// The outcome of a step.
struct TouchFinding {
  std::string step;  ///< "move up"
  bool good = false;
  std::string sentence;  ///< what was found; with the cure where it is not good
};

struct TouchReport {
  bool passed = false;                     ///< all steps were made and are good
  std::string ended_by;                    ///< why not; empty when passed
  std::vector<TouchFinding> findings;      ///< in the order of the steps
  std::optional<HandleResponse> response;  ///< as measured along x
  std::optional<TurnResponse> turning;     ///< as measured about x
  double largest_N = 0.0;                  ///< of all forces that were sent [N]
  double largest_Nm = 0.0;                 ///< of all torques [N m]
};

/// Opens the device, goes through the steps, closes it with a zero wrench. Slow; may allocate.
TouchReport first_touch(Device& device, const TouchPlanSettings& settings, TouchPerson& person,
                        TouchClock& clock);

/// How a direction was read: along which axis, with which sign.
struct ReadAxis {
  int axis = 0;  ///< 0 to 2
  double sign = 1.0;
};

/// Empty when toward, right and up were read as x, y and z; else what is flipped, swapped or turned.
std::string axes_fault(const std::array<ReadAxis, 3>& read);

/// "toward you (+x)", "to the left (-y)".
std::string direction_name(const ReadAxis& direction);

/// The axis along which most of `v` lies; nothing where it is not clear: less than 0.8 of its length.
std::optional<ReadAxis> clear_axis(const Vec3& v);

}  // namespace tactum::inline v0_1
