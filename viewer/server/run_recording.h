#pragma once
/// The recordings of a viewed run: begun and ended by the page or the command line, while the run goes on. A
/// run that is started anew goes on in a further file.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactum/recording/recorder.h"

namespace tactum {

/// A recording that was begun.
struct RecordingFile {
  std::string path;
  std::uint64_t frames = 0;   ///< written
  std::uint64_t dropped = 0;  ///< not written, since the disk was too slow
};

class RunRecording {
 public:
  /// Before the session begins: it reports to the recorder to come.
  void attach(Session& session) { session.report_to(&switch_); }

  /// Begins a file. With an empty path one that is not there yet, in the working folder, named by scene and
  /// time. `running`: the settings of a session that has begun.
  Result<void> begin(const std::string& path, const SceneDescription& scene, Session& session,
                     const std::string& grip, const std::optional<UserSettings>& running);
  /// Begins a further file beside the last one, for a session that has not begun.
  Result<void> go_on(const SceneDescription& scene, Session& session, const std::string& grip);
  /// Ends the file, if one is open. The session may go on.
  void end();
  /// For a run on the virtual clock, between two frames.
  void wait_for_room() const;

  bool on() const noexcept { return recorder_ != nullptr; }
  /// Why nothing is written any more: once. The recording is then over.
  std::optional<Error> trouble();
  /// All of them; the numbers of one that is open are those of now.
  std::vector<RecordingFile> files() const;

 private:
  RecordSwitch switch_;
  std::unique_ptr<SceneDescription> scene_;  // the recorder refers to it
  std::unique_ptr<Recorder> recorder_;
  std::vector<RecordingFile> files_;
  std::string asked_;             // the path of the last one
  std::optional<Error> trouble_;  // of one that has ended
};

}  // namespace tactum
