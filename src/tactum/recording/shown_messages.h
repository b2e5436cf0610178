#pragma once
/// The messages by which other programs draw a run, in the schemas that Foxglove has for them: common to
/// recordings (shown_run.h) and to the bridges of a run that goes on. Time is that of the run [ns].

#include <cstdint>
#include <string>
#include <vector>

#include "tactum/dynamics/world.h"
#include "tactum/telemetry/trace.h"

namespace tactum::inline v0_1 {

/// The places of a hand's numbers in a row of a trace, and the names of its frames.
struct ShownHandColumns {
  std::string number;      ///< "" of the first hand, then "2" and so on
  std::string hand_frame;  ///< of the handle
  std::string proxy_frame;
  std::size_t hand, hand_twist, proxy, proxy_twist, sent, computed;
};

/// The place of a body's pose in a row, and the name of its frame.
struct ShownBodyColumns {
  std::string frame;
  std::size_t pose;
};

/// Where a row has what is drawn.
struct ShownColumns {
  /// `columns` are those of a trace of this world with the bodies behind, and of so many hands.
  ShownColumns(const World& world, const std::vector<TraceColumn>& columns, std::size_t hand_count);

  /// Every pose that the row has, as JSON of foxglove.FrameTransform, in the world.
  std::vector<std::string> transforms(const double* row, std::uint64_t time_ns) const;

  std::vector<ShownHandColumns> hands;
  std::vector<ShownBodyColumns> bodies;
};

namespace shown_json {
/// JSON schemas of foxglove.FrameTransform and foxglove.SceneUpdate.
std::string transform_schema();
std::string scene_schema();
/// An object of these properties, as text; and those that others are made of.
std::string object_schema(const std::string& title, const std::string& properties);
std::string vector_schema();
std::string turn_schema();
std::string time_schema();

/// JSON of foxglove.FrameTransform. `pose` is a place and a quaternion (w, x, y, z); empty where one of them
/// is not finite.
std::string transform_message(const std::string& name, const double* pose, std::uint64_t time_ns);
/// JSON of foxglove.SceneUpdate: every body's surface, or boxes where all have more triangles.
std::string scene_message(const World& world, std::size_t most_triangles);
/// The name of a body's frame.
std::string frame_of_body(const World& world, std::size_t body);
}  // namespace shown_json

}  // namespace tactum::inline v0_1
