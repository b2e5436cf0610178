#pragma once
/// A frame as the loop's thread hands it to the writer's: copied as it lies in memory, since the loop has no
/// time to make numbers of it. Hash, report and columns are made of the copy, in the writer's thread.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tactum/haptics/frame_state.h"
#include "tactum/telemetry/channels.h"
#include "tactum/telemetry/frame_feed.h"
#include "tactum/telemetry/trace.h"

namespace tactum::inline v0_1 {

/// Where a hand's proxy was in the frame before.
struct ProxyBefore {
  Pose X_WH;             ///< [m]
  bool grasped = false;  ///< whether the hand held something then
};

/// What a frame leaves with a hand.
struct HandCopy {
  HandTracking hand;
  SmoothingState smoothing;
  PortState port;
  SafetyState safety;
  ProxyBefore before;
};

struct FrameCopy {
  /// Makes the room: of so many bodies and hands.
  FrameCopy(std::size_t bodies, std::size_t hand_count);

  FrameReport report;
  std::vector<HandReport> other_reports;  ///< of the second hand and all after it
  std::vector<HandCopy> hands;            ///< of all
  WorldState world;                       ///< without the joints
  std::span<const CopiedRow> rows;        ///< of another owner's memory
  int grasped_body = -1;                  ///< of the first hand; -1: none
  double load_work_J = 0.0;               ///< FrameState::load_work_J
  double stored_J = 0.0;                  ///< Response::stored_J()
  double workspace_scale = 1.0;
  double dt_s = 0.0;  ///< from frame to frame [s]
  std::array<std::int64_t, kStageCount> stage_ns{};

  /// Bytes that one of so many bodies and hands takes up, beside its rows.
  static std::size_t bytes(std::size_t bodies, std::size_t hand_count) noexcept;
};

/// Copies a frame, but for its rows. The loop's thread may call it: it allocates nothing. `clock` may be
/// null. `proxies` are those of the frame before, by hand; they become those of this one. Those of a frame
/// that is not copied are remembered all the same.
void copy_frame(const FrameSource& frame, const StageClock* clock, std::span<ProxyBefore> proxies,
                FrameCopy& to) noexcept;
void remember_proxies(const FrameSource& frame, std::span<ProxyBefore> proxies) noexcept;

/// The row that the frame is in a trace.
void write_row(const FrameTrace& trace, const FrameCopy& frame, std::span<double> row);

}  // namespace tactum::inline v0_1
