#pragma once
/// tactum devices --try NAME: the guided first touch (session/first_touch.h) on a terminal.

#include <string>

namespace tactum {

struct TryOptions {
  std::string device;        ///< as `tactum devices` lists it
  bool yes = false;          ///< no question waits for ENTER
  double patience_s = 20.0;  ///< how long a step waits for the person [s]
  std::string profile;       ///< write the profile to this file instead
};

/// Ends the command with 2 when a step was not good.
void try_device(const TryOptions& options);

}  // namespace tactum
