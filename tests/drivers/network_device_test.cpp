// The protocol of network devices, byte by byte, with a peer that does not use the header of the protocol.

#include "tactum/drivers/network_device.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <deque>
#include <limits>
#include <thread>

#include "tactum/base/random.h"

namespace tactum::network_test {

using Bytes = std::vector<unsigned char>;

template <class T>
void put(Bytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}
template <class T>
T get(const Bytes& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

constexpr std::uint32_t kMagic = 0x44486354, kSession = 77;
constexpr std::size_t kHelloBytes = 208, kStateBytes = 208, kCommandBytes = 72;

Bytes datagram(std::size_t size, std::uint16_t kind, std::uint32_t sequence, std::uint16_t version = 1) {
  Bytes bytes(size);
  put(bytes, 0, kMagic);
  put(bytes, 4, version);
  put(bytes, 6, kind);
  put(bytes, 8, kSession);
  put(bytes, 12, sequence);
  return bytes;
}

Bytes hello(std::uint16_t version = 1) {
  Bytes bytes = datagram(kHelloBytes, 1, 1, version);
  put(bytes, 16, std::uint32_t{7});  // senses rotation, actuates force and torque
  const double numbers[] = {9.0, 0.25, 1500.0, 0.8, 0.07, 500.0, 0.2, 0.001, 1.5, 0.02, 0.0005};
  for (std::size_t i = 0; i < std::size(numbers); ++i) put(bytes, 24 + 8 * i, numbers[i]);
  std::memcpy(bytes.data() + 112, "arm\n 3", 6);
  std::memcpy(bytes.data() + 176, "AB-12", 5);
  return bytes;
}

Bytes state(std::uint32_t sequence, double time_s, std::uint32_t answers, double since_s, double x_m) {
  Bytes bytes = datagram(kStateBytes, 3, sequence);
  put(bytes, 16, time_s);
  put(bytes, 24, since_s);
  put(bytes, 32, answers);
  put(bytes, 40, x_m);
  put(bytes, 64, 1.0);                // the quaternion's w
  put(bytes, 200, std::uint32_t{5});  // buttons
  return bytes;
}

/// A peer on a bare socket, and the port that it speaks to.
class Peer {
 public:
  Peer() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in ours{};
    ours.sin_family = AF_INET;
    ours.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int probe = ::socket(AF_INET, SOCK_DGRAM, 0);
    ::bind(probe, reinterpret_cast<sockaddr*>(&ours), sizeof ours);
    socklen_t size = sizeof theirs_;
    ::getsockname(probe, reinterpret_cast<sockaddr*>(&theirs_), &size);
    ::close(probe);
  }
  ~Peer() {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
    ::close(socket_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  int port() const { return ntohs(theirs_.sin_port); }
  void send(const Bytes& bytes) {
    ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&theirs_), sizeof theirs_);
  }
  /// Says hello and answers each command after `delay_s`, in a thread, as long as answers() is asked for.
  void answer(double delay_s, std::uint16_t version = 1, bool answers = true) {
    thread_ = std::thread([=, this] { run(delay_s, version, answers); });
  }
  void stop_answering() {
    ends_ = true;
    thread_.join();
  }
  std::uint32_t states() const { return states_; }

 private:
  void run(double delay_s, std::uint16_t version, bool answers) {
    using Clock = std::chrono::steady_clock;
    std::deque<std::pair<Clock::time_point, std::uint32_t>> due;
    Clock::time_point hello_at{};
    while (!ends_) {
      if (Clock::now() - hello_at > std::chrono::milliseconds(50)) {
        send(hello(version));
        hello_at = Clock::now();
      }
      Bytes bytes(256);
      const ssize_t size = ::recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (size == static_cast<ssize_t>(kCommandBytes) && get<std::uint16_t>(bytes, 6) == 4 && answers)
        due.emplace_back(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                            std::chrono::duration<double>(delay_s)),
                         get<std::uint32_t>(bytes, 12));
      while (!due.empty() && due.front().first <= Clock::now()) {
        const std::uint32_t sequence = ++states_;
        send(state(sequence, 1e-3 * sequence, due.front().second, 0.0, 0.0));
        due.pop_front();
      }
      if (size < 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }

  int socket_;
  sockaddr_in theirs_{};
  std::atomic<bool> ends_{false};
  std::atomic<std::uint32_t> states_{0};
  std::thread thread_;
};

NetworkDeviceOptions at(const Peer& peer) {
  NetworkDeviceOptions options;
  options.port = peer.port();
  options.stale_after_s = 3600.0;
  return options;
}

/// Connected, open, and answering no more: the test sends each state itself.
std::unique_ptr<Device> opened(Peer& peer) {
  peer.answer(0.0);
  Result<std::unique_ptr<Device>> device = NetworkDevice::connect(at(peer));
  EXPECT_TRUE(device) << device.error().message();
  if (!device) return nullptr;
  peer.stop_answering();
  EXPECT_TRUE((*device)->open());
  DeviceSample ignored;
  (*device)->read(0.0, ignored);
  return std::move(*device);
}

TEST(NetworkDevice, TheHelloTellsItsAbilities) {
  Peer peer;
  peer.answer(0.0);
  const Result<std::unique_ptr<Device>> device = NetworkDevice::connect(at(peer));
  ASSERT_TRUE(device) << device.error().message();
  const DeviceInfo& info = (*device)->info();
  EXPECT_EQ(info.name, "network arm 3") << "without what cannot be printed";
  EXPECT_EQ(info.serial, "AB-12");
  EXPECT_TRUE(info.senses_rotation && info.actuates_force && info.actuates_torque);
  EXPECT_EQ(info.max_force_N, 9.0);
  EXPECT_EQ(info.max_torque_Nm, 0.25);
  EXPECT_EQ(info.max_stiffness_N_per_m, 1500.0);
  EXPECT_EQ(info.max_stiffness_Nm_per_rad, 0.8);
  EXPECT_EQ(info.workspace_radius_m, 0.07);
  EXPECT_EQ(info.rate_Hz, 500.0);
  EXPECT_EQ(info.handle.mass_kg, 0.2);
  EXPECT_EQ(info.handle.inertia_kg_m2, 0.001);
  EXPECT_EQ(info.handle.damping_Ns_per_m, 1.5);
  EXPECT_EQ(info.handle.damping_Nms_per_rad, 0.02);
}

TEST(NetworkDevice, TheDelayOfTheWayIsMeasured) {
  for (const double delay_s : {0.0, 0.010}) {
    Peer peer;
    peer.answer(delay_s);
    const Result<std::unique_ptr<Device>> device = NetworkDevice::connect(at(peer));
    ASSERT_TRUE(device) << device.error().message();
    EXPECT_GE((*device)->info().handle.delay_s, delay_s + 0.0005) << "the way, and what the device told";
  }
}

TEST(NetworkDevice, WhatIsLateTwiceOrNonsenseIsDropped) {
  Peer peer;
  const std::unique_ptr<Device> device = opened(peer);
  ASSERT_TRUE(device);
  DeviceSample sample;
  const std::uint32_t first = peer.states() + 1;
  peer.send(state(first + 2, 1.0, 0, 0.0, 0.012));
  ASSERT_TRUE(device->read(0.1, sample));
  EXPECT_EQ(sample.X_DH.p.x(), 0.012);
  EXPECT_EQ(sample.buttons, 5u);
  peer.send(state(first + 1, 0.9, 0, 0.0, 0.033));  // overtaken
  peer.send(state(first + 2, 1.0, 0, 0.0, 0.033));  // twice
  Bytes other = state(first + 3, 1.0, 0, 0.0, 0.033);
  put(other, 8, std::uint32_t{kSession + 1});  // of another run of the device
  peer.send(other);
  Bytes newer = state(first + 3, 1.0, 0, 0.0, 0.033);
  put(newer, 4, std::uint16_t{2});
  peer.send(newer);
  peer.send(state(first + 3, std::numeric_limits<double>::quiet_NaN(), 0, 0.0, 0.033));
  for (const int more : {-8, 8}) {
    Bytes other_size = state(first + 3, 1.0, 0, 0.0, 0.033);
    other_size.resize(kStateBytes + static_cast<std::size_t>(more));
    peer.send(other_size);
  }
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    Bytes nonsense = state(first + 10, 1.0, 0, 0.0, 0.033);
    nonsense.resize(1 + static_cast<std::size_t>(random.uniform(0.0, 300.0)));
    for (unsigned char& byte : nonsense) byte = static_cast<unsigned char>(random.uniform(0.0, 256.0));
    peer.send(nonsense);
  }
  for (int i = 0; i < 10; ++i) device->read(0.101 + 0.001 * i, sample);
  EXPECT_EQ(sample.X_DH.p.x(), 0.012);
  peer.send(state(first + 11, 1.1, 0, 0.0, 0.02));
  ASSERT_TRUE(device->read(0.2, sample));
  EXPECT_EQ(sample.X_DH.p.x(), 0.02);
}

/// The times of samples are as far apart as those of the device's clock, whatever jitter the way has.
TEST(NetworkDevice, JitterOfTheWayDoesNotReachTheTimeStamps) {
  Peer peer;
  const std::unique_ptr<Device> device = opened(peer);
  ASSERT_TRUE(device);
  Random random(5);
  DeviceSample sample;
  double last_s = 0.0, largest_s = 0.0;
  constexpr double kDeviceBegan_s = 5000.0, kLeastTrip_s = 0.0004;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const double measured_s = 0.001 * i;
    // The way takes its least time now and then, from the first on.
    const double trip_s = kLeastTrip_s + (i % 10 == 0 ? 0.0 : random.uniform(0.0, 0.005));
    peer.send(state(peer.states() + 1 + i, kDeviceBegan_s + measured_s, 0, 0.0, 0.001 * i));
    ASSERT_TRUE(device->read(measured_s + trip_s, sample));
    if (i > 0) largest_s = std::max(largest_s, std::abs(sample.time_s - last_s - 0.001));
    EXPECT_NEAR(sample.time_s, measured_s + kLeastTrip_s, 1e-9);
    last_s = sample.time_s;
  }
  EXPECT_LT(largest_s, 1e-9);
}

