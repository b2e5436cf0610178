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

#include "support/task_count.h"
#include "tactum/base/random.h"
#include "web_peer.h"

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

/// Over which of the two a device joins.
enum class Over { kUdp, kWebSocket };

/// A peer on a bare socket, or on a WebSocket, and the port that it speaks to.
class Peer {
 public:
  explicit Peer(Over over = Over::kUdp) : over_(over), socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    theirs_.sin_family = AF_INET;
    theirs_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    theirs_.sin_port = htons(static_cast<std::uint16_t>(free_network_port()));
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
    if (over_ == Over::kWebSocket)
      web_.send(bytes);
    else
      ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&theirs_), sizeof theirs_);
  }
  /// Says hello, and from `silent_s` on answers each command after `delay_s`, in a thread, until
  /// stop_answering().
  void answer(double delay_s, std::uint16_t version = 1, double silent_s = 0.0) {
    thread_ = std::thread([=, this] { run(delay_s, version, silent_s); });
  }
  void stop_answering() {
    ends_ = true;
    thread_.join();
  }
  std::uint32_t states() const { return states_; }
  /// While nothing is answered.
  WebPeer& web() { return web_; }

 private:
  /// The next packet; empty when none is there.
  Bytes take() {
    if (over_ == Over::kWebSocket) return web_.take().value_or(Bytes{});
    Bytes bytes(256);
    const ssize_t size = ::recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return bytes;
  }
  void run(double delay_s, std::uint16_t version, double silent_s) {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](double s) {
      return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
    };
    const Clock::time_point answers_from = Clock::now() + seconds(silent_s);
    std::deque<std::pair<Clock::time_point, std::uint32_t>> due;
    Clock::time_point hello_at{};
    while (!ends_) {
      if (over_ == Over::kWebSocket && !web_.is_open()) web_.connect(port());
      if (Clock::now() - hello_at > std::chrono::milliseconds(50)) {
        send(hello(version));
        hello_at = Clock::now();
      }
      const Bytes bytes = take();
      if (bytes.size() == kCommandBytes && get<std::uint16_t>(bytes, 6) == 4 && Clock::now() >= answers_from)
        due.emplace_back(Clock::now() + seconds(delay_s), get<std::uint32_t>(bytes, 12));
      while (!due.empty() && due.front().first <= Clock::now()) {
        const std::uint32_t sequence = ++states_;
        send(state(sequence, 1e-3 * sequence, due.front().second, 0.0, 0.0));
        due.pop_front();
      }
      if (bytes.empty()) std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }

  Over over_;
  int socket_;
  WebPeer web_;
  sockaddr_in theirs_{};
  std::atomic<bool> ends_{false};
  std::atomic<std::uint32_t> states_{0};
  std::thread thread_;
};

