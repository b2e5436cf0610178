/// A device of one's own in a loop of one's own: the sample is read, the frame run and the wrench written
/// here.

#include <tactum/tactum.h>

#include <cmath>
#include <cstdio>

namespace {

/// A handle on a rail along z that a hand pushes down with 2 N: a driver would talk to the hardware instead.
struct Rail {
  double z_m = 0.0;
  tactum::DeviceSample read() const {
    tactum::DeviceSample sample;
    sample.valid = true;
    sample.X_DH.p.z() = z_m;
    return sample;
  }
  void write(const tactum::Wrench& F_D) { z_m += 1e-3 / 10.0 * (F_D.f.z() - 2.0); }  // 10 N s/m, 1 ms
};

tactum::DeviceInfo rail_info() {
  tactum::DeviceInfo info;
  info.name = "rail";
  info.actuates_force = true;
  info.max_force_N = 10.0;
  info.max_stiffness_N_per_m = 1000.0;
  return info;
}

}  // namespace

int main() {
  using namespace tactum;
  Result<Scene> scene = open_scene("block-on-plate");  // or a world made in code, see step_a_world.cpp
  if (!scene) return 1;
  FrameSettings settings = settings_for(rail_info(), 1000.0);
  settings.tool = scene->settings.tool;
  settings.workspace = scene->settings.workspace;
  const auto simulation = Simulation::make(scene->world, settings);
  if (!simulation) return 1;

  Rail rail;
  for (int frame = 0; frame < 3000; ++frame)  // a program waits here for the next millisecond
    rail.write((*simulation)->step(rail.read()));
  const FrameReport& report = (*simulation)->report();
  std::printf("handle at %.4f m, force %.3f N, %d contact points\n", rail.z_m, report.shown.f.z(),
              report.grasped_contact_points);
  return std::abs(report.shown.f.z() - 2.0) < 0.1 && report.grasped_contact_points > 0 ? 0 : 1;
}
