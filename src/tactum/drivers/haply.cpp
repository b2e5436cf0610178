#include "tactum/drivers/haply.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <system_error>

#include "tactum/drivers/vendor_library.h"

namespace tactum::inline v0_1 {
namespace {

constexpr const char* kHaplyVariable = "TACTUM_HAPLY_SERVICE";
constexpr int kHaplyConnect_ms = 1000;  // to reach the service, and for its first message
constexpr int kHaplyAnswer_ms = 500;    // for the answer to a message; longer, and it counts as gone
constexpr int kSettingsAsked = 100;     // times that the settings are read back, until they are as wished
constexpr int kBetweenAsking_ms = 10;
constexpr const char* kTurnFill = "interpolated between readings of the grip, one reading late";

/// The service's axes in D, and back.
Vec3 haply_in_D(const Vec3& v) noexcept { return {-v.y(), v.x(), v.z()}; }
Vec3 to_haply(const Vec3& v) noexcept { return {v.y(), -v.x(), v.z()}; }

double haply_clock_s() noexcept {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The sphere within the workspace, of the maker's examples.
double haply_radius_m(const std::string& type) {
  constexpr double kInverse3_m = 0.10, kMinverse_m = 0.04;
  return type.starts_with("inverse3") ? kInverse3_m : kMinverse_m;
}

/// Whether what is set for the session holds. Services before 3.5 may not tell their filters.
bool holds_our_settings(const HaplyDeviceConfig& device) {
  constexpr double kRounding = 0.001;  // the service keeps floats
  const auto is = [](double reported, double wished) {
    return reported < 0.0 || std::abs(reported - wished) < kRounding;
  };
  return device.preset == kHaplyPreset && device.basis == kHaplyBasis &&
         is(device.gate_gain, kHaplyGateGain) && is(device.damping, kHaplyDamping);
}

std::string settings_sentence(const HaplyDeviceConfig& device) {
  return "preset '" + device.preset + "', basis '" + device.basis + "', force gate " +
         std::to_string(device.gate_gain) + ", damping " + std::to_string(device.damping);
}

std::string newtons(double force_N) {
  const std::string text = std::to_string(force_N);
  return text.substr(0, text.find('.') + 3) + " N";
}

}  // namespace

Result<HaplyOptions> haply_options(const std::string& argument) {
  HaplyOptions options;
  const std::size_t slash = argument.find('/');
  std::string place = argument.substr(0, slash);
  if (slash != std::string::npos) options.id = argument.substr(slash + 1);
  if (slash == std::string::npos && place.find(':') == std::string::npos) {
    options.id = place;
    place = "";
  }
  const bool named = !place.empty();
  if (!named) place = environment(kHaplyVariable);
  if (place.empty()) return options;
  const std::size_t colon = place.rfind(':');
  const std::string port = colon == std::string::npos ? "" : place.substr(colon + 1);
  options.host = place.substr(0, colon);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), options.port);
  if (error != std::errc() || end != port.data() + port.size() || options.port < 1 || options.port > 65535 ||
      options.host.empty())
    return Error{"this is no place of a service", "'" + place + "'",
                 "haply, haply:HOST:PORT, haply:ID or haply:HOST:PORT/ID", named ? argument : kHaplyVariable};
  return options;
}

Result<std::unique_ptr<Device>> HaplyDevice::connect(const HaplyOptions& options) {
  std::unique_ptr<HaplyDevice> device(new HaplyDevice(options));
  if (Result<void> connected = device->connect_once(); !connected) return connected.error();
  return std::unique_ptr<Device>(std::move(device));
}

DriverSurvey HaplyDevice::survey() {
  DriverSurvey survey{"haply", {}, ""};
  Result<HaplyOptions> options = haply_options("");
  if (!options) {
    survey.nothing = options.error().message();
    return survey;
  }
  HaplyDevice device(*options);
  if (const Result<void> connected = device.connect_once(); !connected) {
    survey.nothing = connected.error().message();
    return survey;
  }
  device.calibrated_ = device.state_.calibrated;
  device.ready_ = device.state_.ready;
  device.powered_ = device.state_.powered;
  survey.found.push_back({"haply:" + device.device_.id, device.info_, device.trouble()});
  return survey;
}

