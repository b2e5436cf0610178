#pragma once
/// Judges the frames of a virtual run by topology (referee/crossing_referee.h), for tactum feel --referee.

#include <cstdint>
#include <string>

#include "tactum/referee/crossing_referee.h"
#include "tactum/session/session.h"

namespace tactum {

class RefereeWatch {
 public:
  /// With the session's bodies where they start; the session must outlive it.
  explicit RefereeWatch(const Session& session);

  /// Judges the poses of the last frame.
  void look(std::uint64_t frame);

  std::uint64_t judged_frames() const { return judged_; }
  std::uint64_t crossing_frames() const { return crossing_; }
  /// The verdict on the run, in one sentence.
  std::string sentence() const;

 private:
  std::string name(int body) const;

  const Session& session_;
  CrossingReferee referee_;
  std::uint64_t judged_ = 0;
  std::uint64_t crossing_ = 0;
  std::uint64_t first_frame_ = 0;
  Crossing first_;
};

}  // namespace tactum
