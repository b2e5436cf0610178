#pragma once
/// What a recording says of its run: everything that a replay begins with, but for the files' content. The
/// one message of /tactum/run, as JSON.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/devices/device.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/session/session.h"
#include "tactum/telemetry/trace.h"

namespace tactum::inline v0_1 {

/// Of a recording that begins.
struct RecorderOptions {
  std::string path = {};          ///< of the file, which is made anew
  std::string grip = {};          ///< as in SessionOptions
  std::string version = {};       ///< of the program, "0.1.0"
  double snapshot_every_s = 1.0;  ///< of states from which a replay can begin; larger ones more rarely [s]
  /// Of a run that goes on already: the settings as its owner has them. The recording begins with a snapshot.
  std::optional<UserSettings> midway = {};
};

/// A file inside the recording, and the hash of its content (base/hash.h).
struct RecordedFile {
  std::string attachment;  ///< its name there: "scene.toml", "files/0/lock.obj"
  std::string name;        ///< of a file that the scene names: that name; else empty
  std::uint64_t hash = 0;
};

/// The devices of a run, by hand.
struct RecordedDevices {
  DeviceInfo device;                      ///< of the first hand
  std::vector<DeviceInfo> other_devices;  ///< of the second hand and all after it
};

struct RunHead : RecordedDevices {
  std::string version;     ///< of Tactum
  std::string compiler;    ///< and build type
  std::string date;        ///< of the start, UTC
  std::string scene;       ///< its name
  std::string scene_file;  ///< where it was read from, for errors
  std::string grip;
  double dt_s = 0.001;                                   ///< from frame to frame [s]
  std::vector<std::string> bodies;                       ///< names, by number
  std::vector<std::pair<std::string, double>> settings;  ///< in force at the start, all of setting_table()
  std::vector<RecordedFile> files;
  std::vector<TraceColumn> columns;  ///< of /tactum/frame
};

inline constexpr const char* kSceneAttachment = "scene.toml";
inline constexpr const char* kChangesAttachment = "settings.toml";  ///< of --settings

/// That of a session. Of one that has begun nothing is read that its loop changes.
RunHead head_of(const Session& session, const std::string& scene_file, const RecorderOptions& options,
                const std::vector<TraceColumn>& columns);

/// Section and key of each setting of the table, and its value.
std::vector<std::pair<std::string, double>> settings_in_force(const FrameSettings& settings,
                                                              const SafetySettings& safety);

/// A setting's value as a scene file has it: a word where the setting has words.
std::string setting_text(const std::string& key, double value);

std::string head_text(const RunHead& head);
/// An error names the field that is missing or of another kind; `where` is the file.
Result<RunHead> read_head(std::string_view text, const std::string& where);

}  // namespace tactum::inline v0_1
