#include <atomic>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <thread>

#include "rig.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/network_device.h"
#include "tactum/drivers/registry.h"
#include "tactum/drivers/tactum_device.h"

namespace tactum {
namespace {

/// A device in a thread of its own, as it would be in a process: it says hello, again after each goodbye, and
/// moves only when it is told to.
class NetworkRig final : public DriverRig {
 public:
  NetworkRig() : port_(free_port()), place_("TACTUM_NETWORK_DEVICE", std::to_string(port_)) {
    state_.orientation_wxyz[0] = 1.0;
    state_.flags = TACTUM_HAS_VELOCITY;
    thread_ = std::thread([this] { run(); });
  }
  ~NetworkRig() override {
    ends_ = true;
    thread_.join();
  }

  Result<std::unique_ptr<Device>> make_by_name() override { return remembered(make_device("network", {})); }
  Result<std::unique_ptr<Device>> make_unguarded() override {
    Result<NetworkDeviceOptions> options = network_device_options("");
    options->stale_after_s = 3600.0;
    return remembered(NetworkDevice::connect(*options));
  }

  /// 20 mm toward the operator, 40 mm right, 30 mm up, turned by a quarter about z.
  void go_to_known_pose() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const double half = std::sqrt(0.5);
    state_.position[0] = 0.02, state_.position[1] = 0.04, state_.position[2] = 0.03;
    state_.orientation_wxyz[0] = half, state_.orientation_wxyz[3] = half;
    const double V[6] = {-0.3, 0.1, 0.2, 3, 1, 2};
    std::copy(V, V + 6, state_.velocity);
  }
  Pose known_pose_in_D() const override {
    Mat3 R;
    R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    return {R, {0.02, 0.04, 0.03}};
  }
  Twist known_velocity_in_D() const override { return {{-0.3, 0.1, 0.2}, {3, 1, 2}}; }
  void press_button(int number, bool pressed) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.buttons = pressed ? 1u << number : 0;
  }
  void unplug() override { unplugged_ = true; }

  std::vector<Wrench> commands_in_D() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return commands_;
  }
  int most_frames_between_commands() const override { return 25; }  // it takes the newest of what has come
  Wrench motors_in_D() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return motors_;
  }
  std::vector<std::string> broken_rules() override { return {}; }
  bool is_released() override {
    return comes_true([this] { return !linked_.load(); });
  }

  std::string variable() const override { return "TACTUM_NETWORK_DEVICE"; }
  std::vector<std::string> words_when_absent() const override {
    return {"this is no port", "network:ADDRESS:PORT", "TACTUM_NETWORK_DEVICE"};
  }

 private:
  static int free_port() {
    const int probe = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(probe, reinterpret_cast<sockaddr*>(&address), sizeof address);
    socklen_t size = sizeof address;
    ::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
    ::close(probe);
    return ntohs(address.sin_port);
  }

  /// What came before the device was handed out was zero, and measured the way.
  Result<std::unique_ptr<Device>> remembered(Result<std::unique_ptr<Device>> made) {
    const std::lock_guard<std::mutex> lock(mutex_);
    commands_.clear();
    remembers_ = true;
    return made;
  }

  void run() {
    tactum_device_info info{};
    info.flags = TACTUM_SENSES_ROTATION | TACTUM_ACTUATES_FORCE | TACTUM_ACTUATES_TORQUE;
    info.max_force_N = 10.0, info.max_torque_Nm = 0.3;
    info.stiffest_N_per_m = 2000.0, info.stiffest_Nm_per_rad = 1.0;
    info.workspace_radius_m = 0.08, info.rate_Hz = 1000.0;
    std::snprintf(info.name, sizeof info.name, "rig");
    std::snprintf(info.serial, sizeof info.serial, "7");
    tactum_device_link link;
    while (!ends_) {
      if (tactum_device_connect(&link, "127.0.0.1", port_, &info, 50) != 0) continue;
      linked_ = true;
      while (!ends_ && step(link)) std::this_thread::sleep_for(std::chrono::microseconds(300));
      linked_ = false;
      tactum_device_disconnect(&link);
    }
  }

  /// False after a goodbye.
  bool step(tactum_device_link& link) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::uint32_t last = link.last_command;
    const bool goes_on = unplugged_ || tactum_device_send(&link, &state_) == 0;
    double F[6];
    tactum_device_receive(&link, F);
    motors_ = {{F[0], F[1], F[2]}, {F[3], F[4], F[5]}};
    const double* sent = link.wrench;
    if (remembers_ && link.last_command != last)
      commands_.push_back({{sent[0], sent[1], sent[2]}, {sent[3], sent[4], sent[5]}});
    return goes_on;
  }

  const int port_;
  SetVariable place_;
  std::mutex mutex_;
  tactum_device_state state_{};
  std::vector<Wrench> commands_;
  Wrench motors_;
  bool remembers_ = false;
  std::atomic<bool> ends_{false}, unplugged_{false}, linked_{false};
  std::thread thread_;
};

}  // namespace

std::unique_ptr<DriverRig> make_network_rig() { return std::make_unique<NetworkRig>(); }

}  // namespace tactum
