#pragma once
/// The requests of a page: one JSON object a message, `do` names the request, and every other key is known,
/// of the right type and in range; anything else is refused. docs/viewer.md lists them.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "tactum/base/result.h"

namespace tactum {

struct Request {
  enum class What {
    kAck,      ///< `seq`: this message was taken in
    kSteer,    ///< may I steer?
    kRelease,  ///< I steer no more
    kStop,     ///< zero wrench; anyone may
    kResume,   ///< after a stop
    kAim,      ///< `hand`, `p`, `q`, `buttons`: its pose in the world
    kRest,     ///< `hand`: it stays where it is
    kLeave,    ///< `hand`: I lead it no more; it goes where it was aimed
    kSet,      ///< `key`, `value`: a setting; infinite: no limit
    kUnset,    ///< `key`: a setting, as the scene has it
    kReset,    ///< the scene from its start
    kScene,    ///< `name`
    kDevice,   ///< `name`
    kGrip,     ///< `name`
    kRecord,   ///< begin a recording
    kEnd,      ///< end it
    kSeek,     ///< `frame` of a recording is shown
    kPlay,     ///< a recording goes on at `value` times its speed; 0: it stands still
  };
  What what = What::kAck;
  std::uint32_t sequence = 0;
  std::array<double, 3> p{};                    ///< [m]
  std::array<double, 4> q{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z
  std::uint32_t buttons = 0;
  std::uint32_t hand = 0;  ///< of kAim, kRest and kLeave: counted from 0
  std::string key;         ///< of kSet, kUnset
  std::string name;        ///< of kScene, kDevice, kGrip
  double value = 0.0;
  std::uint32_t frame = 0;  ///< of kSeek

  /// Whether only the page that steers may request this. It leads the first hand; any other hand is led by
  /// the page that takes it.
  bool steers() const { return what >= What::kResume && !leads_another(); }
  /// Whether this is about a hand after the first.
  bool leads_another() const { return hand > 0; }
};

Result<Request> parse_request(std::string_view text);

}  // namespace tactum
