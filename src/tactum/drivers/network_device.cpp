#include "tactum/drivers/network_device.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>

#include "tactum/drivers/tactum_device.h"
#include "tactum/drivers/vendor_library.h"

namespace tactum::inline v0_1 {
namespace {

constexpr const char* kPlaceVariable = "TACTUM_NETWORK_DEVICE";
constexpr double kPings_s = 0.2;        // zero commands, before the device is opened [s]
constexpr int kLeastAnswers = 10;       // of them
constexpr double kFollowClock_s = 1.0;  // a second's least difference is kept for one more
constexpr double kMuchLonger = 2.0;     // of the delay that the gains know
constexpr double kLittle_s = 0.002;     // that is no matter [s]
constexpr double kLook_s = 0.1;         // a WebSocket that says nothing gives way so soon [s]
constexpr int kMostDatagramsPerRead = 64;

double steady_s() noexcept {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Vec3 vector_of(const double* v) noexcept { return {v[0], v[1], v[2]}; }

/// A number of the hello that may only be so large; what is not finite or negative counts as nothing.
double bounded(double value, double most) noexcept { return value > 0.0 ? std::min(value, most) : 0.0; }

/// A text of the hello: its printable characters up to the first zero.
template <std::size_t kSize>
std::string text_of(const char (&text)[kSize]) {
  std::string out;
  for (std::size_t i = 0; i < kSize && text[i] != '\0'; ++i)
    if (text[i] >= ' ' && text[i] <= '~') out += text[i];
  return out;
}

bool is_header(const std::vector<unsigned char>& bytes, tactum_wire_header& header) noexcept {
  if (bytes.size() < sizeof header) return false;
  std::memcpy(&header, bytes.data(), sizeof header);
  return header.magic == TACTUM_DEVICE_MAGIC;
}

DeviceInfo info_of(const tactum_device_info& said) {
  DeviceInfo info;
  const std::string name = text_of(said.name);
  info.name = "network " + (name.empty() ? "device" : name);
  info.serial = text_of(said.serial);
  info.is_hardware = true;
  info.senses_rotation = (said.flags & TACTUM_SENSES_ROTATION) != 0;
  info.actuates_force = (said.flags & TACTUM_ACTUATES_FORCE) != 0 && said.max_force_N > 0.0;
  info.actuates_torque = (said.flags & TACTUM_ACTUATES_TORQUE) != 0 && said.max_torque_Nm > 0.0;
  info.max_force_N = info.actuates_force ? bounded(said.max_force_N, NetworkDevice::kMostForce_N) : 0.0;
  info.max_torque_Nm =
      info.actuates_torque ? bounded(said.max_torque_Nm, NetworkDevice::kMostTorque_Nm) : 0.0;
  constexpr double kWeakWall_N_per_m = 400.0, kWeakWall_Nm_per_rad = 0.3;  // of a device that tells none
  const auto stiffest = [](bool actuates, double stated, double weak) {
    constexpr double kStiffest = 50'000.0;  // beyond it no hand-held device is stable
    return actuates ? (stated > 0.0 ? std::min(stated, kStiffest) : weak) : 0.0;
  };
  info.max_stiffness_N_per_m = stiffest(info.actuates_force, said.stiffest_N_per_m, kWeakWall_N_per_m);
  info.max_stiffness_Nm_per_rad =
      stiffest(info.actuates_torque, said.stiffest_Nm_per_rad, kWeakWall_Nm_per_rad);
  constexpr double kSmallWorkspace_m = 0.05;
  info.workspace_radius_m =
      said.workspace_radius_m > 0.0 ? bounded(said.workspace_radius_m, kFarthestHandle_m) : kSmallWorkspace_m;
  info.rate_Hz = said.rate_Hz > 0.0 ? bounded(said.rate_Hz, 100'000.0) : 1000.0;
  info.handle.mass_kg = bounded(said.mass_kg, 100.0);
  info.handle.inertia_kg_m2 = bounded(said.inertia_kg_m2, 10.0);
  info.handle.damping_Ns_per_m = bounded(said.damping_Ns_per_m, 1000.0);
  info.handle.damping_Nms_per_rad = bounded(said.damping_Nms_per_rad, 10.0);
  info.handle.delay_s = bounded(said.delay_s, 1.0);
  return info;
}

}  // namespace

Result<NetworkDeviceOptions> network_device_options(const std::string& argument) {
  NetworkDeviceOptions options;
  options.port = TACTUM_DEVICE_PORT;
  const std::string place = argument.empty() ? environment(kPlaceVariable) : argument;
  if (place.empty()) return options;
  const std::size_t colon = place.rfind(':');
  if (colon != std::string::npos) options.address = place.substr(0, colon);
  const std::string port = colon == std::string::npos ? place : place.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), options.port);
  if (error != std::errc() || end != port.data() + port.size() || options.port < 1 || options.port > 65535)
    return Error{"this is no port", "'" + port + "'", "network, network:PORT or network:ADDRESS:PORT",
                 argument.empty() ? kPlaceVariable : argument};
  return options;
}

Result<std::unique_ptr<Device>> NetworkDevice::connect(const NetworkDeviceOptions& options) {
  std::unique_ptr<NetworkDevice> device(new NetworkDevice(options));
  if (Result<void> connected = device->connect_once(); !connected) return connected.error();
  return std::unique_ptr<Device>(std::move(device));
}

DriverSurvey NetworkDevice::survey() {
  constexpr double kGlance_s = 0.25;  // a device says hello every 0.1 s
  DriverSurvey survey{"network", {}, ""};
  Result<NetworkDeviceOptions> options = network_device_options("");
  if (options) options->wait_for_hello_s = kGlance_s;
  const Result<std::unique_ptr<Device>> device =
      options ? connect(*options) : Result<std::unique_ptr<Device>>(options.error());
  if (device)
    survey.found.push_back({"network", (*device)->info(), ""});
  else
    survey.nothing = device.error().message();
  return survey;
}

Result<void> NetworkDevice::connect_once() {
  if (link_.is_listening()) return {};
  const double until_s = steady_s() + options_.wait_for_hello_s;
  Result<void> tried;  // how the last device answered that said hello
  for (;;) {
    if (Result<void> listening = link_.listen(options_.address, options_.port); !listening) return listening;
    if (const Result<void> met = wait_for_hello(until_s); !met) {
      link_.close();
      return tried ? met : tried;
    }
    tried = measure_delay();
    if (tried) return {};
    // It may say hello again: a page that has just been loaded answers late for a while.
    say(TACTUM_WIRE_BYE);
    link_.close();
  }
}

Result<void> NetworkDevice::wait_for_hello(double until_s) {
  std::vector<unsigned char> bytes(2048);
  std::string heard = "nothing";
  for (;;) {
    const double left_s = until_s - steady_s();
    if (left_s <= 0.0) break;
    link_.wait(static_cast<int>(1e3 * std::min(left_s, kLook_s)) + 1);
    link_.serve();
    if (!link_.last_refusal().empty()) heard = "a WebSocket that was refused: " + link_.last_refusal();
    bytes.resize(2048);
    const long size = link_.receive(bytes.data(), bytes.size());
    if (size < 0) continue;
    bytes.resize(static_cast<std::size_t>(size));
    if (Result<void> taken = take_hello(bytes); taken)
      return {};
    else
      heard = taken.error().found;
  }
  return Error{
      "no device says hello", heard,
      "a program that speaks the protocol of tactum_device.h and is started (docs/devices/network.md)",
      "network:" + options_.address + ":" + std::to_string(options_.port)};
}

Result<void> NetworkDevice::take_hello(const std::vector<unsigned char>& bytes) {
  tactum_wire_hello hello;
  if (!is_header(bytes, hello.header)) return Error{"", "a datagram of another protocol", "", ""};
  if (hello.header.version != TACTUM_DEVICE_VERSION)
    return Error{"", "version " + std::to_string(hello.header.version) + " of the protocol, not 1", "", ""};
  if (hello.header.kind != TACTUM_WIRE_HELLO || bytes.size() != sizeof hello)
    return Error{"", "a datagram that is no hello", "", ""};
  std::memcpy(&hello, bytes.data(), sizeof hello);
  session_ = hello.header.session;
  last_state_ = 0;
  commands_ = 0;
  last_answered_ = 0;
  round_trip_s_ = round_trip_before_s_ = 0.0;
  has_offset_ = false;
  gone_ = false;
  newest_ = {};
  info_ = info_of(hello.info);
  gate_ = CommandGate(info_);
  link_.answer_last();
  say(TACTUM_WIRE_WELCOME);
  return {};
}

/// A command of zero each millisecond, and what the device says of when they came.
Result<void> NetworkDevice::measure_delay() {
  int answers = 0;
  std::uint32_t answered = 0;
  for (const double until_s = steady_s() + kPings_s; steady_s() < until_s;) {
    send({});
    link_.wait(1);
    drain(steady_s());
    if (last_answered_ != answered) ++answers;
    answered = last_answered_;
  }
  if (answers < kLeastAnswers)
    return Error{"the device does not answer in time",
                 std::to_string(answers) + " answers in " + std::to_string(kPings_s) + " s",
                 "a state for each command, at " + std::to_string(static_cast<int>(info_.rate_Hz)) + " Hz",
                 info_.name};
  const double round_trip_s = std::max(round_trip_s_, round_trip_before_s_);
  if (round_trip_s > kLongestDelay_s)
    return Error{"the way to the device is too long", std::to_string(1e3 * round_trip_s) + " ms",
                 "at most " + std::to_string(1e3 * kLongestDelay_s) + " ms there and back", info_.name};
  info_.handle.delay_s += round_trip_s;
  return {};
}

Result<void> NetworkDevice::open() {
  if (is_open_) return {};
  if (Result<void> connected = connect_once(); !connected) return connected;
  has_offset_ = false;  // the loop's clock begins now
  newest_.time_s = 0.0;
  heard_s_ = steady_s();
  if (Result<void> guarded = guard_.start(options_.stale_after_s, [this] { rest(); }); !guarded)
    return guarded;
  send({});
  is_open_ = true;
  return {};
}

void NetworkDevice::close() noexcept {
  guard_.stop();
  if (link_.is_listening()) {
    if (is_open_) send({});
    say(TACTUM_WIRE_BYE);
  }
  link_.close();
  is_open_ = false;
}

void NetworkDevice::say(int kind) noexcept {
  const tactum_wire_header header{TACTUM_DEVICE_MAGIC, TACTUM_DEVICE_VERSION,
                                  static_cast<std::uint16_t>(kind), session_, 0};
  link_.send(&header, sizeof header);
}

/// From the loop's thread and the guard's.
void NetworkDevice::send(const Wrench& F_D) noexcept {
  tactum_wire_command command{};
  const std::uint32_t sequence = ++commands_;
  command.header = {TACTUM_DEVICE_MAGIC, TACTUM_DEVICE_VERSION, TACTUM_WIRE_COMMAND, session_, sequence};
  command.time_s = steady_s();
  for (int i = 0; i < 3; ++i) {
    command.wrench[i] = F_D.f[i];
    command.wrench[3 + i] = F_D.t[i];
  }
  sent_s_[sequence % kRemembered].store(command.time_s, std::memory_order_relaxed);
  link_.send(&command, sizeof command);
}

/// While the loop is silent. A device that waits until its states are taken would not see that it is to rest.
void NetworkDevice::rest() noexcept {
  send({});
  if (link_.discard()) heard_s_ = steady_s();
}

/// Takes what has come; false when the device has said goodbye.
bool NetworkDevice::drain(double now_s) noexcept {
  for (int n = 0; n < kMostDatagramsPerRead; ++n) {
    tactum_wire_state state;
    const long size = link_.receive(&state, sizeof state);
    if (size < 0) break;
    if (size < static_cast<long>(sizeof state.header) || state.header.magic != TACTUM_DEVICE_MAGIC ||
        state.header.version != TACTUM_DEVICE_VERSION || state.header.session != session_)
      continue;
    if (state.header.kind == TACTUM_WIRE_HELLO) say(TACTUM_WIRE_WELCOME);  // our first was lost
    if (state.header.kind == TACTUM_WIRE_BYE) gone_ = true;
    if (state.header.kind == TACTUM_WIRE_STATE && size == static_cast<long>(sizeof state))
      take_state(state, now_s);
  }
  if (link_.has_ended()) gone_ = true;
  return !gone_;
}

void NetworkDevice::take_state(const tactum_wire_state& state, double now_s) noexcept {
  if (state.header.sequence <= last_state_) return;  // overtaken on its way
  if (!std::isfinite(state.time_s) || !std::isfinite(state.since_command_s)) return;
  last_state_ = state.header.sequence;
  heard_s_ = steady_s();
  measure_round_trip(state);
  const tactum_device_state& said = state.state;
  newest_.time_s = dated(state.time_s, now_s);
  newest_.X_DH.p = vector_of(said.position);
  const double* q = said.orientation_wxyz;
  newest_.X_DH.R = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  newest_.V_DH = {vector_of(said.velocity), vector_of(said.velocity + 3)};
  newest_.has_velocity =
      (said.flags & TACTUM_HAS_VELOCITY) != 0 && newest_.V_DH.v.allFinite() && newest_.V_DH.w.allFinite();
  newest_.motors_on = (said.flags & TACTUM_MOTORS_OFF) == 0;
  newest_.F_D_delivered = {vector_of(said.delivered), vector_of(said.delivered + 3)};
  newest_.has_delivered = (said.flags & TACTUM_HAS_DELIVERED) != 0 && newest_.F_D_delivered.finite();
  newest_.buttons = said.buttons;
  newest_.grip_rad = std::isfinite(said.grip_rad) ? said.grip_rad : 0.0;
}

/// The way there and back of a command that is answered for the first time.
void NetworkDevice::measure_round_trip(const tactum_wire_state& state) noexcept {
  const std::uint32_t answered = state.last_command, newest = commands_;
  if (answered == 0 || answered == last_answered_ || answered > newest || newest - answered >= kRemembered)
    return;
  last_answered_ = answered;
  const double round_trip_s =
      heard_s_ - sent_s_[answered % kRemembered].load(std::memory_order_relaxed) - state.since_command_s;
  if (heard_s_ - round_trip_from_s_ > kFollowClock_s) {
    round_trip_before_s_ = round_trip_s_;
    round_trip_s_ = 0.0;
    round_trip_from_s_ = heard_s_;
  }
  round_trip_s_ = std::max(round_trip_s_, round_trip_s);
}

double NetworkDevice::dated(double device_s, double now_s) noexcept {
  const double offset_s = now_s - device_s;
  if (!has_offset_) {
    offset_s_ = offset_before_s_ = offset_s;
    offset_from_s_ = now_s;
    has_offset_ = true;
  }
  if (now_s - offset_from_s_ > kFollowClock_s) {
    offset_before_s_ = offset_s_;
    offset_s_ = offset_s;
    offset_from_s_ = now_s;
  }
  offset_s_ = std::min(offset_s_, offset_s);
  return std::max(newest_.time_s, device_s + std::min(offset_s_, offset_before_s_));
}

/// How long nothing has come [s]; after kDead_s the device is gone.
double NetworkDevice::silence_s() noexcept {
  const double silence_s = steady_s() - heard_s_;
  if (silence_s > kDead_s) gone_ = true;
  return silence_s;
}

bool NetworkDevice::read(double now_s, DeviceSample& sample) noexcept {
  if (!is_open_) {
    sample.valid = false;
    return false;
  }
  drain(now_s);
  sample = newest_;
  sample.valid = last_state_ != 0 && silence_s() <= kSilent_s && !gone_ && plausible(newest_.X_DH);
  return sample.valid;
}

bool NetworkDevice::write(const Wrench& F_D) noexcept {
  if (!is_open_ || silence_s() > kDead_s || gone_) return false;
  Wrench sent;
  const bool finite = gate_.pass(F_D, sent);
  const bool taken = guard_.on_time() && finite;
  send(taken ? sent : Wrench{});
  return taken;
}

std::string NetworkDevice::trouble() const {
  if (gone_) return "the device does not answer any more: start its program again, and look at the network";
  const double round_trip_s = std::max(round_trip_s_, round_trip_before_s_);
  if (round_trip_s > kMuchLonger * info_.handle.delay_s + kLittle_s)
    return "the way to the device has become longer than the gains were chosen for (" +
           std::to_string(static_cast<int>(1e3 * round_trip_s)) + " ms): use a cable, and start anew";
  return "";
}

}  // namespace tactum::inline v0_1
