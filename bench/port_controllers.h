#pragma once
/// Ways to keep a port from giving out energy that nobody put in, side by side at one spring that keeps a
/// simulated device on a plane from both sides:
///
///   none          the spring's force is sent
///   damping       a damper takes the deficit of the balance out in the next frame [Hannaford and Ryu 2002]
///   reference     the same, but the balance follows the energy of a passive spring, so that little is
///                 missing at a time, and the damper's force is filtered [Ryu 2005]
///   bounding      the force may change only as far as the device's own damping can dissipate what that
///                 generates [Kim 2010]
///   stiffness     the spring's stiffness sinks until its store has paid (loop/passivity.h)

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/report.h"
#include "tactum/devices/simulated_device.h"

namespace tactum::bench {

struct ControllerRow {
  std::string controller, device, hand;
  double bounds = 0.0;         ///< stiffness over what device and hand allow
  double delay_s = 0.0;        ///< [s]
  double late_m_per_s = 0.0;   ///< fastest after a second, knocked at first [m/s]
  double added_N_per_s = 0.0;  ///< fastest change of what the controller adds to the force [N/s]
  double to_and_fro_N = 0.0;   ///< the smaller of two steps in turn that go against each other, most [N]
  double felt_share = 0.0;     ///< force at rest, the hand pressing by 5 mm, over the spring's [-]
};

std::vector<ControllerRow> bench_controllers(const std::function<void(const std::string&)>& progress);
Table table_of(const std::vector<ControllerRow>& rows);
nlohmann::ordered_json to_json(const ControllerRow& row);

}  // namespace tactum::bench
