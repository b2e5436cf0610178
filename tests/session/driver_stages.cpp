#include "driver_stages.h"

#include <arpa/inet.h>

#include <Eigen/Geometry>
#include <atomic>
#include <thread>

#include "standins/standin_dhd.h"
#include "standins/standin_haply.h"
#include "standins/standin_hd.h"
#include "standins/standin_virtuose.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/force_dimension.h"
#include "tactum/drivers/haply.h"
#include "tactum/drivers/network_device.h"
#include "tactum/drivers/tactum_device.h"
#include "tactum/drivers/touch.h"
#include "tactum/drivers/virtuose.h"

namespace tactum {
namespace {

constexpr double kNever_s = 3600.0;

/// The three numbers of a vector, from one place of an array on.
template <class Numbers>
void put_vector(const Vec3& v, Numbers& numbers, std::size_t at = 0) {
  using Number = typename Numbers::value_type;
  for (std::size_t i = 0; i < 3; ++i) numbers[at + i] = static_cast<Number>(v[static_cast<Eigen::Index>(i)]);
}

class ForceDimensionStage final : public DriverStage {
 public:
  ForceDimensionStage() { device().old_firmware = true; }  // no watchdog
  Result<std::unique_ptr<Device>> connect() override {
    return ForceDimensionDevice::connect({.serial = "", .stale_after_s = kNever_s});
  }
  SentWrench as_sent(const Wrench& F) const override {
    return {F.f.x(), F.f.y(), F.f.z(), F.t.x(), F.t.y(), F.t.z()};
  }
  void begin() override { device().commands.clear(); }
  void measure(const DeviceSample& sample, double) override {
    standin::DhdSample& now = device().now;
    put_vector(sample.X_DH.p, now.p);
    put_vector(sample.V_DH.v, now.v);
    put_vector(sample.V_DH.w, now.w);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        now.frame[static_cast<std::size_t>(3 * row + column)] = sample.X_DH.R(row, column);
    now.buttons = sample.buttons;
  }
  std::vector<SentWrench> commands() override {
    std::vector<SentWrench> sent;
    for (const auto& F : device().commands) sent.push_back({F[0], F[1], F[2], F[3], F[4], F[5]});
    return sent;
  }
  std::vector<std::string> broken_rules() override { return device().broken_rules; }

 private:
  standin::DhdDevice& device() { return *loaded_.function<standin::DhdDevice*()>("standin_dhd_device")(); }
  LoadedStandin loaded_{"standin_dhd"};
  SetVariable library_{"TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd")};
};

/// Its library calls it once before every reading, and then sends what was written in the frame before.
class TouchStage final : public DriverStage {
 public:
  TouchStage() { device().workspace = {-80, -70, -70, 80, 70, 70}; }  // its middle is HDAPI's origin
  Result<std::unique_ptr<Device>> connect() override {
    return TouchDevice::connect({.name = "", .stale_after_s = kNever_s});
  }
  DeviceSample passed(DeviceSample sample) const override {
    sample.X_DH.p = Vec3(sample.X_DH.p * 1000.0) * 0.001;
    sample.V_DH.v = Vec3(sample.V_DH.v * 1000.0) * 0.001;
    sample.has_velocity = true;
    return sample;
  }
  /// Right, up, toward the user; newtons, then thousandths of a newton metre.
  SentWrench as_sent(const Wrench& F) const override {
    return {F.f.y(), F.f.z(), F.f.x(), F.t.y() * 1000.0, F.t.z() * 1000.0, F.t.x() * 1000.0};
  }
  void begin() override {
    tick_();
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().commands.clear();
  }
  void measure(const DeviceSample& sample, double) override {
    const auto in_hd = [](const Vec3& v) { return Vec3(v.y(), v.z(), v.x()); };
    {
      const std::lock_guard<std::mutex> lock(device().mutex);
      // Columns are HDAPI's axes of the handle: D's y, z and x.
      for (std::size_t column = 0; column < 3; ++column)
        put_vector(in_hd(sample.X_DH.R.col(static_cast<Eigen::Index>((column + 1) % 3))), device().transform,
                   4 * column);
      put_vector(in_hd(sample.X_DH.p * 1000.0), device().transform, 12);
      put_vector(in_hd(sample.V_DH.v * 1000.0), device().velocity);
      put_vector(in_hd(sample.V_DH.w), device().angular_velocity);
    }
    tick_();
  }
  std::vector<SentWrench> commands() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    return device().commands;
  }
  std::size_t commands_before() const override { return 1; }
  std::vector<std::string> broken_rules() override { return device().broken_rules; }

