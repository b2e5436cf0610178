#include "rig.h"
#include "standins/standin_dhd.h"
#include "support/standin_files.h"
#include "tactum/drivers/force_dimension.h"
#include "tactum/drivers/registry.h"

namespace tactum {
namespace {

constexpr const char* kDhdVariable = "TACTUM_FORCE_DIMENSION_LIBRARY";

class ForceDimensionRig final : public DriverRig {
 public:
  ForceDimensionRig() : standin_("standin_dhd"), library_(kDhdVariable, standin_file("standin_dhd")) {}

  Result<std::unique_ptr<Device>> make_by_name() override { return make_device("force-dimension", {}); }
  Result<std::unique_ptr<Device>> make_unguarded() override {
    device().old_firmware = true;  // no watchdog
    return ForceDimensionDevice::connect({.serial = "10042", .stale_after_s = 3600.0});
  }

  void go_to_known_pose() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().now.p = {0.01, -0.02, 0.03};
    device().now.frame = {0, -1, 0, 1, 0, 0, 0, 0, 1};  // a quarter turn about z, row by row
    device().now.v = {0.1, 0.2, -0.3};
    device().now.w = {1.0, -2.0, 3.0};
  }
  Pose known_pose_in_D() const override {
    Mat3 R;
    R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    return {R, {0.01, -0.02, 0.03}};
  }
  Twist known_velocity_in_D() const override { return {{0.1, 0.2, -0.3}, {1.0, -2.0, 3.0}}; }
  void press_button(int number, bool pressed) override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().now.buttons = pressed ? 1u << number : 0u;
  }
  void unplug() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().unplugged = true;
  }

  std::vector<Wrench> commands_in_D() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    std::vector<Wrench> commands;
    for (const auto& F : device().commands) commands.push_back({{F[0], F[1], F[2]}, {F[3], F[4], F[5]}});
    return commands;
  }
  Wrench motors_in_D() override {
    double F[7] = {};
    standin_.function<void(double*)>("standin_dhd_motors")(F);
    return {{F[0], F[1], F[2]}, {F[3], F[4], F[5]}};
  }
  std::vector<std::string> broken_rules() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    return device().broken_rules;
  }
  bool is_released() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    return !device().open && !device().force_on;
  }

  std::string variable() const override { return kDhdVariable; }
  std::vector<std::string> words_when_absent() const override {
    return {"the library of Force Dimension", "install the Force Dimension SDK", kDhdVariable};
  }
  std::string old_library() const override { return standin_file("standin_dhd_old"); }
  std::string lacking_function() const override { return "dhdSetForceAndTorqueAndGripperForce"; }

 private:
  standin::DhdDevice& device() { return *standin_.function<standin::DhdDevice*()>("standin_dhd_device")(); }

  LoadedStandin standin_;
  SetVariable library_;
};

}  // namespace

std::unique_ptr<DriverRig> make_force_dimension_rig() { return std::make_unique<ForceDimensionRig>(); }

}  // namespace tactum
