#include "rig.h"
#include "standins/standin_hd.h"
#include "support/standin_files.h"
#include "tactum/drivers/registry.h"
#include "tactum/drivers/touch.h"

namespace tactum {
namespace {

constexpr const char* kHdVariable = "TACTUM_OPENHAPTICS_LIBRARY";

class TouchRig final : public DriverRig {
 public:
  TouchRig() : standin_("standin_hd"), library_(kHdVariable, standin_file("standin_hd")) {}

  Result<std::unique_ptr<Device>> make_by_name() override { return make_device("3d-systems", {}); }
  Result<std::unique_ptr<Device>> make_unguarded() override {
    return TouchDevice::connect({.name = "", .stale_after_s = 3600.0});
  }

  /// 40 mm right, 30 mm up and 20 mm toward the user of HDAPI's origin, turned by a quarter about its y: its
  /// x axis points away from the user. The middle of the usable workspace is at (0, 10, 0) mm.
  void go_to_known_pose() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().transform = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 40, 30, 20, 1};
    device().velocity = {100, 200, -300};
    device().angular_velocity = {1, 2, 3};
  }
  Pose known_pose_in_D() const override {
    Mat3 R;  // about z, which is up, by a quarter: x, toward the user, goes to y, the right
    R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    return {R, {0.020, 0.040, 0.020}};
  }
  Twist known_velocity_in_D() const override { return {{-0.3, 0.1, 0.2}, {3, 1, 2}}; }
  void press_button(int number, bool pressed) override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().buttons = pressed ? 1 << number : 0;
  }
  void unplug() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().unplugged = true;
  }

  std::vector<Wrench> commands_in_D() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    std::vector<Wrench> commands;
    for (const auto& F : device().commands) commands.push_back(in_D(F));
    return commands;
  }
  int most_frames_between_commands() const override { return 25; }
  Wrench motors_in_D() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    return in_D(device().motors);
  }
  std::vector<std::string> broken_rules() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    return device().broken_rules;
  }
  bool is_released() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    return !device().open && !device().running && !device().scheduled && !device().force_output;
  }

  std::string variable() const override { return kHdVariable; }
  std::vector<std::string> words_when_absent() const override {
    return {"the library of 3D Systems", "install OpenHaptics", kHdVariable};
  }
  std::string old_library() const override { return standin_file("standin_hd_old"); }
  std::string lacking_function() const override { return "hdCheckCalibration, hdUpdateCalibration"; }

 private:
  standin::HdDevice& device() { return *standin_.function<standin::HdDevice*()>("standin_hd_device")(); }
  /// Newtons and thousandths of a newton metre; x right, y up, z toward the user.
  static Wrench in_D(const std::array<double, 6>& F) {
    return {{F[2], F[0], F[1]}, {F[5] / 1000, F[3] / 1000, F[4] / 1000}};
  }

  LoadedStandin standin_;
  SetVariable library_;
};

}  // namespace

std::unique_ptr<DriverRig> make_3d_systems_rig() { return std::make_unique<TouchRig>(); }

}  // namespace tactum
