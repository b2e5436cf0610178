#include "tactum/recording/recorded_scene.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "tactum/haptics/setting_table.h"
#include "tactum/mesh/mapped_file.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"
#include "tactum/scene/scene_files.h"

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFilesFolder = "files/";

/// A folder for the recorded files, gone with the object.
class UnpackedFiles {
 public:
  UnpackedFiles() = default;
  ~UnpackedFiles() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  UnpackedFiles(const UnpackedFiles&) = delete;
  UnpackedFiles& operator=(const UnpackedFiles&) = delete;

  Result<void> unpack(const RunHead& head, const std::map<std::string, std::string>& files,
                      const std::string& where) {
    for (const RecordedFile& file : head.files) {
      if (!file.attachment.starts_with(kFilesFolder)) continue;
      const fs::path name = fs::path(file.attachment).lexically_normal();
      // Nothing is written outside of the folder, whatever a file's name says.
      if (name.is_absolute() || *name.begin() != "files")
        return Error{"a file of the recording has a name that leaves its folder", file.attachment,
                     "files/NUMBER/NAME", where};
      if (Result<void> made = make_folder(); !made) return made;
      const fs::path path = folder_ / name;
      std::error_code failure;
      fs::create_directories(path.parent_path(), failure);
      if (failure)
        return Error{"cannot unpack a recorded file", failure.message(), "room for it", path.string()};
      if (Result<void> written = write_whole_file(path.string(), files.at(file.attachment)); !written)
        return written;
      if (!file.name.empty()) places_[file.name] = path.string();
    }
    return {};
  }
  std::string place_of(const std::string& name) const {
    const auto found = places_.find(name);
    return found == places_.end() ? name : found->second;
  }

 private:
  Result<void> make_folder() {
    if (!folder_.empty()) return {};
    std::error_code failure;
    std::string name = (fs::temp_directory_path(failure) / "tactum-replay-XXXXXX").string();
    if (failure || mkdtemp(name.data()) == nullptr)
      return Error{"cannot make a folder for the recorded files", name, "one that can be written to", ""};
    folder_ = name;
    return {};
  }

  fs::path folder_;
  std::map<std::string, std::string> places_;
};

/// The description as the run had it, its files where they were unpacked.
Result<SceneDescription> describe(const RunHead& head, const std::map<std::string, std::string>& files,
                                  const ReplayOptions& options, const UnpackedFiles& unpacked) {
  Result<SceneDescription> scene =
      parse_description(files.at(kSceneAttachment), head.scene, head.scene_file, {});
  if (!scene) return scene;
  if (const auto changes = files.find(kChangesAttachment); changes != files.end())
    if (Result<void> changed = parse_changes(changes->second, kChangesAttachment, *scene); !changed)
      return changed.error();
  if (!options.settings.empty())
    if (Result<void> changed = change_settings(options.settings, *scene); !changed) return changed.error();
  move_files(*scene, [&](const std::string& name) { return unpacked.place_of(name); });
  return scene;
}

/// Settings that were others at the start than the scene says, as of a page that has begun the run anew.
Result<void> restore_settings(const RunHead& head, const ReplayOptions& options, const std::string& where,
                              FrameSettings& settings, RecordedScene& recorded) {
  for (const auto& [key, value] : head.settings) {
    const int place = setting_called(key);
    if (place < 0) return Error{"a recorded setting is not known", key, "one of docs/settings.md", where};
    const SettingInfo& setting = setting_table()[static_cast<std::size_t>(place)];
    const double now = setting.get(settings, recorded.safety);
    const bool other = !options.settings.empty() || (key == "response" && !options.response.empty());
    if (other || now == value) continue;
    if (!in_range(setting, value))
      return Error{fmt::format("the recorded setting {} is out of its range", key), fmt::format("{}", value),
                   fmt::format("{} to {}", setting.low, setting.high), where};
    with_every_hand(settings, [&, was = value](std::size_t) {  // clang captures no structured binding
      setting.set(settings, recorded.safety, was);
    });
    recorded.notes.push_back(fmt::format("{} is {} in the scene and was {} at the start", key, now, value));
  }
  return {};
}

}  // namespace

