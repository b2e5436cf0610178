#include <cmath>

#include "rig.h"
#include "standins/standin_haply.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/haply.h"
#include "tactum/drivers/registry.h"

namespace tactum {
namespace {

constexpr const char* kHaplyPlace = "TACTUM_HAPLY_SERVICE";

class HaplyRig final : public DriverRig {
 public:
  HaplyRig() : place_(kHaplyPlace, service_.place()) {
    service_.locked()->has_grip = true;
    service_.locked()->grip_every_s = 0.0;  // a grip that tells its turn in each answer, as the pose is told
  }

  Result<std::unique_ptr<Device>> make_by_name() override { return make_device("haply", {}); }
  Result<std::unique_ptr<Device>> make_unguarded() override {
    Result<HaplyOptions> options = haply_options("");
    options->stale_after_s = 3600.0;
    return HaplyDevice::connect(*options);
  }

  /// 40 mm right, 20 mm toward the operator and 30 mm up; turned by a quarter about the service's y, which
  /// points away from the operator: its x, which is right, goes to its -z, which is down.
  void go_to_known_pose() override {
    standin::HaplyService::Locked device = service_.locked();
    const double half = std::sqrt(0.5);
    device->position = {0.04, -0.02, 0.03};
    device->velocity = {0.1, 0.2, -0.3};
    device->turn_wxyz = {half, 0, half, 0};
  }
  Pose known_pose_in_D() const override {
    Mat3 R;  // x, toward the operator, stays; y, the right, goes down; z, up, goes to the right
    R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    return {R, {0.02, 0.04, 0.03}};
  }
  Twist known_velocity_in_D() const override { return {{-0.2, 0.1, -0.3}, {0, 0, 0}}; }
  void press_button(int number, bool pressed) override {
    service_.locked()->buttons[static_cast<std::size_t>(number)] = pressed;
  }
  void unplug() override { service_.locked()->connected = false; }

  std::vector<Wrench> commands_in_D() override {
    const standin::HaplyService::Locked now = service_.locked();
    std::vector<Wrench> commands;
    for (const standin::Triple& F : now.world.commands) commands.push_back(in_D(F));
    return commands;
  }
  int most_frames_between_commands() const override { return 25; }
  Wrench motors_in_D() override { return in_D(service_.motors()); }
  std::vector<std::string> broken_rules() override { return service_.locked()->broken_rules; }
  bool is_released() override {
    return comes_true([this] { return !service_.has_session(); });
  }

  std::string variable() const override { return kHaplyPlace; }
  std::vector<std::string> words_when_absent() const override {
    return {"this is no place of a service", "haply:HOST:PORT", kHaplyPlace};
  }

 private:
  /// Newtons; x right, y forward, z up.
  static Wrench in_D(const standin::Triple& F) { return {{-F[1], F[0], F[2]}, {0, 0, 0}}; }

  standin::HaplyService service_;
  SetVariable place_;
};

}  // namespace

std::unique_ptr<DriverRig> make_haply_rig() { return std::make_unique<HaplyRig>(); }

}  // namespace tactum
