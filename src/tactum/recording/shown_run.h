#pragma once
/// What other programs draw of a recording: poses, wrenches and the scene at a screen's rate, in the schemas
/// that Foxglove and ROS have for them.

#include <cstdint>
#include <string>
#include <vector>

#include "tactum/recording/frame_slot.h"
#include "tactum/recording/mcap_writer.h"
#include "tactum/recording/shown_messages.h"

namespace tactum::inline v0_1 {

class ShownRun {
 public:
  static constexpr double kRate_Hz = 60.0;              ///< messages a second, at most
  static constexpr std::size_t kMostTriangles = 20000;  ///< of a scene; beyond it boxes are drawn

  /// Adds the channels. `columns` are those of the rows, with the bodies behind.
  ShownRun(McapWriter& writer, const World& world, double dt_s, const std::vector<TraceColumn>& columns,
           std::size_t hands = 1);

  /// The bodies' shapes, once.
  void show_scene(const World& world);
  /// Every so many frames, what moves.
  void show(std::uint64_t index, const std::vector<double>& row, std::uint64_t time_ns);

 private:
  void show_wrench(std::uint16_t channel, const double* wrench, std::uint64_t time_ns);

  McapWriter& writer_;
  ShownColumns columns_;
  std::uint64_t frames_a_message_;
  struct WrenchChannels {
    std::uint16_t sent, computed;
  };
  std::vector<WrenchChannels> wrenches_;  // by hand
  std::uint32_t sequence_ = 0;
  std::uint16_t transforms_, scene_;
};

}  // namespace tactum::inline v0_1