TEST(NetworkDevice, SilenceMakesTheSampleInvalidAndEndsWithTheNextState) {
  Peer peer;
  const std::unique_ptr<Device> device = opened(peer);
  ASSERT_TRUE(device);
  DeviceSample sample;
  peer.send(state(peer.states() + 1, 1.0, 0, 0.0, 0.01));
  ASSERT_TRUE(device->read(0.1, sample));
  std::this_thread::sleep_for(std::chrono::milliseconds(25));
  EXPECT_FALSE(device->read(0.2, sample));
  EXPECT_FALSE(sample.valid);
  EXPECT_TRUE(device->write({})) << "it may come back";
  peer.send(state(peer.states() + 2, 1.1, 0, 0.0, 0.01));
  EXPECT_TRUE(device->read(0.2, sample));
}

TEST(NetworkDevice, WhatIsWrongIsToldWithItsCure) {
  const auto expect = [](const NetworkDeviceOptions& options, std::initializer_list<const char*> words) {
    const Result<std::unique_ptr<Device>> device = NetworkDevice::connect(options);
    ASSERT_FALSE(device);
    for (const char* each : words)
      EXPECT_NE(device.error().message().find(each), std::string::npos) << device.error().message();
  };
  {
    Peer peer;
    NetworkDeviceOptions options = at(peer);
    options.wait_for_hello_s = 0.01;
    expect(options, {"no device says hello", "nothing", "docs/devices/network.md"});
  }
  {
    Peer peer;
    peer.answer(0.0, 2);
    NetworkDeviceOptions options = at(peer);
    options.wait_for_hello_s = 0.3;
    expect(options, {"no device says hello", "version 2 of the protocol"});
  }
  {
    Peer peer;
    peer.answer(0.0, 1, false);
    expect(at(peer), {"does not answer in time", "0 answers"});
  }
  {
    Peer peer;
    peer.answer(0.0);
    const Result<std::unique_ptr<Device>> first = NetworkDevice::connect(at(peer));
    ASSERT_TRUE(first) << first.error().message();
    expect(at(peer), {"cannot listen for a device", "a port that no other program has"});
  }
  for (const char* argument : {"0", "65536", "x", "1.2.3.4:", "10 "})
    EXPECT_FALSE(network_device_options(argument)) << argument;
  const Result<NetworkDeviceOptions> both = network_device_options("0.0.0.0:4000");
  ASSERT_TRUE(both);
  EXPECT_EQ(both->address, "0.0.0.0");
  EXPECT_EQ(both->port, 4000);
  NetworkDeviceOptions nowhere;
  nowhere.address = "nowhere";
  expect(nowhere, {"this is no address", "127.0.0.1"});
}

}  // namespace tactum::network_test
