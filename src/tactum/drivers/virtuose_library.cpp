#include "tactum/drivers/virtuose_library.h"

namespace tactum::inline v0_1 {

Result<VirtuoseLibrary> VirtuoseLibrary::load() {
  const LibrarySearch search{"Haption",
                             "TACTUM_VIRTUOSE_LIBRARY",
                             {"libVirtuoseAPI.so"},
                             {"/usr/local/lib", "/usr/lib", "/usr/lib/x86_64-linux-gnu"},
                             "install VirtuoseAPI 4 of Haption, and libtirpc3, which it uses",
                             {"libm.so.6", "libtirpc.so.3"}};
  Result<VendorLibrary> loaded = VendorLibrary::load(search);
  if (!loaded) return loaded.error();
  VirtuoseLibrary found{std::move(*loaded), {}};
  VendorLibrary& library = found.library;
  VirtuoseFunctions& call = found.call;
  library.require("virtOpen", call.open);
  library.require("virtClose", call.close);
  library.require("virtGetErrorCode", call.error_code);
  library.require("virtGetErrorMessage", call.error_message);
  library.require("virtAPIVersion", call.api_version);
  library.require("virtGetDeviceID", call.device_id);
  library.require("virtGetNbAxes", call.axis_count);
  library.require("virtSetIndexingMode", call.set_indexing);
  library.require("virtSetForceFactor", call.set_force_factor);
  library.require("virtSetSpeedFactor", call.set_speed_factor);
  library.require("virtSetTimeStep", call.set_time_step);
  library.require("virtSetBaseFrame", call.set_base_frame);
  library.require("virtSetObservationFrame", call.set_observation_frame);
  library.require("virtSetCommandType", call.set_command_type);
  library.require("virtSaturateTorque", call.saturate);
  library.require("virtEnableForceFeedback", call.enable_force);
  library.require("virtSetPowerOn", call.set_power);
  library.require("virtGetPowerOn", call.get_power);
  library.require("virtGetPhysicalPosition", call.get_pose);
  library.require("virtGetPhysicalSpeed", call.get_speed);
  library.require("virtGetForce", call.get_force);
  library.require("virtSetForce", call.set_force);
  library.require("virtGetButton", call.get_button);
  library.require("virtGetDeadMan", call.get_dead_man);
  library.require("virtGetEmergencyStop", call.get_emergency_stop);
  library.require("virtSetPeriodicFunction", call.set_periodic);
  library.require("virtStartLoop", call.start_loop);
  library.require("virtStopLoop", call.stop_loop);
  if (Result<void> whole = library.check(); !whole) return whole.error();
  return found;
}

}  // namespace tactum::inline v0_1
