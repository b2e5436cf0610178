#pragma once
/// Records a session into a file, frame by frame.
///
///   loop thread    obeyed, frame_over --- numbers of free slots, of full ones ---> writer thread ---> file
///
/// The loop never waits: where no slot is free, since the disk is too slow, the frame is not recorded and is
/// counted. The loop only copies a frame (frame_copy.h); hash and numbers are made in the writer's thread.
/// The memory is set aside at the start (about 50 MB, 100 MB with many bodies). When the file cannot be
/// written any more the run goes on, nothing more is recorded, and trouble() says so once.

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tactum/base/spsc_ring.h"
#include "tactum/recording/frame_slot.h"
#include "tactum/recording/mcap_writer.h"
#include "tactum/recording/record_switch.h"
#include "tactum/recording/run_head.h"
#include "tactum/recording/shown_run.h"
#include "tactum/recording/snapshot_room.h"
#include "tactum/scene/scene_description.h"
#include "tactum/session/session.h"

namespace tactum::inline v0_1 {

class Recorder final : public RunListener {
 public:
  /// Frames that wait to be written, at most: four seconds at 1 kHz. Of a scene with many bodies as many as
  /// fit into kFrameBytes.
  static constexpr std::size_t kSlots = 4096;
  static constexpr std::size_t kFrameBytes = std::size_t{64} << 20;
  static constexpr std::size_t kRows = std::size_t{1} << 18;  ///< rows of contacts in all of them
  static constexpr double kChunk_s = 0.25;                    ///< of a run that is killed no more is lost

  /// Begins the file with the scene and every file it needs. The session was opened with `scene`, which was
  /// read from a text; it must outlive the recorder. It has not begun; or it has, reports to `through`, and
  /// the options say so.
  static Result<std::unique_ptr<Recorder>> open(const RecorderOptions& options, const SceneDescription& scene,
                                                Session& session, RecordSwitch* through = nullptr);
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void obeyed(std::uint64_t index, const SessionCommand& command) noexcept override;
  void frame_over(const DeviceSample& sample, const FrameTick& tick, std::span<const HandSample> others,
                  const FrameSource& frame, const StageClock* clock) noexcept override;

  /// For a run on the virtual clock, between two frames: nothing is lost, however slow the disk.
  void wait_for_room() const;
  /// Why nothing is recorded any more: once, then nothing.
  std::optional<Error> trouble();
  /// Writes what is left and ends the file; the run is over. Safe to call twice.
  void finish();

  std::uint64_t frames() const noexcept { return written_.load(std::memory_order_relaxed); }
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  /// The state is too large to be copied between two frames: a replay can only begin at the start.
  bool without_snapshots() const noexcept { return snapshots_.too_large(); }

 private:
  Recorder(const RecorderOptions& options, Session& session, RecordSwitch* through,
           std::unique_ptr<McapWriter> writer);
  void add_channels();
  void begin(const RunHead& head);
  void write_in_background();
  bool drain();
  std::optional<std::uint32_t> room_for(std::size_t rows) noexcept;
  void copy_rows(const FrameState& state, FrameSlot& slot) noexcept;
  void write(FrameSlot& slot);
  void write_frame(FrameSlot& slot, std::uint64_t time_ns);
  void write_other_hands(const FrameSlot& slot, std::uint64_t time_ns);
  void write_commands(std::uint64_t index);

  Session& session_;
  RecordSwitch* through_;  // null: the session itself reports
  bool midway_;            // of the loop's thread: no frame counts until there is a snapshot
  std::unique_ptr<McapWriter> writer_;
  SnapshotRoom snapshots_;
  FrameTrace trace_;
  std::optional<ShownRun> shown_;
  std::vector<FrameSlot> slots_;
  SpscRing<std::uint32_t> free_, full_;
  std::vector<CopiedRow> rows_;               // a ring; a frame's lie one behind the other
  std::size_t rows_taken_ = 0;                // of the loop's thread: places passed since the start
  std::atomic<std::size_t> rows_free_{0};     // ... and those that were written
  std::vector<ProxyBefore> proxies_;          // of the loop's thread, by hand
  std::vector<double> report_numbers_, row_;  // of the writer's thread, as the next
  RecordedContacts shown_contacts_;
  RecordedHand other_hand_;
  SpscRing<RecordedCommand> commands_;
  RecordedCommand waiting_;  // of the writer's thread: taken from the ring, of a later frame
  bool command_waits_ = false;
  std::uint64_t taken_ = 0;  // by the loop's thread
  std::atomic<std::uint64_t> written_{0}, dropped_{0}, passed_{0};
  std::atomic<bool> failed_{false}, ends_{false};
  std::mutex mutex_;  // of trouble_, between the writer's thread and the one that asks
  std::optional<Error> trouble_;
  std::uint16_t run_ = 0, input_ = 0, hand_ = 0, command_ = 0, report_ = 0, frame_ = 0, contacts_ = 0,
                snapshot_ = 0;
  std::thread thread_;
};

}  // namespace tactum::inline v0_1
