#include "tactum/embedding/stepped_scene.h"

#include <utility>

#include "tactum/drivers/registry.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"

namespace tactum::inline v0_1 {
namespace {

Result<void> choose_response(const std::string& wanted, FrameSettings& settings) {
  if (wanted.empty()) return {};
  if (wanted != "constraint" && wanted != "penalty")
    return Error{"no such response", wanted, "constraint or penalty", ""};
  settings.response = wanted == "penalty" ? ResponseModel::kPenalty : ResponseModel::kConstraint;
  return {};
}

Result<std::unique_ptr<Device>> device_of_scene(const Scene& scene, const SteppedSceneOptions& options) {
  DeviceOptions device;
  device.hand_motion = scene.hand;
  device.grip = options.grip.empty() ? scene.grip : options.grip;
  return make_device(
      listed_device_name(options.device.empty() ? "simulated:" + scene.device : options.device), device);
}

}  // namespace

Result<std::unique_ptr<SteppedScene>> SteppedScene::open(const std::string& name_or_path,
                                                         const SteppedSceneOptions& options) {
  Result<SceneDescription> description = describe_scene(name_or_path);
  if (!description) return description.error();
  return open(std::move(*description), options);
}

Result<std::unique_ptr<SteppedScene>> SteppedScene::open(SceneDescription description,
                                                         const SteppedSceneOptions& options) {
  if (!options.settings.empty())
    if (Result<void> changed = parse_changes(options.settings, "the settings", description); !changed)
      return changed.error();
  Result<Scene> scene = build_scene(description);
  if (!scene) return scene.error();
  if (scene->settings.hands() != 1)
    return Error{"a scene is stepped with one hand", std::to_string(scene->settings.hands()) + " tools",
                 "one tool, or a session", scene->name};
  if (Result<void> chosen = choose_response(options.response, scene->settings); !chosen)
    return chosen.error();
  if (options.rate_Hz != 0.0) {
    if (Result<void> rate = check_rate(options.rate_Hz); !rate) return rate.error();
    scene->settings.dt_s = 1.0 / options.rate_Hz;
  }
  Result<std::unique_ptr<Device>> device = device_of_scene(*scene, options);
  if (!device) return device.error();
  const FrameSettings settings = settings_for(*scene, (*device)->info());
  Result<std::unique_ptr<SteppedScene>> stepped = open(std::move(scene->world), settings, std::move(*device));
  if (!stepped) return stepped.error();
  (*stepped)->name_ = scene->name;
  (*stepped)->frames_of_hand_ = frames_of_motion(*scene);
  return stepped;
}

Result<std::unique_ptr<SteppedScene>> SteppedScene::open(World world, const FrameSettings& settings,
                                                         std::unique_ptr<Device> device) {
  Result<std::unique_ptr<Simulation>> simulation = Simulation::make(std::move(world), settings);
  if (!simulation) return simulation.error();
  return std::unique_ptr<SteppedScene>(new SteppedScene("world", std::move(*simulation), std::move(device)));
}

Wrench SteppedScene::step(const DeviceSample& sample) noexcept {
  FrameTick tick;
  tick.index = simulation_->next_index();
  tick.now_s = next_time_s();
  tick.period_s = 1.0 / rate_Hz();
  DeviceSample now = sample;
  now.time_s = tick.now_s;
  const Wrench F_D = simulation_->run(now, tick);
  record_.add(simulation_->report(), simulation_->bodies());
  contacts_known_ = false;
  return F_D;
}

const std::vector<StepContact>& SteppedScene::contacts() {
  if (!contacts_known_)
    contacts_.take({simulation_->report(), simulation_->state(), simulation_->settings()});
  contacts_known_ = true;
  return contacts_.contacts();
}

}  // namespace tactum::inline v0_1