Result<RecordedScene> build_recorded(const RunHead& head, const std::map<std::string, std::string>& files,
                                     const ReplayOptions& options, const std::string& where) {
  if (!files.contains(kSceneAttachment))
    return Error{"the recording has no scene", "", kSceneAttachment, where};
  if (!(head.dt_s > 0.0) || !check_rate(1.0 / head.dt_s))
    return Error{"the recorded step is none of a loop", fmt::format("{} s", head.dt_s), "0.00001 to 0.1 s",
                 where};
  UnpackedFiles unpacked;
  if (Result<void> done = unpacked.unpack(head, files, where); !done) return done.error();
  const Result<SceneDescription> description = describe(head, files, options, unpacked);
  if (!description) return description.error();
  Result<Scene> scene = build_scene(*description);
  if (!scene) return scene.error();
  if (!options.response.empty())
    scene->settings.response =
        options.response == "penalty" ? ResponseModel::kPenalty : ResponseModel::kConstraint;
  scene->settings.dt_s = head.dt_s;

  RecordedScene recorded;
  recorded.name = scene->name;
  recorded.description = scene->description;
  recorded.safety = scene->safety;
  recorded.goals = scene->goals;
  std::vector<DeviceInfo> devices{head.device};
  devices.insert(devices.end(), head.other_devices.begin(), head.other_devices.end());
  if (devices.size() != scene->settings.hands())
    return Error{"the recording has devices for another number of hands than its scene",
                 std::to_string(devices.size()), std::to_string(scene->settings.hands()), where};
  for (std::size_t hand = 0; hand < devices.size(); ++hand)
    recorded.device_limits.push_back(device_limits(*scene, hand, devices[hand]));
  FrameSettings settings = settings_for(*scene, devices);
  if (Result<void> restored = restore_settings(head, options, where, settings, recorded); !restored)
    return restored.error();
  for (const auto& [place, value] : options.changed)
    with_every_hand(settings, [&, place = static_cast<std::size_t>(place), value = value](std::size_t) {
      setting_table()[place].set(settings, recorded.safety, value);
    });
  recorded.tighten(settings);
  Result<std::unique_ptr<Simulation>> made = Simulation::make(std::move(scene->world), std::move(settings));
  if (!made) return made.error();
  recorded.simulation = std::move(*made);
  return recorded;
}

void RecordedScene::tighten(FrameSettings& settings) const {
  with_every_hand(settings,
                  [&](std::size_t hand) { settings.safety = tightened(device_limits[hand], safety); });
}

Result<void> RecordedScene::restore(const RecordedSnapshot& snapshot, const ReplayOptions& options,
                                    const std::string& where) {
  const std::span<const SettingInfo> table = setting_table();
  if (snapshot.layout != recording::layout_of_snapshots(simulation->state()) ||
      snapshot.settings.size() != table.size() * device_limits.size())
    return Error{"a snapshot cannot be gone on from", "one of another response or version of the program",
                 "the response of the recording, or a replay from the start", where};
  for (std::size_t i = 0; i < snapshot.settings.size(); ++i) {
    const SettingInfo& setting = table[i % table.size()];
    if (setting.live && !in_range(setting, snapshot.settings[i]))
      return Error{fmt::format("the setting {} of a snapshot is out of its range", setting.key),
                   fmt::format("{}", snapshot.settings[i]),
                   fmt::format("{} to {}", setting.low, setting.high), where};
  }
  if (options.settings.empty() && options.changed.empty())
    with_every_hand(simulation->settings(), [&](std::size_t hand) {
      for (std::size_t i = 0; i < table.size(); ++i)
        if (table[i].live)
          table[i].set(simulation->settings(), safety, snapshot.settings[hand * table.size() + i]);
    });
  tighten(simulation->settings());
  Result<void> restored = simulation->restore(snapshot.state, snapshot.index);
  if (!restored)
    return Error{restored.error().what, restored.error().found, restored.error().expected, where};
  return {};
}

}  // namespace tactum::inline v0_1