 private:
  standin::HdDevice& device() { return *loaded_.function<standin::HdDevice*()>("standin_hd_device")(); }
  LoadedStandin loaded_{"standin_hd"};
  SetVariable library_{"TACTUM_OPENHAPTICS_LIBRARY", standin_file("standin_hd")};
  void (*tick_)() = loaded_.function<void()>("standin_hd_tick");
};

/// As the Touch; and what it tells is rounded to float.
class VirtuoseStage final : public DriverStage {
 public:
  VirtuoseStage() { device().pose = {0, 0, 0, 0, 0, 0, 1}; }  // where it is opened is the origin
  Result<std::unique_ptr<Device>> connect() override {
    return VirtuoseDevice::connect({.host = "", .stale_after_s = kNever_s, .relays_s = 0.0});
  }
  DeviceSample passed(DeviceSample sample) const override {
    const auto [pose, speed] = report_of(sample);
    const auto& [x, y, z, qx, qy, qz, qw] = pose;
    sample.X_DH = {Eigen::Quaterniond(qw, qx, qy, qz).normalized().toRotationMatrix(), {x, y, z}};
    sample.V_DH = {{speed[0], speed[1], speed[2]}, {speed[3], speed[4], speed[5]}};
    sample.has_velocity = true;
    return sample;
  }
  SentWrench as_sent(const Wrench& F) const override {
    std::array<float, 6> rounded{};
    put_vector(F.f, rounded);
    put_vector(F.t, rounded, 3);
    SentWrench sent{};
    std::copy(rounded.begin(), rounded.end(), sent.begin());
    return sent;
  }
  void begin() override {
    tick_();
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().commands.clear();
  }
  void measure(const DeviceSample& sample, double) override {
    {
      const std::lock_guard<std::mutex> lock(device().mutex);
      const Report report = report_of(sample);
      device().pose = report.pose;
      device().speed = report.speed;
    }
    tick_();
  }
  std::vector<SentWrench> commands() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    std::vector<SentWrench> sent(device().commands.size());
    for (std::size_t i = 0; i < sent.size(); ++i)
      std::copy(device().commands[i].begin(), device().commands[i].end(), sent[i].begin());
    return sent;
  }
  std::size_t commands_before() const override { return 1; }
  std::vector<std::string> broken_rules() override { return device().broken_rules; }

 private:
  struct Report {
    std::array<float, 7> pose{};
    std::array<float, 6> speed{};
  };
  static Report report_of(const DeviceSample& sample) {
    const Eigen::Quaterniond q(sample.X_DH.R);
    Report report;
    put_vector(sample.X_DH.p, report.pose);
    put_vector(q.vec(), report.pose, 3);
    report.pose[6] = static_cast<float>(q.w());
    put_vector(sample.V_DH.v, report.speed);
    put_vector(sample.V_DH.w, report.speed, 3);
    return report;
  }
  standin::VirtuoseDevice& device() {
    return *loaded_.function<standin::VirtuoseDevice*()>("standin_virtuose_device")();
  }
  LoadedStandin loaded_{"standin_virtuose"};
  SetVariable library_{"TACTUM_VIRTUOSE_LIBRARY", standin_file("standin_virtuose")};
  void (*tick_)() = loaded_.function<void()>("standin_virtuose_tick");
};

/// Its thread has always one message under way, so a command arrives two answers later. Without a grip.
class HaplyStage final : public DriverStage {
 public:
  Result<std::unique_ptr<Device>> connect() override {
    HaplyOptions options;
    options.host = "127.0.0.1";
    options.port = service_.port();
    options.stale_after_s = kNever_s;
    options.period_s = 0.0;
    return HaplyDevice::connect(options);
  }
  DeviceSample passed(DeviceSample sample) const override {
    sample.X_DH.R = Mat3::Identity();
    sample.V_DH.w = Vec3::Zero();
    sample.has_velocity = true;
    return sample;
  }
  /// Right, forward, up.
  SentWrench as_sent(const Wrench& F) const override { return {F.f.y(), -F.f.x(), F.f.z(), 0, 0, 0}; }
  void begin() override {
    service_.answer_by_hand();
    service_.locked()->commands.clear();
  }
  void measure(const DeviceSample& sample, double) override {
    {
      const standin::HaplyService::Locked now = service_.locked();
      const Vec3 &p = sample.X_DH.p, &v = sample.V_DH.v;
      now.world.position = {p.y(), -p.x(), p.z()};
      now.world.velocity = {v.y(), -v.x(), v.z()};
    }
    service_.answer_one();
  }
  void end() override { service_.answer_all(); }
  std::vector<SentWrench> commands() override {
    const standin::HaplyService::Locked now = service_.locked();
    std::vector<SentWrench> sent;
    for (const standin::Triple& F : now.world.commands) sent.push_back({F[0], F[1], F[2], 0, 0, 0});
    return sent;
  }
  std::size_t commands_before() const override { return 2; }
  std::vector<std::string> broken_rules() override { return service_.locked()->broken_rules; }

