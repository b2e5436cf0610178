#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <thread>

#include "rig.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/network_device.h"
#include "tactum/drivers/registry.h"
#include "tactum/drivers/tactum_device.h"
#include "web_peer.h"

namespace tactum {
namespace {

/// The device's end of the protocol.
class DeviceEnd {
 public:
  virtual ~DeviceEnd() = default;
  /// Says hello, for 50 ms.
  virtual bool connect(int port, const tactum_device_info& info) = 0;
  /// Takes commands, and sends the state if there is one. False after a goodbye.
  virtual bool exchange(const tactum_device_state* state) = 0;
  /// What is to be exerted: zero when it is stale.
  virtual Wrench exerted() = 0;
  virtual void disconnect() = 0;
  /// The last command, and its sequence.
  Wrench command() const { return command_; }
  std::uint32_t sequence() const { return sequence_; }

 protected:
  static Wrench wrench_of(const double* F) { return {{F[0], F[1], F[2]}, {F[3], F[4], F[5]}}; }
  Wrench command_;
  std::uint32_t sequence_ = 0;
};

/// Over UDP, by the header that devices use.
class DatagramEnd final : public DeviceEnd {
 public:
  bool connect(int port, const tactum_device_info& info) override {
    return tactum_device_connect(&link_, "127.0.0.1", port, &info, 50) == 0;
  }
  bool exchange(const tactum_device_state* state) override {
    const bool goes_on = state == nullptr || tactum_device_send(&link_, state) == 0;
    exerted();
    return goes_on;
  }
  Wrench exerted() override {
    double F[6];
    tactum_device_receive(&link_, F);
    command_ = wrench_of(link_.wrench);
    sequence_ = link_.last_command;
    return wrench_of(F);
  }
  void disconnect() override { tactum_device_disconnect(&link_); }

 private:
  tactum_device_link link_{};
};

/// Over WebSocket, message by message.
class WebEnd final : public DeviceEnd {
 public:
  bool connect(int port, const tactum_device_info& info) override {
    if (!peer_.connect(port)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      return false;
    }
    sequence_ = 0;
    welcome_ = said_goodbye_ = false;
    const double begin_s = tactum_clock_s();
    for (double hello_s = 0.0; !welcome_ && tactum_clock_s() - begin_s < 0.5;) {
      if (tactum_clock_s() - hello_s > 0.1) {
        const tactum_wire_hello hello = {head(TACTUM_WIRE_HELLO), info};
        send(hello);
        hello_s = tactum_clock_s();
      }
      drain();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (!welcome_) peer_.close();
    return welcome_;
  }
  bool exchange(const tactum_device_state* state) override {
    drain();
    if (state == nullptr) return true;
    if (said_goodbye_ || !peer_.is_open()) return false;
    tactum_wire_state out{};
    out.header = head(TACTUM_WIRE_STATE);
    out.time_s = tactum_clock_s();
    out.last_command = sequence_;
    out.since_command_s = sequence_ == 0 ? 0.0 : out.time_s - command_s_;
    out.state = *state;
    send(out);
    return true;
  }
  Wrench exerted() override {
    const bool fresh = sequence_ != 0 && !said_goodbye_ && peer_.is_open() &&
                       tactum_clock_s() - command_s_ <= TACTUM_DEVICE_STALE_S;
    return fresh ? command_ : Wrench{};
  }
  void disconnect() override {
    send(head(TACTUM_WIRE_BYE));
    peer_.close();
  }

 private:
  tactum_wire_header head(int kind) {
    return {TACTUM_DEVICE_MAGIC, TACTUM_DEVICE_VERSION, static_cast<std::uint16_t>(kind), 4242, ++sent_};
  }
  template <class Packet>
  void send(const Packet& packet) {
    std::vector<unsigned char> bytes(sizeof packet);
    std::memcpy(bytes.data(), &packet, sizeof packet);
    peer_.send(bytes);
  }
  void drain() {
    while (const auto bytes = peer_.take()) {
      tactum_wire_command got{};
      std::memcpy(&got, bytes->data(), std::min(bytes->size(), sizeof got));
      if (got.header.kind == TACTUM_WIRE_WELCOME) welcome_ = true;
      if (got.header.kind == TACTUM_WIRE_BYE) said_goodbye_ = true;
      if (got.header.kind != TACTUM_WIRE_COMMAND) continue;
      sequence_ = got.header.sequence;
      command_s_ = tactum_clock_s();
      command_ = wrench_of(got.wrench);
    }
  }

  WebPeer peer_;
  std::uint32_t sent_ = 0;
  double command_s_ = 0.0;
  bool welcome_ = false, said_goodbye_ = false;
};

/// A device in a thread of its own, as it would be in a process: it says hello, again after each goodbye, and
/// moves only when it is told to.
class NetworkRig final : public DriverRig {
 public:
  explicit NetworkRig(std::unique_ptr<DeviceEnd> end)
      : end_(std::move(end)),
        port_(free_network_port()),
        place_("TACTUM_NETWORK_DEVICE", std::to_string(port_)) {
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
    while (!ends_) {
      if (!end_->connect(port_, info)) continue;
      linked_ = true;
      while (!ends_ && step()) std::this_thread::sleep_for(std::chrono::microseconds(300));
      linked_ = false;
      end_->disconnect();
    }
  }

  /// False after a goodbye.
  bool step() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::uint32_t last = end_->sequence();
    const bool goes_on = end_->exchange(unplugged_ ? nullptr : &state_);
    motors_ = end_->exerted();
    if (remembers_ && end_->sequence() != last) commands_.push_back(end_->command());
    return goes_on;
  }

  std::unique_ptr<DeviceEnd> end_;
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

std::unique_ptr<DriverRig> make_network_rig() {
  return std::make_unique<NetworkRig>(std::make_unique<DatagramEnd>());
}
std::unique_ptr<DriverRig> make_web_network_rig() {
  return std::make_unique<NetworkRig>(std::make_unique<WebEnd>());
}

}  // namespace tactum
