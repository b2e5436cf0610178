/// A scene made in code, with all that a scene file can say: a finger presses a sprung button into its seat.

#include <tactum/tactum.h>

#include <cstdio>

namespace {

tactum::SceneDescription button_scene() {
  using namespace tactum;
  SceneDescription scene;
  scene.name = "button";
  scene.bodies = {{.name = "button",
                   .part = PrismPart{.sides = 24, .radius_m = 0.01, .height_m = 0.006},
                   .mass = {.mass_kg = 0.01},
                   .joint = SliderJoint{.axis = {0, 0, 1},
                                        .damping_Ns_per_m = 1.0,
                                        .stiffness_N_per_m = 100.0,
                                        .limits_m = Interval{-0.005, 0.0}},
                   .material = "plastic"},
                  {.name = "finger",
                   .part = PegPart{.peg = {.sides = 16, .width_m = 0.008, .length_m = 0.03}},
                   .X_OP = {Mat3::Identity(), {0, 0, 0.008}},  // the tip 5 mm above the button
                   .material = "plastic"}};
  scene.settings.friction = {{"plastic", "plastic", 0.3}};
  scene.tool = BodyTool{.body = "finger"};
  scene.hand.steps = {MoveStep{.offset_m = Vec3(0, 0, -0.014), .duration_s = 1.0}, HoldStep{.hold_s = 0.5}};
  scene.goals = {MovedGoal{.body = "button", .at_least_m = 0.003, .direction = Vec3(0, 0, -1)}};
  return scene;
}

}  // namespace

int main() {
  using namespace tactum;
  SceneDescription scene = button_scene();
  Result<std::unique_ptr<Session>> session = Session::open(scene, SessionOptions{});
  if (!session) return std::fprintf(stderr, "%s\n", session.error().message().c_str()), 1;
  const auto frames = static_cast<std::uint64_t>(frames_of_motion((*session)->scene()));
  if (!(*session)->run_virtual(frames, nullptr)) return 1;
  const bool pressed = (*session)->goals().all_met();
  std::printf("largest force %.2f N, the button is %s\n", (*session)->record().max_force_N,
              pressed ? "pressed" : "not pressed");

  scene.bodies[0].joint = HingeJoint{.anchor_m = {0.01, 0, 0}};  // about which axis?
  const Result<Scene> refused = build_scene(scene);              // the other way to a world, for a Simulation
  if (refused) return 1;
  std::printf("%s\n", refused.error().message().c_str());  // "body[0].joint.axis: ..."
  return pressed ? 0 : 1;
}
