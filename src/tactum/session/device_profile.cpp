#include "tactum/session/device_profile.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <utility>

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

constexpr double kMostDamping_Ns_per_m = 100.0;  // no handle has more: it could hardly be moved
constexpr double kMostFriction_N = 100.0;
constexpr double kMostMass_kg = 100.0;
constexpr double kMostDamping_Nms_per_rad = 10.0;
constexpr double kMostFriction_Nm = 10.0;
constexpr double kMostInertia_kg_m2 = 10.0;

fs::path profile_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value != nullptr && value[0] == '/' ? value : "");
  };
  if (const fs::path own = variable("TACTUM_DEVICE_PROFILES"); !own.empty()) return own;
  if (const fs::path config = variable("XDG_CONFIG_HOME"); !config.empty())
    return config / "tactum" / "devices";
  const fs::path home = variable("HOME");
  return home.empty() ? home : home / ".config" / "tactum" / "devices";
}

/// Letters, digits, dots; all else becomes a hyphen, so that a name is a file's and no folder's.
std::string as_file_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0 && c != '.'; }, '-');
  return name;
}

/// One number of a profile; the first error is kept.
double number_in(const toml::table& table, const char* key, double most, const std::string& path,
                 std::optional<Error>& error) {
  const std::optional<double> value = table[key].value<double>();
  if (value && *value >= 0.0 && *value <= most) return *value;  // false for NaN
  if (!error)
    error = Error{fmt::format("the profile's {} cannot be used", key),
                  value ? fmt::format("{}", *value) : "no number", fmt::format("0 to {}", most), path};
  return 0.0;
}

std::string quoted(const std::string& text) {
  std::string safe;
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x20 && c != '"' && c != '\\') safe += c;
  return '"' + safe + '"';
}

/// A device that tells what its profile knows better. Everything else is the device's own.
class ProfiledDevice final : public Device {
 public:
  ProfiledDevice(std::unique_ptr<Device> device, DeviceInfo info)
      : device_(std::move(device)), info_(std::move(info)) {}

  Result<void> open() override { return device_->open(); }
  void close() noexcept override { device_->close(); }
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override { return device_->read(now_s, sample); }
  bool write(const Wrench& F_D) noexcept override { return device_->write(F_D); }
  std::string trouble() const override { return device_->trouble(); }

 private:
  std::unique_ptr<Device> device_;
  DeviceInfo info_;
};

}  // namespace

std::string profile_path(const DeviceInfo& info) {
  const fs::path folder = profile_folder();
  if (folder.empty()) return {};
  const std::string serial = info.serial.empty() ? "" : "-" + info.serial;
  return (folder / (as_file_name(info.name + serial) + ".toml")).string();
}

DeviceProfile profile_of(const DeviceInfo& info, const HandleResponse& response,
                         const std::optional<TurnResponse>& turning) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  DeviceProfile profile;
  profile.device = info.name;
  profile.serial = info.serial;
  profile.measured = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", utc);
  profile.delay_s = std::max(0.0, response.delay_s);
  profile.damping_Ns_per_m = std::max(0.0, response.damping_Ns_per_m - response.damping_error_Ns_per_m);
  profile.friction_N = std::max(0.0, response.friction_N);
  profile.mass_kg = response.mass_kg;
  profile.turning = turning;
  if (turning) {
    profile.turning->damping_Nms_per_rad =
        std::max(0.0, turning->damping_Nms_per_rad - turning->damping_error_Nms_per_rad);
    profile.turning->friction_Nm = std::max(0.0, turning->friction_Nm);
    profile.turning->damping_error_Nms_per_rad = 0.0;
  }
  return profile;
}