 private:
  standin::HaplyService service_;
};

/// The device in this thread, but while it is met: it says what it measures just before it is read. Its clock
/// is the loop's.
class NetworkStage final : public DriverStage {
 public:
  ~NetworkStage() override {
    if (linked_) tactum_device_disconnect(&link_);
  }
  Result<std::unique_ptr<Device>> connect() override {
    if (linked_) tactum_device_disconnect(&link_);
    NetworkDeviceOptions options;
    options.port = free_port();
    options.stale_after_s = kNever_s;
    std::atomic<bool> met{false};
    std::thread device([&] { meet(options.port, met); });
    Result<std::unique_ptr<Device>> connected = NetworkDevice::connect(options);
    met = true;
    device.join();
    return connected;
  }
  DeviceSample passed(DeviceSample sample) const override {
    const Eigen::Quaterniond q(sample.X_DH.R);
    sample.X_DH.R = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
    sample.has_velocity = true;
    return sample;
  }
  SentWrench as_sent(const Wrench& F) const override {
    return {F.f.x(), F.f.y(), F.f.z(), F.t.x(), F.t.y(), F.t.z()};
  }
  void begin() override {
    tactum_device_drain(&link_, nullptr);
    commands_.clear();
  }
  void measure(const DeviceSample& sample, double now_s) override {
    const Eigen::Quaterniond q(sample.X_DH.R);
    tactum_wire_state out{};
    out.header = tactum_wire_head(&link_, TACTUM_WIRE_STATE);
    out.time_s = now_s;
    for (int i = 0; i < 3; ++i) {
      out.state.position[i] = sample.X_DH.p[i];
      out.state.velocity[i] = sample.V_DH.v[i];
      out.state.velocity[3 + i] = sample.V_DH.w[i];
      out.state.orientation_wxyz[1 + i] = q.vec()[i];
    }
    out.state.orientation_wxyz[0] = q.w();
    out.state.flags = TACTUM_HAS_VELOCITY;
    static_cast<void>(send(link_.socket, &out, sizeof out, 0));
  }
  void after_write() override {
    const std::uint32_t last = link_.last_command;
    comes_true([&] {
      tactum_device_drain(&link_, nullptr);
      return link_.last_command != last;
    });
    SentWrench sent{};
    std::copy(link_.wrench, link_.wrench + 6, sent.begin());
    commands_.push_back(sent);
  }
  std::vector<SentWrench> commands() override { return commands_; }

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
  void meet(int port, const std::atomic<bool>& met) {
    tactum_device_info info{};
    info.flags = TACTUM_SENSES_ROTATION | TACTUM_ACTUATES_FORCE | TACTUM_ACTUATES_TORQUE;
    info.max_force_N = 12.0, info.max_torque_Nm = 0.2;
    info.stiffest_N_per_m = 2000.0, info.stiffest_Nm_per_rad = 1.0;
    info.workspace_radius_m = 0.075, info.rate_Hz = 1000.0;
    linked_ = tactum_device_connect(&link_, "127.0.0.1", port, &info, 60'000) == 0;
    tactum_device_state state{};
    state.orientation_wxyz[0] = 1.0;
    while (linked_ && !met) {
      tactum_device_send(&link_, &state);
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  }

  tactum_device_link link_{};
  bool linked_ = false;
  std::vector<SentWrench> commands_;
};

template <class Stage>
StageMaker stage(const char* name) {
  return {name, [] { return std::make_unique<Stage>(); }};
}

}  // namespace

std::vector<StageMaker> every_stage() {
  return {stage<ForceDimensionStage>("force_dimension"), stage<TouchStage>("touch"),
          stage<VirtuoseStage>("virtuose"), stage<HaplyStage>("haply"), stage<NetworkStage>("network")};
}

}  // namespace tactum
