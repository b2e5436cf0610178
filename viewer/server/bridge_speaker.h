#pragma once
/// What the two protocols of bridges have in common: a speaker for each client, which is told what arrives
/// and what happens in the run, and speaks over a line. All of it belongs to the bridge's thread.

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "viewer/server/bridge_topics.h"
#include "viewer/server/connection_hub.h"

namespace tactum {

/// A moment of the run: a frame, or a picture of one. Its messages are made when the first client wants
/// them, once for all clients of a protocol.
class BridgeMoment {
 public:
  BridgeMoment(const BridgeTopics& topics, const BridgeFrame& frame) : topics_(topics), frame_(&frame) {}
  BridgeMoment(const BridgeTopics& topics, const FramePicture& picture, std::uint64_t time_ns)
      : topics_(topics), picture_(&picture), time_ns_(time_ns) {}

  std::uint64_t time_ns() const noexcept { return frame_ != nullptr ? frame_->time_ns : time_ns_; }
  /// Empty where this moment has nothing on the topic.
  const std::string& message(BridgeProtocol protocol, const BridgeTopic& topic);

 private:
  const BridgeTopics& topics_;
  const BridgeFrame* frame_ = nullptr;
  const FramePicture* picture_ = nullptr;
  std::uint64_t time_ns_ = 0;
  std::map<std::pair<BridgeProtocol, const BridgeTopic*>, std::string> messages_;
};

/// The way to one client.
class BridgeLine {
 public:
  virtual ~BridgeLine() = default;
  /// A message that must arrive; the client is cut off where too many wait.
  virtual void owe(std::string message, bool binary) = 0;
  /// A message that gives way to newer ones where the client is slow.
  virtual void offer(std::string message, bool binary) = 0;

 protected:
  BridgeLine() = default;
  BridgeLine(const BridgeLine&) = default;
  BridgeLine& operator=(const BridgeLine&) = default;
};

class BridgeSpeaker {
 public:
  virtual ~BridgeSpeaker() = default;
  virtual void opened() = 0;
  /// False: it was not understood, of which the client has been told.
  virtual bool received(const std::string& message, bool is_text) = 0;
  virtual void show(BridgeMoment& moment) = 0;
  /// So many messages in all gave way to newer ones.
  virtual void lost(std::uint64_t messages) = 0;
  /// The client is gone.
  virtual void closed() = 0;

 protected:
  BridgeSpeaker() = default;
  BridgeSpeaker(const BridgeSpeaker&) = default;
  BridgeSpeaker& operator=(const BridgeSpeaker&) = default;
};

/// The topic to which clients of rosbridge send where the hand shall go.
inline constexpr const char* kHandCommand = "/tactum/hand/command";

/// Speakers of rosbridge v2 and of foxglove.websocket.v1. `topics`, `line` and `inbox` outlive them. The
/// inbox is null where the hand cannot be led.
std::unique_ptr<BridgeSpeaker> speak_rosbridge(const BridgeTopics& topics, BridgeLine& line,
                                               RequestInbox* inbox);
std::unique_ptr<BridgeSpeaker> speak_foxglove(const BridgeTopics& topics, BridgeLine& line);

}  // namespace tactum
