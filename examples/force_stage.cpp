/// A force stage of one's own: a spring that guides the handle to the plane x = 0. What it adds passes
/// through passivity and safety like the forces of the scene.

#include <tactum/tactum.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

class Guide final : public tactum::ForceStage {
 public:
  tactum::Wrench apply(const tactum::Wrench& F_D, const tactum::DeviceSample& sample,
                       const tactum::FrameReport&) noexcept override {
    tactum::Wrench guided = F_D;
    guided.f.x() -= kStiffness_N_per_m * sample.X_DH.p.x();
    return guided;
  }

 private:
  static constexpr double kStiffness_N_per_m = 300.0;
};

}  // namespace

int main() {
  using namespace tactum;
  const Result<SimulatedDeviceModel> model = simulated_device_preset("premium-1.5-6dof");
  if (!model) return 1;
  const DeviceInfo info = SimulatedDevice(*model, no_hand(), nullptr).info();
  // A world without bodies: the hand feels the guide alone.
  const auto simulation = Simulation::make(World{}, settings_for(info, 1000.0));
  if (!simulation) return 1;
  Guide guide;
  (*simulation)->set_force_stage(&guide);

  for (const double x : {0.010, 0.200}) {  // 3 N; and 60 N, which no such device may be asked for
    Wrench wrench;
    for (int frame = 0; frame < 1500; ++frame) {
      Pose X_DH;
      X_DH.p.x() = x;
      wrench = (*simulation)->step(X_DH);
    }
    const double expected_N = std::min(300.0 * x, info.max_force_N);
    std::printf("at %.3f m the guide pushes with %.2f N\n", x, wrench.f.x());
    if (std::abs(wrench.f.x() + expected_N) > 1e-6) return 1;
  }
  return 0;
}
