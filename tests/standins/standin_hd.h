#pragma once
/// A stand-in for libHD, the device library of OpenHaptics, and for a device behind it. It exports HDAPI's
/// names and keeps its rules: a thread of its own calls the scheduled functions about 1000 times a second;
/// forces are set within a frame, last until the next, and need HD_FORCE_OUTPUT; errors are kept on a stack.
/// What breaks a rule is remembered, and put on the stack as the library does.

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace tactum::standin {

struct HdDevice {
  std::mutex mutex;  // of everything below
  // What there is; HDAPI's units and axes.
  bool connected = true;
  bool six_dof = true;
  bool unplugged = false;
  unsigned calibration = 0x5000;      // HD_CALIBRATION_OK
  int calibration_styles = 4;         // inkwell
  bool refuses_encoder_reset = true;  // as a real Premium does
  double max_force_N = 8.5;
  std::array<double, 6> workspace{-80, -50, -70, 80, 70, 70};
  std::array<double, 16> transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::array<double, 3> velocity{}, angular_velocity{};
  int buttons = 0;
  bool knows_last_wrench = true;  // HD_LAST_FORCE and HD_LAST_TORQUE
  bool overheats = false;         // every frame ends with HD_WARM_MOTORS
  // What happened to it.
  bool open = false, in_frame = false, force_output = false, scheduled = false, running = false;
  int calibration_updates = 0;
  unsigned last_style = 0;
  std::array<double, 6> setting{};              // of the frame that is open: N, then mN m
  std::array<double, 6> motors{};               // of the last frame
  std::vector<std::array<double, 6>> commands;  // of every frame
  std::vector<unsigned> errors;                 // the stack
  std::vector<std::string> broken_rules;
};

}  // namespace tactum::standin

extern "C" {
tactum::standin::HdDevice* standin_hd_device();
/// Calls the scheduled function now, and no more by itself until the scheduler is started again.
void standin_hd_tick();
}
