#include "rig.h"
#include "standins/standin_spacenavd.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/registry.h"
#include "tactum/drivers/spacemouse.h"

namespace tactum {
namespace {

class SpaceMouseRig final : public DriverRig {
 public:
  SpaceMouseRig() : daemon_(1), socket_("SPNAV_SOCKET", daemon_.path()) {}

  Result<std::unique_ptr<Device>> make_by_name() override { return greeted(make_device("spacemouse", {})); }
  Result<std::unique_ptr<Device>> make_unguarded() override { return greeted(SpaceMouse::connect("")); }

  /// It leads by rate: its cap is deflected, and the pose begins at the origin.
  void go_to_known_pose() override { daemon_.send_motion(250, -500, 100, 0, 0, 0); }
  Pose known_pose_in_D() const override { return {}; }
  /// Right, down, and away from the user: -x of D is away, +y to the right.
  Twist known_velocity_in_D() const override { return {{-0.02, 0.05, -0.10}, {0, 0, 0}}; }
  void press_button(int number, bool pressed) override { daemon_.send_button(number, pressed); }
  void unplug() override { daemon_.hang_up(); }

  std::vector<Wrench> commands_in_D() override { return {}; }
  Wrench motors_in_D() override { return {}; }
  std::vector<std::string> broken_rules() override { return {}; }
  bool is_released() override {
    return comes_true([this] { return !daemon_.send_motion(0, 0, 0, 0, 0, 0); });
  }

  std::string variable() const override { return "SPNAV_SOCKET"; }
  std::vector<std::string> words_when_absent() const override {
    return {"no spacenavd answers", "apt install spacenavd", "SPNAV_SOCKET"};
  }

 private:
  /// What is sent before the stand-in has seen the client would go nowhere.
  Result<std::unique_ptr<Device>> greeted(Result<std::unique_ptr<Device>> made) {
    if (made) comes_true([this] { return daemon_.has_client(); });
    return made;
  }

  standin::Spacenavd daemon_;
  SetVariable socket_;
};

}  // namespace

std::unique_ptr<DriverRig> make_spacemouse_rig() { return std::make_unique<SpaceMouseRig>(); }

}  // namespace tactum