Result<void> HaplyDevice::connect_once() {
  if (socket_.is_open()) return {};
  ask_version();
  if (Result<void> reached = socket_.connect(options_.host, options_.port, kHaplyConnect_ms); !reached)
    return Error{
        "no service of Haply answers", reached.error().found,
        "Haply's Inverse Service, installed and started (systemctl start haply-inverse-service), or its "
        "place in haply:HOST:PORT or in TACTUM_HAPLY_SERVICE",
        place()};
  if (socket_.receive_text(answer_, kHaplyConnect_ms) != WebSocket::Came::kMessage) {
    socket_.close();
    return Error{"the service of Haply does not begin", "no list of devices", "one that runs: start it anew",
                 place()};
  }
  Result<HaplyDeviceConfig> found = haply_config(answer_, options_.id);
  if (found && !haply_state(answer_, *found, state_))
    found =
        Error{"the service does not tell where the handle is", found->id, "a device that is ready", place()};
  if (!found) {
    socket_.close();
    return found.error();
  }
  device_ = std::move(*found);
  report_abilities();
  return {};
}

/// Versions differ in the port that tells it.
void HaplyDevice::ask_version() {
  version_.clear();
  version_port_ = 0;
  for (const int port : {options_.port, options_.other_http_port}) {
    const Result<std::string> answer = http_get(options_.host, port, "/version", kHaplyConnect_ms);
    if (answer) version_ = haply_version(*answer);
    if (version_.empty()) continue;
    version_port_ = port;
    break;
  }
  as_vector_ = haply_takes_vector(version_);
}

void HaplyDevice::report_abilities() {
  info_.name =
      "haply " + (device_.type.empty() ? "device" : device_.type) + ", service " +
      (version_.empty() ? "of unknown version" : version_ + " of port " + std::to_string(version_port_));
  info_.serial = device_.id;
  info_.is_hardware = true;
  info_.senses_rotation = !device_.grip.empty();
  if (info_.senses_rotation) info_.rotation_fill = kTurnFill;
  info_.actuates_force = true;
  info_.max_force_N = kMostForce_N;
  info_.max_stiffness_N_per_m = kStiffness_N_per_m;
  info_.workspace_radius_m = haply_radius_m(device_.type);
  info_.handle.delay_s = kDelay_s;
}

/// Sends a message and takes its one answer; false when the service does not answer.
bool HaplyDevice::ask(const std::string& message, std::string& answer) {
  return socket_.send_text(message, kHaplyAnswer_ms) &&
         socket_.receive_text(answer, kHaplyAnswer_ms) == WebSocket::Came::kMessage;
}

/// Unknown words are passed over in silence by the service, so what was set is read back.
Result<void> HaplyDevice::configure() {
  bool answered = ask(haply_first_message(device_.id, as_vector_), answer_);
  HaplyDeviceConfig reported;
  for (int n = 0; n < kSettingsAsked && answered; ++n) {
    answered = ask(haply_config_request(device_.id, as_vector_), answer_);
    const Result<HaplyDeviceConfig> found = haply_config(answer_, device_.id);
    if (found) reported = *found;
    if (answered && found && holds_our_settings(reported)) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(kBetweenAsking_ms));
  }
  if (!answered)
    return Error{"the service of Haply does not answer", "", "one that runs: start it anew", place()};
  HaplyDeviceConfig wished;
  wished.preset = kHaplyPreset, wished.basis = kHaplyBasis;
  wished.gate_gain = kHaplyGateGain, wished.damping = kHaplyDamping;
  return Error{"the service does not take our settings", settings_sentence(reported),
               settings_sentence(wished), info_.name};
}

Result<void> HaplyDevice::start() {
  if (Result<void> configured = configure(); !configured) return configured;
  exchange_.start(CommandGate(info_), options_.stale_after_s);
  turn_rate_.start();
  turn_fill_.start();
  R_DH_ = Mat3::Identity();
  sent_before_ = Vec3::Zero();
  other_ticks_ = 0;
  other_force_ = false;
  answers_ = grip_reports_ = calibrated_ = ready_ = powered_ = true;
  state_ = {};
  ends_ = false;
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error& error) {
    return Error{"cannot start the thread that serves the device", error.what(), "", info_.name};
  }
  if (exchange_.served_twice()) return {};
  return Error{"the service of Haply does not answer", trouble(), "a state for each message", place()};
}

Result<void> HaplyDevice::open() {
  if (is_open_) return {};
  if (Result<void> connected = connect_once(); !connected) return connected;
  Result<void> started = start();
  is_open_ = static_cast<bool>(started);
  if (!started) close();
  return started;
}

