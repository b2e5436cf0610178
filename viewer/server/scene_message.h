#pragma once
/// The messages to a page about a run: once, when the run begins, everything that stays (as JSON and as
/// geometry), then pictures of everything that moves. docs/viewer.md draws the layouts.

#include <optional>
#include <string>
#include <vector>

#include "tactum/haptics/setting_table.h"
#include "tactum/scene/scene_remarks.h"
#include "tactum/session/session.h"

namespace tactum {

/// What is shown: the scene of a session, or of a recording.
struct ShownScene {
  const std::string& name;
  const std::string& description;
  const World& world;
  const FrameSettings& settings;
  const DeviceInfo& device;
  double rate_Hz;
  std::vector<bool> led;  ///< by hand: whether pages may lead it; hands that are not listed cannot be led
};
ShownScene shown_scene(const Session& session);

/// A recording that is shown: its frames are `first` up to `past`, which is not one of them.
struct ReplayFacts {
  std::string file;
  std::uint64_t first = 0, past = 0;
};

/// Facts for the page beside the scene itself.
struct RunFacts {
  std::uint32_t run = 0;  ///< counts the runs: pictures and samples carry it
  std::string device;     ///< as in the registry
  std::string grip;
  bool loop_in_real_time = true;
  std::vector<SceneRemark> remarks;   ///< on the scene
  std::optional<ReplayFacts> replay;  ///< of a recording
};

/// The settings as they are and as the scene has them. The coupling that the device has chosen is the scene's
/// own.
struct ShownSettings {
  UserSettings now, usual;
  bool coupling_by_device = false;        ///< the device has chosen the coupling ...
  bool usual_coupling_by_device = false;  ///< ... as the scene wants it
};

/// Scene, bodies, device, tables of stages, channels and settings with their values, choices.
std::string run_message(const ShownScene& scene, const ShownSettings& settings, const RunFacts& facts);

/// The settings alone, after one was changed, and which fraction of the stability bounds they use.
std::string settings_message(const ShownScene& scene, const ShownSettings& settings);

/// The surfaces of the parts, each once: vertices, triangles with piece and face, and the edges worth
/// drawing.
std::string geometry_of(const World& world);

/// The poses of all bodies, with the contacts.
void write_picture(const FramePicture& picture, std::string& out);

}  // namespace tactum
