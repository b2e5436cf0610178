#pragma once
/// The rules by which udev lets the users of a machine open haptic devices.

namespace tactum::inline v0_1 {

/// Where the rules belong: before 73, at which the tag `uaccess` is read.
inline constexpr const char* kUdevRulesPath = "/etc/udev/rules.d/71-tactum-haptics.rules";

/// The text of the file, a line for each make of device.
const char* udev_rules();

}  // namespace tactum::inline v0_1
