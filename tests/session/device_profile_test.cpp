// The profile of a device, as a file, and what the coupling makes of it.

#include "tactum/session/device_profile.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "support/standin_files.h"
#include "tactum/haptics/coupling_gains.h"

namespace tactum::device_profile_test {
namespace {

/// A folder of profiles of its own.
class Profiles {
 public:
  Profiles() {
    std::string name = (std::filesystem::temp_directory_path() / "tactum-profiles-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) folder_ = name;
    variable_ = std::make_unique<SetVariable>("TACTUM_DEVICE_PROFILES", folder_);
  }
  ~Profiles() { std::filesystem::remove_all(folder_); }
  Profiles(const Profiles&) = delete;
  Profiles& operator=(const Profiles&) = delete;

  const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
  std::unique_ptr<SetVariable> variable_;
};

DeviceInfo real_device() {
  DeviceInfo info;
  info.name = "maker/model 7";
  info.serial = "10042";
  info.is_hardware = info.actuates_force = true;
  info.max_force_N = 12.0;
  info.handle.delay_s = 0.001;
  return info;
}

/// Nothing but its abilities.
class Described final : public Device {
 public:
  explicit Described(DeviceInfo info) : info_(std::move(info)) {}
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double, DeviceSample&) noexcept override { return false; }
  bool write(const Wrench&) noexcept override { return false; }
  std::string trouble() const override { return "its own word"; }

 private:
  DeviceInfo info_;
};

HandleResponse measured() {
  HandleResponse response;
  response.delay_s = 0.004;
  response.damping_Ns_per_m = 0.9;
  response.damping_error_Ns_per_m = 0.2;
  response.friction_N = 0.1;
  response.mass_kg = 0.25;
  return response;
}

TEST(DeviceProfile, IsReadAsItWasWrittenAndItsFileHasTheDevicesName) {
  const Profiles profiles;
  const DeviceInfo info = real_device();
  const std::string path = profile_path(info);
  EXPECT_EQ(path, profiles.folder() + "/maker-model-7-10042.toml");
  const DeviceProfile written = profile_of(info, measured());
  ASSERT_TRUE(write_profile(path, written));
  const Result<DeviceProfile> read = read_profile(path);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->device, info.name);
  EXPECT_EQ(read->serial, info.serial);
  EXPECT_EQ(read->measured, written.measured);
  EXPECT_DOUBLE_EQ(read->delay_s, 0.004);
  EXPECT_NEAR(read->damping_Ns_per_m, 0.7, 1e-9) << "the measured one less its error";
}

TEST(DeviceProfile, TheCouplingIsThatOfTheMeasuredDelayAndDamping) {
  const Profiles profiles;
  const DeviceInfo info = real_device();
  ASSERT_TRUE(write_profile(profile_path(info), profile_of(info, measured())));
  Result<std::unique_ptr<Device>> device = profiled(std::make_unique<Described>(info));
  ASSERT_TRUE(device) << device.error().message();
  const CouplingGains gains = coupling_gains((*device)->info(), 1000.0);
  EXPECT_NEAR(gains.translation.alone, 0.7 / 0.0045, 1e-6) << "b / (T / 2 + tau)";
  EXPECT_EQ((*device)->trouble(), "its own word");
  EXPECT_NE(profile_sentence(info).find("4.0 ms"), std::string::npos) << profile_sentence(info);
}

TEST(DeviceProfile, OfADeviceThatTurnsItsHandleTheDampingOfTurningCountsToo) {
  const Profiles profiles;
  DeviceInfo info = real_device();
  info.actuates_torque = true;
  info.max_torque_Nm = 0.2;
  info.handle.damping_Nms_per_rad = 0.5;
  TurnResponse turning;
  turning.damping_Nms_per_rad = 0.004;
  turning.damping_error_Nms_per_rad = 0.001;
  turning.friction_Nm = 0.002;
  turning.inertia_kg_m2 = 3e-4;
  ASSERT_TRUE(write_profile(profile_path(info), profile_of(info, measured(), turning)));
  const Result<std::unique_ptr<Device>> device = profiled(std::make_unique<Described>(info));
  ASSERT_TRUE(device) << device.error().message();
  EXPECT_NEAR((*device)->info().handle.damping_Nms_per_rad, 0.003, 1e-9) << "less its error";
  EXPECT_NEAR((*device)->info().handle.inertia_kg_m2, 3e-4, 1e-9);
  EXPECT_NEAR(coupling_gains((*device)->info(), 1000.0).rotation.alone, 0.003 / 0.0045, 1e-5);
  ASSERT_TRUE(write_profile(profile_path(info), profile_of(info, measured())));  // one from before
  EXPECT_EQ((*profiled(std::make_unique<Described>(info)))->info().handle.damping_Nms_per_rad, 0.5);
}

TEST(DeviceProfile, WithoutOneAndWithoutHardwareADeviceIsAsItIs) {
  const Profiles profiles;
  DeviceInfo info = real_device();
  EXPECT_EQ(profile_sentence(info), "");
  EXPECT_EQ((*profiled(std::make_unique<Described>(info)))->info().handle.delay_s, 0.001);
  ASSERT_TRUE(write_profile(profile_path(info), profile_of(info, measured())));
  info.is_hardware = false;
  EXPECT_EQ((*profiled(std::make_unique<Described>(info)))->info().handle.delay_s, 0.001);
}

TEST(DeviceProfile, OneThatCannotBeUsedIsAnErrorWithItsFileAndItsCure) {
  const Profiles profiles;
  const DeviceInfo info = real_device();
  const std::string path = profile_path(info);
  const auto error_of = [&](const std::string& text) {
    std::ofstream(path) << text;
    const Result<std::unique_ptr<Device>> device = profiled(std::make_unique<Described>(info));
    return device ? std::string() : device.error().message();
  };
  const std::string head = "device = \"maker/model 7\"\nserial = \"10042\"\nfriction_N = 0\nmass_kg = 0.2\n";
  EXPECT_EQ(error_of(head + "delay_s = 0.002\ndamping_Ns_per_m = 0.5\n"), "");
  for (const char* wrong :
       {"delay_s = 0.002\ndamping_Ns_per_m = -1\n", "delay_s = 3\ndamping_Ns_per_m = 1\n",
        "delay_s = nan\ndamping_Ns_per_m = 1\n", "damping_Ns_per_m = 1\n", "delay_s = = 1\n"}) {
    const std::string error = error_of(head + wrong);
    EXPECT_NE(error.find(path), std::string::npos) << wrong << error;
    EXPECT_NE(error.find("tactum devices --try"), std::string::npos) << error;
  }
  EXPECT_NE(
      error_of("device = \"other\"\nfriction_N = 0\nmass_kg = 0.2\ndelay_s = 0.002\ndamping_Ns_per_m = 1\n")
          .find("another device"),
      std::string::npos);
}

}  // namespace
}  // namespace tactum::device_profile_test
