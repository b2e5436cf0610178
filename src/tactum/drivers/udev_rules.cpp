#include "tactum/drivers/udev_rules.h"

namespace tactum::inline v0_1 {

const char* udev_rules() {
  return R"(# Haptic devices: whoever sits at the machine, and the groups plugdev and dialout, may open them.
# Force Dimension
SUBSYSTEM=="usb", ATTR{idVendor}=="1451", MODE="0660", GROUP="plugdev", TAG+="uaccess"
# Novint Falcon
SUBSYSTEM=="usb", ATTR{idVendor}=="0403", ATTR{idProduct}=="cb48", MODE="0660", GROUP="plugdev", TAG+="uaccess"
# 3D Systems Touch, on USB as a serial port or as HID; ModemManager must not speak to it
SUBSYSTEM=="tty", ATTRS{idVendor}=="0301", ATTRS{idProduct}=="2988", MODE="0660", GROUP="dialout", TAG+="uaccess", ENV{ID_MM_DEVICE_IGNORE}="1"
SUBSYSTEM=="tty", ATTRS{idVendor}=="2988", MODE="0660", GROUP="dialout", TAG+="uaccess", ENV{ID_MM_DEVICE_IGNORE}="1"
KERNEL=="hidraw*", ATTRS{idVendor}=="2988", MODE="0660", GROUP="plugdev", TAG+="uaccess"
# SpaceMouse of 3Dconnexion and of Logitech, for the viewer's page
KERNEL=="hidraw*", ATTRS{idVendor}=="256f", MODE="0660", GROUP="plugdev", TAG+="uaccess"
KERNEL=="hidraw*", ATTRS{idVendor}=="046d", ATTRS{idProduct}=="c6[0-2]?", MODE="0660", GROUP="plugdev", TAG+="uaccess"
# Haply Inverse3 and the receiver of its grips, for the maker's service; ModemManager must not speak to them
SUBSYSTEM=="tty", ATTRS{idVendor}=="16c0", ATTRS{idProduct}=="0483", MODE="0660", GROUP="dialout", ENV{ID_MM_DEVICE_IGNORE}="1"
SUBSYSTEM=="tty", ATTRS{idVendor}=="2fe3", ATTRS{idProduct}=="0100", MODE="0660", GROUP="dialout", ENV{ID_MM_DEVICE_IGNORE}="1"
)";
}

}  // namespace tactum::inline v0_1
