#pragma once
/// The bridges of a run (viewer/server/bridge.h), for tactum feel --bridge.

#include <memory>
#include <string>
#include <vector>

#include "tactum/session/session.h"
#include "trace_file.h"
#include "viewer/server/bridge.h"

namespace tactum {

struct BridgeOptions {
  std::vector<std::string> bridges;  ///< as parse_bridge() has them
  double rate_Hz = 100.0;            ///< messages a second on each topic, at most [Hz]
};

class BridgeRun {
 public:
  /// Listens; the command fails with a sentence where that cannot be. From here on the session's frames are
  /// told; it must outlive this. Where the run has a trace, which takes the bodies as well, its rows are
  /// told: then drain() that first.
  BridgeRun(const BridgeOptions& options, Session& session, TraceFile* trace);
  ~BridgeRun();
  BridgeRun(const BridgeRun&) = delete;
  BridgeRun& operator=(const BridgeRun&) = delete;

  const Bridge& bridge() const noexcept { return *bridge_; }
  /// Tells the clients what the frames have left since the last call, and does what they ask; at least once
  /// in FrameTrace::kFrames frames.
  void poll();

 private:
  void show(std::span<const double> row);

  Session& session_;
  TraceFile* trace_file_;
  std::unique_ptr<FrameTrace> trace_;  // null: that of the file
  FrameFeed feed_;
  std::vector<double> row_;
  std::size_t time_;  // its column
  std::uint64_t frames_a_message_;
  std::unique_ptr<Bridge> bridge_;
};

}  // namespace tactum