void HaplyDevice::close() noexcept {
  if (is_open_) {
    exchange_.write({});
    exchange_.served_twice();  // so that the zero is sent
  }
  ends_ = true;
  if (thread_.joinable()) thread_.join();
  socket_.close();
  is_open_ = false;
}

/// Our thread: one tick a period, none made up for.
void HaplyDevice::run() noexcept {
  const auto period = std::chrono::nanoseconds(std::llround(options_.period_s * 1e9));
  auto next = std::chrono::steady_clock::now();
  while (!ends_ && tick()) {
    next = std::max(next + period, std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}

/// False when the device is lost.
bool HaplyDevice::tick() noexcept {
  const Vec3 F =
      state_.calibrated && state_.ready && state_.powered ? exchange_.command().f : Vec3(Vec3::Zero());
  answers_ = ask(haply_force_message(device_.id, as_vector_, to_haply(F)), answer_);
  DeviceSample& sample = exchange_.sample();
  const bool reported = answers_ && haply_state(answer_, device_, state_);
  if (reported) put_into(sample, state_);
  if (!reported || !plausible(sample.X_DH)) {
    exchange_.lose();
    return false;
  }
  look_at_delivered(F);
  exchange_.publish();
  return true;
}

void HaplyDevice::put_into(DeviceSample& sample, const HaplyDeviceState& state) noexcept {
  calibrated_ = state.calibrated;
  ready_ = state.ready;
  powered_ = state.powered;
  const auto& [w, x, y, z] = state.turn_wxyz;
  const Vec3 axis = haply_in_D({x, y, z});
  const Eigen::Quaterniond turn(w, axis.x(), axis.y(), axis.z());
  // A grip that sleeps, or tells zeros, leaves the part as it was turned last.
  const bool turned = state.has_turn && turn.norm() > 0.5;
  grip_reports_ = turned || device_.grip.empty();
  if (turned) R_DH_ = turn.normalized().toRotationMatrix();
  sample.X_DH = {R_DH_, haply_in_D(state.position)};
  sample.V_DH = {haply_in_D(state.velocity), Vec3::Zero()};
  if (!device_.grip.empty()) {
    sample.X_DH.R = turn_fill_.show(R_DH_);
    sample.V_DH.w = turn_rate_.add(sample.X_DH.R, haply_clock_s());
  }
  sample.has_velocity = true;
  sample.buttons = state.buttons;
  sample.motors_on = state.calibrated && state.ready && state.powered;
  sample.F_D_delivered = {haply_in_D(state.delivered), Vec3::Zero()};
  sample.has_delivered = true;
}

/// An answer may tell the force of the message before.
void HaplyDevice::look_at_delivered(const Vec3& sent) noexcept {
  const Vec3 delivered = haply_in_D(state_.delivered);
  const auto is_other = [&delivered](const Vec3& F) {
    return (delivered - F).norm() > std::max(kOtherBy_N, kOtherByFraction * F.norm());
  };
  other_ticks_ = is_other(sent) && is_other(sent_before_) ? other_ticks_ + 1 : 0;
  sent_before_ = sent;
  if (other_ticks_ != kOtherForTicks || other_force_) return;
  other_sent_N_ = sent.norm();
  other_delivered_N_ = delivered.norm();
  other_force_ = true;
}

bool HaplyDevice::read(double now_s, DeviceSample& sample) noexcept {
  sample.valid = false;
  return is_open_ && exchange_.read(now_s, sample);
}

bool HaplyDevice::write(const Wrench& F_D) noexcept { return is_open_ && exchange_.write(F_D); }

std::string HaplyDevice::trouble() const {
  if (exchange_.lost())
    return answers_ ? "the service has the device no more, or tells no pose of it: plug it in, and start anew"
                    : "the service of Haply does not answer: start it anew";
  if (!powered_) return "the device has no power supply: plug it in, and see Haply Hub";
  if (!calibrated_) return "not calibrated: put the handle into its inkwell, and see Haply Hub";
  if (!ready_) return "the service says that the device is not ready: see Haply Hub";
  if (!grip_reports_) return "the grip does not tell how it is turned: wake it with a button";
  if (!other_force_) return "";
  return "the service delivered another force than was commanded (" + newtons(other_delivered_N_) + " for " +
         newtons(other_sent_N_) +
         "): its damper or gate found an oscillation, or another program pushes as well; choose a softer "
         "coupling";
}

}  // namespace tactum::inline v0_1
