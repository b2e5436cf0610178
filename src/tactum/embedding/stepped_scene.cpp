#include "tactum/embedding/stepped_scene.h"

#include <utility>

#include "tactum/base/assert.h"
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

/// A device for each hand of the scene.
Result<std::vector<std::unique_ptr<Device>>> devices_of_scene(const Scene& scene,
                                                              const SteppedSceneOptions& options) {
  if (options.other_devices.size() > scene.other_hands.size())
    return Error{"more devices than the scene has hands", std::to_string(1 + options.other_devices.size()),
                 "at most " + std::to_string(1 + scene.other_hands.size()), scene.name};
  std::vector<std::unique_ptr<Device>> devices;
  for (std::size_t h = 0; h < scene.settings.hands(); ++h) {
    const SceneHand& hand = h == 0 ? scene : scene.other_hands[h - 1];
    const std::string asked = h == 0                                 ? options.device
                              : h - 1 < options.other_devices.size() ? options.other_devices[h - 1]
                                                                     : "";
    DeviceOptions device_options;
    device_options.hand_motion = hand.hand;
    device_options.grip = options.grip.empty() ? hand.grip : options.grip;
    Result<std::unique_ptr<Device>> device =
        make_device(listed_device_name(asked.empty() ? "simulated:" + hand.device : asked), device_options);
    if (!device) return device.error();
    devices.push_back(std::move(*device));
  }
  return devices;
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
  if (Result<void> chosen = choose_response(options.response, scene->settings); !chosen)
    return chosen.error();
  if (options.rate_Hz != 0.0) {
    if (Result<void> rate = check_rate(options.rate_Hz); !rate) return rate.error();
    scene->settings.dt_s = 1.0 / options.rate_Hz;
  }
  Result<std::vector<std::unique_ptr<Device>>> devices = devices_of_scene(*scene, options);
  if (!devices) return devices.error();
  std::vector<DeviceInfo> infos;
  for (const std::unique_ptr<Device>& device : *devices) infos.push_back(device->info());
  const FrameSettings settings = settings_for(*scene, infos);
  Result<std::unique_ptr<SteppedScene>> stepped =
      open(std::move(scene->world), settings, std::move(*devices));
  if (!stepped) return stepped.error();
  (*stepped)->name_ = scene->name;
  (*stepped)->frames_of_hand_ = frames_of_motion(*scene);
  return stepped;
}

Result<std::unique_ptr<SteppedScene>> SteppedScene::open(World world, const FrameSettings& settings,
                                                         std::vector<std::unique_ptr<Device>> devices) {
  if (devices.size() != settings.hands())
    return Error{"the settings have another number of hands than there are devices",
                 std::to_string(devices.size()) + " devices", std::to_string(settings.hands()), ""};
  Result<std::unique_ptr<Simulation>> simulation = Simulation::make(std::move(world), settings);
  if (!simulation) return simulation.error();
  return std::unique_ptr<SteppedScene>(new SteppedScene(std::move(*simulation), std::move(devices)));
}

Wrench SteppedScene::step(const DeviceSample& sample) noexcept {
  const HandSample one{sample};
  Wrench F_D;
  step({&one, 1}, {&F_D, 1});
  return F_D;
}

void SteppedScene::step(std::span<const HandSample> samples, std::span<Wrench> F_D) noexcept {
  TACTUM_ASSERT(samples.size() == hands() && F_D.size() == hands());
  FrameTick tick;
  tick.index = simulation_->next_index();
  tick.now_s = next_time_s();
  tick.period_s = 1.0 / rate_Hz();
  for (std::size_t h = 0; h < samples.size(); ++h) {
    now_[h] = samples[h];
    now_[h].time_s = tick.now_s;
  }
  simulation_->run(now_, tick, F_D);
  record_.add(simulation_->report(), simulation_->bodies(), simulation_->state().other_reports);
  contacts_known_ = false;
}

const std::vector<StepContact>& SteppedScene::contacts() {
  if (!contacts_known_)
    contacts_.take({simulation_->report(), simulation_->state(), simulation_->settings()});
  contacts_known_ = true;
  return contacts_.contacts();
}

}  // namespace tactum::inline v0_1
