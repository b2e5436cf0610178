#include "tactum/drivers/hd_library.h"

namespace tactum::inline v0_1 {

Result<HdLibrary> HdLibrary::load() {
  const LibrarySearch search{
      "3D Systems",
      "TACTUM_OPENHAPTICS_LIBRARY",
      {"libHD.so"},
      {"/opt/OpenHaptics/lib", "/usr/lib", "/usr/lib/x86_64-linux-gnu", "/usr/local/lib"},
      "install OpenHaptics and the Touch device driver of 3D Systems"};
  Result<VendorLibrary> loaded = VendorLibrary::load(search);
  if (!loaded) return loaded.error();
  HdLibrary found{std::move(*loaded), {}};
  VendorLibrary& library = found.library;
  HdFunctions& call = found.call;
  library.require("hdInitDevice", call.init_device);
  library.require("hdDisableDevice", call.disable_device);
  library.require("hdMakeCurrentDevice", call.make_current);
  library.require("hdBeginFrame", call.begin_frame);
  library.require("hdEndFrame", call.end_frame);
  library.require("hdGetError", call.get_error);
  library.require("hdGetErrorString", call.error_string);
  library.require("hdEnable", call.enable);
  library.require("hdDisable", call.disable);
  library.require("hdGetIntegerv", call.get_integers);
  library.require("hdGetDoublev", call.get_doubles);
  library.require("hdGetString", call.get_string);
  library.require("hdSetDoublev", call.set_doubles);
  library.require("hdCheckCalibration", call.check_calibration);
  library.require("hdUpdateCalibration", call.update_calibration);
  library.require("hdStartScheduler", call.start_scheduler);
  library.require("hdStopScheduler", call.stop_scheduler);
  library.require("hdScheduleAsynchronous", call.schedule);
  library.require("hdUnschedule", call.unschedule);
  if (Result<void> whole = library.check(); !whole) return whole.error();
  return found;
}

}  // namespace tactum::inline v0_1
