#pragma once
/// Judges the frames of a run by topology (referee/crossing_referee.h): all for tactum feel --referee, else
/// one in some where a scene has parts that are felt by their surfaces.

#include <cstdint>
#include <string>

#include "tactum/referee/crossing_referee.h"
#include "tactum/session/session.h"

namespace tactum {

class RefereeWatch {
 public:
  /// With the session's bodies where they start; the session must outlive it. Judged is every frame whose
  /// number `stride` divides.
  RefereeWatch(const Session& session, std::uint64_t stride);

  /// After every frame; judges the poses of those that are due.
  void look(std::uint64_t frame) {
    if (frame % stride_ == 0) judge(frame);
  }
  /// Judges the poses at the end of the run, if the last frame was not judged.
  void look_at_end();

  std::uint64_t judged_frames() const { return judged_; }
  std::uint64_t crossing_frames() const { return crossing_; }
  /// The verdict on the run, in one sentence.
  std::string sentence() const;

 private:
  void judge(std::uint64_t frame);
  std::string name(int body) const;

  const Session& session_;
  std::uint64_t stride_;
  CrossingReferee referee_;
  std::uint64_t judged_ = 0;
  std::uint64_t crossing_ = 0;
  std::uint64_t first_frame_ = 0;
  std::uint64_t next_frame_ = 0;  // after the last one judged
  Crossing first_;
};

/// Whether some body of the scene is felt by its surface: the gaps at the ends of steps do not tell whether
/// such bodies have crossed.
bool some_surface(const Scene& scene);

}  // namespace tactum
