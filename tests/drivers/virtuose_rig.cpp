#include "rig.h"
#include "standins/standin_virtuose.h"
#include "support/standin_files.h"
#include "tactum/drivers/registry.h"
#include "tactum/drivers/virtuose.h"

namespace tactum {
namespace {

constexpr const char* kVirtuoseVariable = "TACTUM_VIRTUOSE_LIBRARY";

class VirtuoseRig final : public DriverRig {
 public:
  VirtuoseRig()
      : standin_("standin_virtuose"), library_(kVirtuoseVariable, standin_file("standin_virtuose")) {}

  /// As the registry makes it, but for the relays, which would cost every test three seconds.
  Result<std::unique_ptr<Device>> make_by_name() override {
    return VirtuoseDevice::connect({.relays_s = 0.0});
  }
  Result<std::unique_ptr<Device>> make_unguarded() override {
    return VirtuoseDevice::connect({.host = "10.0.0.1#5126", .stale_after_s = 3600.0, .relays_s = 0.0});
  }

  /// Turned by a quarter about z. The handle was at (0.5, 0.125, 0.25) m when the device was opened. What is
  /// a float is written as sums of powers of two.
  void go_to_known_pose() override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().pose = {0.515625f, 0.09375f, 0.3125f, 0, 0, 0.70710678f, 0.70710678f};
    device().speed = {0.125f, 0.25f, -0.375f, 1, -2, 3};
  }
  Pose known_pose_in_D() const override {
    Mat3 R;
    R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    return {R, {0.015625, -0.03125, 0.0625}};
  }
  Twist known_velocity_in_D() const override { return {{0.125, 0.25, -0.375}, {1, -2, 3}}; }
  void press_button(int number, bool pressed) override {
    const std::lock_guard<std::mutex> lock(device().mutex);
    device().buttons[static_cast<std::size_t>(number)] = pressed ? 1 : 0;
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
    return !device().open && !device().running && !device().powered && !device().force_on;
  }

  std::string variable() const override { return kVirtuoseVariable; }
  std::vector<std::string> words_when_absent() const override {
    return {"the library of Haption", "install VirtuoseAPI 4", "libtirpc3", kVirtuoseVariable};
  }
  std::string old_library() const override { return standin_file("standin_virtuose_old"); }
  std::string lacking_function() const override { return "virtGetPhysicalPosition, virtGetPhysicalSpeed"; }

 private:
  standin::VirtuoseDevice& device() {
    return *standin_.function<standin::VirtuoseDevice*()>("standin_virtuose_device")();
  }
  static Wrench in_D(const std::array<float, 6>& F) { return {{F[0], F[1], F[2]}, {F[3], F[4], F[5]}}; }

  LoadedStandin standin_;
  SetVariable library_;
};

}  // namespace

std::unique_ptr<DriverRig> make_virtuose_rig() { return std::make_unique<VirtuoseRig>(); }

}  // namespace tactum