Result<DeviceProfile> read_profile(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Error{"the profile cannot be read", "", "a file of tactum devices --try", path};
  std::optional<Error> error;
  DeviceProfile profile;
  try {
    const toml::table table = toml::parse(file, path);
    profile.device = table["device"].value_or(std::string());
    profile.serial = table["serial"].value_or(std::string());
    profile.measured = table["measured"].value_or(std::string());
    profile.delay_s = number_in(table, "delay_s", kLongestResponseDelay_s, path, error);
    profile.damping_Ns_per_m = number_in(table, "damping_Ns_per_m", kMostDamping_Ns_per_m, path, error);
    profile.friction_N = number_in(table, "friction_N", kMostFriction_N, path, error);
    profile.mass_kg = number_in(table, "mass_kg", kMostMass_kg, path, error);
    if (table.contains("damping_Nms_per_rad")) {
      TurnResponse& turning = profile.turning.emplace();
      turning.damping_Nms_per_rad =
          number_in(table, "damping_Nms_per_rad", kMostDamping_Nms_per_rad, path, error);
      turning.friction_Nm = number_in(table, "friction_Nm", kMostFriction_Nm, path, error);
      turning.inertia_kg_m2 = number_in(table, "inertia_kg_m2", kMostInertia_kg_m2, path, error);
    }
  } catch (const toml::parse_error& parsing) {
    return Error{"the profile is not TOML", std::string(parsing.description()),
                 "what tactum devices --try writes", path};
  }
  if (error) return *error;
  return profile;
}

Result<void> write_profile(const std::string& path, const DeviceProfile& profile) {
  std::error_code trouble;
  fs::create_directories(fs::path(path).parent_path(), trouble);
  std::ofstream file(path);
  file << "# Measured by tactum devices --try; tactum feel uses delay and damping for the coupling of this "
          "device.\n"
       << fmt::format("device = {}\nserial = {}\nmeasured = {}\n", quoted(profile.device),
                      quoted(profile.serial), quoted(profile.measured))
       << fmt::format("delay_s = {:.6f}\ndamping_Ns_per_m = {:.6f}\nfriction_N = {:.6f}\nmass_kg = {:.6f}\n",
                      profile.delay_s, profile.damping_Ns_per_m, profile.friction_N, profile.mass_kg);
  if (profile.turning)
    file << fmt::format("damping_Nms_per_rad = {:.9f}\nfriction_Nm = {:.9f}\ninertia_kg_m2 = {:.9f}\n",
                        profile.turning->damping_Nms_per_rad, profile.turning->friction_Nm,
                        profile.turning->inertia_kg_m2);
  file.close();
  if (!file) return Error{"the profile cannot be written", "", "a folder that may be written", path};
  return {};
}

DeviceInfo with_profile(const DeviceInfo& info, const DeviceProfile& profile) {
  DeviceInfo known = info;
  known.handle.delay_s = std::max(info.handle.delay_s, profile.delay_s);
  known.handle.damping_Ns_per_m = profile.damping_Ns_per_m;
  if (profile.mass_kg > 0.0) known.handle.mass_kg = profile.mass_kg;
  if (profile.turning) {
    known.handle.damping_Nms_per_rad = profile.turning->damping_Nms_per_rad;
    if (profile.turning->inertia_kg_m2 > 0.0) known.handle.inertia_kg_m2 = profile.turning->inertia_kg_m2;
  }
  return known;
}

Result<std::unique_ptr<Device>> profiled(std::unique_ptr<Device> device) {
  using Profiled = Result<std::unique_ptr<Device>>;
  const DeviceInfo& info = device->info();
  const std::string path = profile_path(info);
  if (!info.is_hardware || path.empty() || !fs::exists(path)) return Profiled(std::move(device));
  const Result<DeviceProfile> profile = read_profile(path);
  if (!profile) {
    Error error = profile.error();
    error.expected += ", or no such file: tactum devices --try measures it anew";
    return error;
  }
  if (profile->device != info.name || profile->serial != info.serial)
    return Error{"the profile is of another device", profile->device + " " + profile->serial,
                 info.name + " " + info.serial, path};
  DeviceInfo known = with_profile(info, *profile);
  return Profiled(std::make_unique<ProfiledDevice>(std::move(device), std::move(known)));
}

std::string profile_sentence(const DeviceInfo& info) {
  const std::string path = profile_path(info);
  if (!info.is_hardware || path.empty() || !fs::exists(path)) return {};
  const Result<DeviceProfile> profile = read_profile(path);
  if (!profile) return "A profile cannot be used: " + profile.error().message();
  return fmt::format("Delay {:.1f} ms and damping {:.2f} N s/m are those of {}, measured {}.",
                     1e3 * profile->delay_s, profile->damping_Ns_per_m, path, profile->measured);
}

}  // namespace tactum::inline v0_1
