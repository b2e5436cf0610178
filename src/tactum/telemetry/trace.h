#pragma once
/// A run as a table: one row a frame, one column a number. Everything that the report of a frame has, the
/// poses of hand and proxy, the wrench after every stage, and, if wanted, every body. Columns are named
/// `quantity_axis_unit`: hand_px_m, sent_fx_N, sent_tx_Nm, body_vz_m_per_s.
///
///   loop thread    take(frame) --- every frame ---> ring of rows ---> pop, in order ---> CSV
///
/// Vectors have the axes of the world W, wrenches act on the hand at the handle, as the device has them
/// (workspace_scale.h); only device_* is the pose of the handle in the frame of the device D. The columns of
/// a trace are a function of its scene: a program finds them by name.

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tactum/telemetry/channels.h"
#include "tactum/telemetry/run_record.h"

namespace tactum::inline v0_1 {

struct TraceColumn {
  std::string name;     ///< "sent_fx_N"
  std::string meaning;  ///< one line
};

/// Three numbers of a row, from a column on.
inline Vec3 vector_at(std::span<const double> row, int column) {
  const auto i = static_cast<std::size_t>(column);
  return {row[i], row[i + 1], row[i + 2]};
}
/// The quaternion of an orientation, from its column _qw on.
inline Quat turn_at(std::span<const double> row, int column) {
  const auto i = static_cast<std::size_t>(column);
  return Quat(row[i], row[i + 1], row[i + 2], row[i + 3]).normalized();
}

/// What a row tells of one hand.
struct TracedHand {
  const HandReport* report = nullptr;
  const HandTracking* hand = nullptr;
  const PortState* port = nullptr;
  const Pose* X_WH_proxy_before = nullptr;  ///< of the frame before; null where it held nothing then [m]
};

/// What a row is made of: a frame, or a copy of one, which another thread may write down later.
struct TracedFrame {
  const FrameReport* report = nullptr;
  std::span<const TracedHand> hands;  ///< as many as the trace has; the first one's report is of the frame's
  std::span<const Pose> X_WB;         ///< of every body [m]
  std::span<const Twist> V_WB;        ///< the same [m/s, rad/s]
  double workspace_scale = 1.0;
  std::array<std::int64_t, kStageCount> stage_ns{};  ///< by Stage; zero where nobody takes them [ns]
};

/// The times of the stages of a frame; zero without a clock [ns].
std::array<std::int64_t, kStageCount> stage_times(const StageClock* clock) noexcept;

class FrameTrace {
 public:
  static constexpr std::size_t kFrames = 4096;  ///< four seconds at 1 kHz until they are popped

  /// `bodies`: the pose and twist of every body as well. Allocates everything that it will ever need: a ring
  /// of `frames` rows, none where rows are only written. The columns of the second hand begin with h2_, and
  /// so on.
  FrameTrace(const World& world, double dt_s, bool bodies, std::size_t frames = kFrames,
             std::size_t hands = 1);

  const std::vector<TraceColumn>& columns() const noexcept { return columns_; }
  std::size_t width() const noexcept { return columns_.size(); }
  /// The place of a column; -1 when there is none of this name.
  int column(std::string_view name) const noexcept;

  /// The loop's thread, after the frame. `clock` may be null: the times of stages are then zero. No
  /// allocation, no lock, no clock. When the ring is full the row is lost and counted.
  void take(const FrameSource& frame, const StageClock* clock) noexcept;
  /// The row of a frame, past the ring: `width()` numbers.
  void write(const TracedFrame& frame, std::span<double> row) const noexcept;

  /// One other thread: the oldest row that was not popped, `width()` numbers; false when there is none.
  bool pop(std::span<double> row) noexcept;
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  void remember_proxies(const FrameSource& frame) noexcept;

  std::vector<TraceColumn> columns_;
  std::size_t frames_;
  double dt_s_;
  bool bodies_;
  std::vector<TracedHand> hands_;  // of the frame that is taken
  std::vector<Pose> proxies_;      // of the frame before, by hand: for their velocities
  std::vector<double> rows_;
  alignas(64) std::atomic<std::size_t> head_{0};  // the loop's line
  std::atomic<std::uint64_t> dropped_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};  // the reader's
};

}  // namespace tactum::inline v0_1