NetworkDeviceOptions at(const Peer& peer, double wait_for_hello_s = 10.0) {
  NetworkDeviceOptions options;
  options.wait_for_hello_s = wait_for_hello_s;
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

class NetworkDeviceOver : public ::testing::TestWithParam<Over> {};
INSTANTIATE_TEST_SUITE_P(Each, NetworkDeviceOver, ::testing::Values(Over::kUdp, Over::kWebSocket),
                         [](const ::testing::TestParamInfo<Over>& info) {
                           return info.param == Over::kUdp ? "Udp" : "WebSocket";
                         });

/// Reads until a state has come that is newer than the last sample; what is on the way of a machine to itself
/// may take a moment.
bool reads_newer(Device& device, double now_s, DeviceSample& sample) {
  const double last_m = sample.X_DH.p.x();
  return comes_true([&] { return device.read(now_s, sample) && sample.X_DH.p.x() != last_m; });
}

TEST_P(NetworkDeviceOver, TheHelloTellsItsAbilities) {
  Peer peer(GetParam());
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

TEST_P(NetworkDeviceOver, TheDelayOfTheWayIsMeasured) {
  for (const double delay_s : {0.0, 0.010}) {
    Peer peer(GetParam());
    peer.answer(delay_s);
    Result<std::unique_ptr<Device>> device = Error{};
    ASSERT_TRUE(comes_true([&] {  // a machine that is busy may make the way too long
      device = NetworkDevice::connect(at(peer));
      return static_cast<bool>(device);
    })) << device.error().message();
    EXPECT_GE((*device)->info().handle.delay_s, delay_s + 0.0005) << "the way, and what the device told";
  }
}

TEST_P(NetworkDeviceOver, WhatIsLateTwiceOrNonsenseIsDropped) {
  Peer peer(GetParam());
  const std::unique_ptr<Device> device = opened(peer);
  ASSERT_TRUE(device);
  DeviceSample sample;
  const std::uint32_t first = peer.states() + 1;
  peer.send(state(first + 2, 1.0, 0, 0.0, 0.012));
  ASSERT_TRUE(reads_newer(*device, 0.1, sample));
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
  ASSERT_TRUE(reads_newer(*device, 0.2, sample));
  EXPECT_EQ(sample.X_DH.p.x(), 0.02);
}

/// The times of samples are as far apart as those of the device's clock, whatever jitter the way has.
TEST_P(NetworkDeviceOver, JitterOfTheWayDoesNotReachTheTimeStamps) {
  Peer peer(GetParam());
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
    peer.send(state(peer.states() + 1 + i, kDeviceBegan_s + measured_s, 0, 0.0, 0.001 * (i + 1)));
    ASSERT_TRUE(reads_newer(*device, measured_s + trip_s, sample));
    if (i > 0) largest_s = std::max(largest_s, std::abs(sample.time_s - last_s - 0.001));
    EXPECT_NEAR(sample.time_s, measured_s + kLeastTrip_s, 1e-9);
    last_s = sample.time_s;
  }
  EXPECT_LT(largest_s, 1e-9);
}

TEST_P(NetworkDeviceOver, SilenceMakesTheSampleInvalidAndEndsWithTheNextState) {
  Peer peer(GetParam());
  const std::unique_ptr<Device> device = opened(peer);
  ASSERT_TRUE(device);
  DeviceSample sample;
  peer.send(state(peer.states() + 1, 1.0, 0, 0.0, 0.01));
  ASSERT_TRUE(reads_newer(*device, 0.1, sample));
  std::this_thread::sleep_for(std::chrono::milliseconds(25));
  EXPECT_FALSE(device->read(0.2, sample));
  EXPECT_FALSE(sample.valid);
  EXPECT_TRUE(device->write({})) << "it may come back";
  peer.send(state(peer.states() + 2, 1.1, 0, 0.0, 0.02));
  EXPECT_TRUE(reads_newer(*device, 0.2, sample));
}

TEST(NetworkDevice, AMessageMayComeInPiecesWithPingsBetween) {
  Peer peer(Over::kWebSocket);
  const std::unique_ptr<Device> device = opened(peer);
  ASSERT_TRUE(device);
  DeviceSample sample;
  std::uint32_t sequence = peer.states();
  for (const std::size_t piece : {8, 50, 125, 126, 207, 0}) {
    peer.web().ping("are you there");
    peer.web().send(state(++sequence, 1.0, 0, 0.0, 0.001 * static_cast<double>(piece + 1)), piece);
    ASSERT_TRUE(reads_newer(*device, 0.1, sample)) << piece;
    EXPECT_EQ(sample.X_DH.p.x(), 0.001 * static_cast<double>(piece + 1));
  }
  EXPECT_TRUE(comes_true([&] {
    device->write({});
    peer.web().take();
    return peer.web().pongs() == 6;
  }));
}

/// The end of the connection is known at once, and not only after a silence.
TEST(NetworkDevice, WhatBreaksTheProtocolOfWebSocketsEndsTheRun) {
  const std::string masked_text("\x81\x81\0\0\0\0x", 7), unmasked("\x82\x01x", 3);
  const std::string reserved("\xc2\x81\0\0\0\0x", 7), other_kind("\x83\x81\0\0\0\0x", 7);
  const std::string goes_on_with_nothing("\x80\x81\0\0\0\0x", 7);
  const std::string long_ping = std::string("\x89\xfe\x00\x80\0\0\0\0", 8) + std::string(128, 'p');
  const std::string ping_in_pieces("\x09\x81\0\0\0\0x", 7);
  const std::string huge("\x82\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14);
  const std::string too_long = std::string("\x82\xfe\x04\x01\0\0\0\0", 8) + std::string(1025, 'm');
  const std::string piece = std::string("\x02\xfe\x03\x00\0\0\0\0", 8) + std::string(768, 'm');
  const std::string more = std::string("\x80\xfe\x03\x00\0\0\0\0", 8) + std::string(768, 'm');
  const std::string goodbye("\x88\x82\0\0\0\0\x03\xe8", 8);
  const std::string new_within_another = std::string("\x02\x81\0\0\0\0x", 7) + unmasked;
  for (const std::string& bytes :
       {masked_text, unmasked, reserved, other_kind, goes_on_with_nothing, long_ping, ping_in_pieces, huge,
        too_long, piece + more, goodbye, new_within_another}) {
    Peer peer(Over::kWebSocket);
    const std::unique_ptr<Device> device = opened(peer);
    ASSERT_TRUE(device);
    peer.send(state(peer.states() + 1, 1.0, 0, 0.0, 0.01));
    DeviceSample sample;
    ASSERT_TRUE(reads_newer(*device, 0.1, sample));
    peer.web().send_raw(bytes);
    EXPECT_TRUE(comes_true([&] {
      device->read(0.1, sample);
      return !device->write({});
    })) << bytes.substr(0, 8);
    EXPECT_FALSE(sample.valid);
    EXPECT_NE(device->trouble(), "");
  }
}

/// A client that takes nothing is not waited for; when it takes again, it gets whole messages.
TEST(NetworkDevice, AClientThatTakesNothingLosesMessagesAsWholes) {
  Peer peer(Over::kWebSocket);
  const std::unique_ptr<Device> device = opened(peer);
  ASSERT_TRUE(device);
  constexpr int kFar = 100'000;  // 7 MB: more than the system keeps
  std::uint32_t sent = 0;
  for (int i = 0; i < kFar; ++i) {
    if (i % 5000 == 0) {
      peer.send(state(peer.states() + 1 + ++sent, 1.0, 0, 0.0, 0.01));
      DeviceSample sample;
      device->read(0.1, sample);
    }
    ASSERT_TRUE(device->write({{1e-6 * i, 0, 0}, {0, 0, 0}})) << i;
  }
  double last_N = -1.0;
  int taken = 0;
  while (const std::optional<Bytes> bytes = peer.web().take()) {
    ASSERT_EQ(get<std::uint32_t>(*bytes, 0), kMagic);
    if (get<std::uint16_t>(*bytes, 6) == 2) continue;  // the welcome of a second hello
    ASSERT_EQ(bytes->size(), kCommandBytes);
    const auto force_N = get<double>(*bytes, 24);
    EXPECT_GE(force_N, last_N);
    last_N = force_N;
    ++taken;
  }
  EXPECT_GT(taken, 10);
  EXPECT_LT(taken, kFar / 2) << "the rest is lost, and not late";
  ASSERT_TRUE(device->write({{7.0, 0, 0}, {0, 0, 0}}));
  ASSERT_TRUE(comes_true([&] {
    device->write({{7.0, 0, 0}, {0, 0, 0}});
    const std::optional<Bytes> bytes = peer.web().take();
    return bytes && get<double>(*bytes, 24) == 7.0;
  }));
}

TEST(NetworkDevice, OnlyPagesOfThisMachineAreLetIn) {
  const auto refusal_of = [](const std::string& origin) {
    const int port = free_network_port();
    WebSocketLink link;
    EXPECT_TRUE(link.listen("127.0.0.1", port));
    std::atomic<bool> ends{false};
    std::thread serves([&] {
      while (!ends) link.serve();
    });
    WebPeer page;
    EXPECT_EQ(page.connect(port, origin), is_own_origin(origin, "127.0.0.1"));
    ends = true;
    serves.join();
    return link.last_refusal();
  };
  for (const char* own : {"", "http://localhost", "http://127.0.0.1:8000", "https://[::1]:1"})
    EXPECT_EQ(refusal_of(own), "") << own;
  for (const char* foreign : {"http://localhost.example.org", "https://example.org", "null", "file://",
                              "http://127.0.0.1.example.org:80", "localhost", "http://example.org#localhost"})
    EXPECT_TRUE(refusal_of(foreign).starts_with("403")) << foreign;
  EXPECT_TRUE(is_own_origin("http://192.168.1.5:8080", "192.168.1.5"));
  EXPECT_FALSE(is_own_origin("http://192.168.1.6:8080", "192.168.1.5"));
}

TEST(NetworkDevice, ARefusedPageIsTold) {
  Peer peer;
  NetworkDeviceOptions options = at(peer);
  options.wait_for_hello_s = 1.0;
  std::atomic<bool> ends{false};
  std::thread pages([&] {
    while (!ends) WebPeer().connect(peer.port(), "https://example.org");
  });
  const Result<std::unique_ptr<Device>> device = NetworkDevice::connect(options);
  ends = true;
  pages.join();
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().message().find("403 Only Pages Of This Machine"), std::string::npos)
      << device.error().message();
}

/// A client that greets slowly, or never, or says nothing, keeps no device out.
TEST(NetworkDevice, AnIdleConnectionGivesWay) {
  Peer peer(Over::kWebSocket);
  NetworkDeviceOptions options = at(peer);
  Result<std::unique_ptr<Device>> device = Error{};
  std::thread waits([&] { device = NetworkDevice::connect(options); });
  WebPeer idle;
  EXPECT_TRUE(comes_true([&] { return idle.connect(peer.port()); }));
  peer.answer(0.0);
  waits.join();
  ASSERT_TRUE(device) << device.error().message();
  EXPECT_TRUE(comes_true([&] {
    idle.take();
    return !idle.is_open();
  })) << "and is told";
}

/// While one device is there, no other is let in; a device over UDP closes the door for WebSockets.
TEST(NetworkDevice, OneDeviceAtATime) {
  for (const Over over : {Over::kUdp, Over::kWebSocket}) {
    Peer peer(over);
    peer.answer(0.0);
    const Result<std::unique_ptr<Device>> first = NetworkDevice::connect(at(peer));
    ASSERT_TRUE(first) << first.error().message();
    WebPeer second;
    EXPECT_FALSE(second.connect(peer.port()));
  }
}

TEST(NetworkDevice, ThatAnswersLateAtFirstIsAskedAgain) {
  for (const Over over : {Over::kUdp, Over::kWebSocket}) {
    Peer peer(over);
    peer.answer(0.0, 1, 0.5);
    const Result<std::unique_ptr<Device>> device = NetworkDevice::connect(at(peer));
    ASSERT_TRUE(device) << device.error().message();
  }
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
    expect(at(peer, 0.01), {"no device says hello", "nothing", "docs/devices/network.md"});
  }
  {
    Peer peer;
    peer.answer(0.0, 2);
    expect(at(peer, 0.3), {"no device says hello", "version 2 of the protocol"});
  }
  {
    Peer peer;
    peer.answer(0.0, 1, 3600.0);
    expect(at(peer, 0.3), {"does not answer in time", "0 answers"});
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
