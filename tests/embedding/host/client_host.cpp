/// A host in C++17 of tactum_client.h, as others compile it: parts and distances, a scene stepped, errors,
/// and a host that is written for a haptic device and feels the gears. Ends with 0 when all is as it should
/// be.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "tactum/embedding/tactum_client.h"

namespace {

using tactum_client::Error;
using tactum_client::Part;
using tactum_client::Scene;
using tactum_client::SceneDevice;
using tactum_client::sized;
using tactum_client::World;

int wrongs = 0;

void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "wrong: %s\n", what);
  ++wrongs;
}

Part cube(double half_m) {
  std::vector<std::array<double, 3>> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        {(i & 1) != 0 ? half_m : -half_m, (i & 2) != 0 ? half_m : -half_m, (i & 4) != 0 ? half_m : -half_m});
  return Part::make(corners, {{0, 2, 1},
                              {1, 2, 3},
                              {4, 5, 6},
                              {5, 7, 6},
                              {0, 1, 4},
                              {1, 5, 4},
                              {2, 6, 3},
                              {3, 6, 7},
                              {0, 4, 2},
                              {2, 4, 6},
                              {1, 3, 5},
                              {3, 7, 5}});
}

void measures_parts() {
  Part made = cube(0.01);
  const Part moved = std::move(made);  // and is released once
  tactum_pose here{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  tactum_pose above = here;
  above.p[2] = 0.025;
  demand(std::abs(moved.info().volume_m3 - 8e-6) < 1e-15, "the volume of a cube");
  demand(moved.mesh().triangle_count == 12, "its triangles");
  demand(std::abs(tactum_client::clearance(moved, here, moved, above).distance_m - 0.005) < 1e-12,
         "clearance");
  above.p[2] = 0.018;
  demand(std::abs(tactum_client::signed_distance(moved, here, moved, above).distance_m + 0.002) < 1e-12,
         "signed distance");
}

void refuses_with_sentences() {
  try {
    Scene::open("no-such-scene");
    demand(false, "a scene that there is not was opened");
  } catch (const Error& error) {
    demand(error.status() == TACTUM_REFUSED, "the status of a refusal");
    demand(std::string(error.what()).find("no-such-scene") != std::string::npos, "its sentence");
  }
}

/// The hash of a run as the C interface has it.
std::uint64_t run_in_c(int frames) {
  Scene scene = Scene::open("gears");
  tactum_client::check(tactum_open_hand(scene.handle()));
  for (int i = 0; i < frames; ++i) {
    auto sample = tactum_client::sized<tactum_sample>();
    tactum_client::check(tactum_read_hand(scene.handle(), &sample));
    const tactum_frame frame = scene.step(sample);
    tactum_client::check(tactum_write_hand(scene.handle(), &frame.F_D));
  }
  return tactum_run_hash(scene.handle());
}

void feels_a_scene_as_a_device() {
  SceneDevice device("gears");
  SceneDevice::Vector p{}, v{}, w{};
  SceneDevice::Matrix R{};
  demand(!device.getPosition(p) && device.trouble() == "the device is not open", "a device that is closed");
  demand(device.open(), "the device does not open");
  double largest_Nm = 0.0;
  std::size_t contacts = 0;
  for (int i = 0; i < 1500; ++i) {  // a host whose own world is empty
    demand(device.getPosition(p) && device.getRotation(R) && device.getLinearVelocity(v) &&
               device.getAngularVelocity(w),
           "the device is not read");
    demand(device.setForceAndTorqueAndGripperForce({}, {}, 0.0), "the device is not written");
    const double* t = device.frame().F_D.t;
    largest_Nm = std::fmax(largest_Nm, std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
    contacts = std::max(contacts, device.scene().contacts().size());
  }
  demand(largest_Nm > 1e-3 && contacts > 0, "the gears are not felt");
  demand(tactum_run_hash(device.scene().handle()) == run_in_c(1500),
         "the frames are not those of the C interface");
  demand(!device.setForceAndTorqueAndGripperForce({}, {}, 1.0), "a gripper that there is not");
  demand(device.close() && !device.getPosition(p), "a device that was closed");
}

/// Two hosts with worlds of their own, which do not feel the scene: one pushes the hand up, one does not.
void moves_by_the_forces_of_its_host() {
  std::array<double, 2> height_m{};
  for (int push = 0; push < 2; ++push) {
    SceneDevice device("block-on-plate", false);
    demand(device.open(), "the device does not open");
    SceneDevice::Vector p{};
    for (int i = 0; i < 100; ++i)
      demand(device.getPosition(p) && device.setForce({0.0, 0.0, 2.0 * push}), "a cycle is refused");
    height_m[static_cast<std::size_t>(push)] = p[2];
  }
  demand(height_m[1] > height_m[0] + 1e-4, "the host's force does not move the hand");
}

/// The peg in one hand, its hole in the other, and a world of two cubes, each in a hand.
void takes_worlds_and_several_hands() {
  Scene scene = Scene::open("peg-two-hands");
  auto still = sized<tactum_sample>();
  still.X_DH = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  demand(scene.hands() == 2 && scene.step(std::vector{still, still}).size() == 2, "two hands");
  const Part block = cube(0.01);
  World world;
  auto options = sized<tactum_body_options>();
  std::vector<tactum_tool> tools(2, sized<tactum_tool>());
  const char* names[] = {"lower", "upper"};
  for (std::size_t i = 0; i < 2; ++i) {
    options.name = tools[i].body = names[i];
    const tactum_pose X_WP = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0.021 * static_cast<double>(i)}};
    demand(world.add(block, X_WP, &options) == static_cast<int>(i), "a body is added");
  }
  Scene both = world.simulate(tools);
  std::vector samples(2, still);
  std::vector<tactum_wrench> F_D;
  for (int i = 0; i < 500; ++i) {
    samples[1].X_DH.p[2] = -0.01 * i / 500.0;
    F_D = both.step(samples);
  }
  demand(F_D[1].f[2] > 0.1 && F_D[0].f[2] < -0.1, "the cubes do not press each other");
  try {
    world.add(block, still.X_DH, &options);
    demand(false, "a name that is taken");
  } catch (const Error& error) {
    demand(error.status() == TACTUM_REFUSED, "a name that is taken is refused");
  }
}

}  // namespace

int main() {
  try {
    measures_parts();
    refuses_with_sentences();
    feels_a_scene_as_a_device();
    moves_by_the_forces_of_its_host();
    takes_worlds_and_several_hands();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return wrongs == 0 ? 0 : 1;
}
