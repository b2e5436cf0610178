#pragma once
/// What bridges tell of a run (docs/bridges.md): topics with the types of ROS, and their messages, made of
/// the rows of a trace. The numbers are those of the row: JSON has each with as many digits as tell it
/// apart from every other.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactum/recording/shown_messages.h"
#include "tactum/telemetry/frame_feed.h"

namespace tactum {

/// The languages in which a run is told. They differ in the names of a time's parts and in how frames are
/// told.
enum class BridgeProtocol { kRosbridge, kFoxglove };

struct BridgeTopic {
  enum class What { kPose, kTwist, kWrench, kTransforms, kContacts, kScene };
  What what = What::kPose;
  std::string name;         ///< "/tactum/hand/pose"
  std::string ros_type;     ///< "geometry_msgs/PoseStamped"; empty: not told by rosbridge
  std::string schema_name;  ///< the same for Foxglove
  std::string schema;       ///< JSON schema of Foxglove's messages
  std::size_t column = 0;   ///< of the row, where its numbers begin
};

/// A frame's row, and what belongs to it.
struct BridgeFrame {
  std::uint64_t index = 0;
  std::uint64_t time_ns = 0;  ///< since the start of the run [ns]
  std::vector<double> row;
};

class BridgeTopics {
 public:
  static constexpr std::size_t kMostTriangles = 20000;  ///< of a scene; beyond it boxes are drawn

  /// `columns` are those of the rows, with the bodies behind.
  BridgeTopics(const World& world, const std::vector<TraceColumn>& columns, std::size_t hands);

  const std::vector<BridgeTopic>& all() const noexcept { return topics_; }
  /// Null: there is none of that name that the protocol tells.
  const BridgeTopic* named(BridgeProtocol protocol, const std::string& name) const noexcept;

  /// The message that a frame is on a topic of poses, twists, wrenches or transforms; empty where a number
  /// is not finite, as the tool's while the hand holds nothing.
  std::string message(BridgeProtocol protocol, const BridgeTopic& topic, const BridgeFrame& frame) const;
  /// The message of the contacts in a picture of a frame.
  static std::string contacts(BridgeProtocol protocol, const FramePicture& picture, std::uint64_t time_ns);
  /// The bodies' shapes, for Foxglove: JSON of foxglove.SceneUpdate.
  const std::string& scene() const noexcept { return scene_; }

 private:
  void add_stamped(BridgeTopic::What what, const std::string& name, std::size_t column);
  std::string transforms(BridgeProtocol protocol, const BridgeFrame& frame) const;

  ShownColumns columns_;
  std::vector<BridgeTopic> topics_;
  std::string scene_;
};

}  // namespace tactum
