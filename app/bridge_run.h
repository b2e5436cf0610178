#pragma once
/// The bridges of a run (viewer/server/bridge.h), for tactum feel --bridge.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactum/session/session.h"
#include "trace_file.h"
#include "viewer/server/bridge.h"
#include "viewer/server/viewer.h"

namespace tactum {

struct BridgeOptions {
  std::vector<std::string> bridges;  ///< as parse_bridge() has them
  double rate_Hz = 100.0;            ///< messages a second on each topic, at most [Hz]
};

class BridgeRun final : public RunFollower {
 public:
  /// Listens; the command fails with a sentence where that cannot be. From here on the session's frames are
  /// told; it must outlive this. Where the run has a trace, which takes the bodies as well, its rows are
  /// told: then drain() that first.
  BridgeRun(const BridgeOptions& options, Session& session, TraceFile* trace);
  /// The same of the runs of a viewer, which it is to follow. It listens as soon as one begins.
  explicit BridgeRun(const BridgeOptions& options);
  ~BridgeRun() override;
  BridgeRun(const BridgeRun&) = delete;
  BridgeRun& operator=(const BridgeRun&) = delete;

  const Bridge& bridge() const noexcept { return *bridge_; }
  /// Tells the clients what the frames have left since the last call, and does what they ask; at least once
  /// in FrameTrace::kFrames frames.
  void poll();

  /// Clients stay connected where a page starts the same scene anew. Another scene has other bodies: they are
  /// disconnected, and find it at the same port.
  void begin(Session& session) override;
  void go_on() override { poll(); }
  void see(const FramePicture& picture) override;
  void end() override;

 private:
  void take_rows(const FrameTrace& rows);
  void listen(const FrameTrace& rows);
  void show(std::span<const double> row);

  std::vector<BridgeChoice> choices_;
  double rate_Hz_;              // of messages, at most
  Session* session_ = nullptr;  // null: between two runs
  TraceFile* trace_file_ = nullptr;
  std::unique_ptr<FrameTrace> trace_;  // null: that of the file
  std::optional<FrameFeed> feed_;      // none: the viewer has it
  std::vector<double> row_;
  std::size_t time_ = 0;  // its column
  std::uint64_t frames_a_message_ = 1;
  std::unique_ptr<Bridge> bridge_;
  std::string scene_;  // that the bridge tells of
  bool led_ = false;   // its clients may lead the hand
};

}  // namespace tactum
