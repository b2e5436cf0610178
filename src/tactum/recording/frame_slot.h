#pragma once
/// What a frame hands to the writer's thread, and what it is in the file: the binary messages of a recording.
/// Each is what ROS 1 makes of the schema beside it: numbers one behind the other, little-endian, a list with
/// its length in 32 bits before it. docs/recording.md lists the fields.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tactum/devices/device.h"
#include "tactum/loop/loop.h"
#include "tactum/recording/frame_copy.h"
#include "tactum/recording/recorded_contacts.h"
#include "tactum/session/command.h"
#include "tactum/telemetry/frame_feed.h"
#include "tactum/telemetry/trace.h"

namespace tactum::inline v0_1 {

/// Contacts that a frame of a recording has at most.
inline constexpr std::size_t kRecordedContacts = 16;

/// What came into a frame, exactly, and what it left.
struct RecordedInput {
  DeviceSample sample;
  FrameTick tick;
  std::uint64_t hash = 0;     ///< state_hash() after the frame
  std::uint64_t dropped = 0;  ///< frames lost before this one, since the start
};

/// What came in from the second hand, or one after it, and what the frame reports of it.
struct RecordedHand {
  std::uint64_t index = 0;  ///< of the frame
  std::uint8_t hand = 0;    ///< counted from 0; the first is in RecordedInput
  HandSample sample;
  std::vector<double> report;  ///< put_hand_report()
};

/// A command, and the frame before which it was carried out.
struct RecordedCommand {
  std::uint64_t index = 0;
  SessionCommand command;
};

/// The state between two frames, from which a replay can begin.
struct RecordedSnapshot {
  std::uint64_t index = 0;   ///< of the frame that begins with it
  std::uint64_t layout = 0;  ///< layout_of_snapshots() of the program that took it
  /// In force then, in the order of setting_table(); those of each hand behind those of the hand before.
  std::vector<double> settings;
  std::string_view state;  ///< write_snapshot(); of another owner's memory
};

/// A frame on its way to the writer; its room is made once.
struct FrameSlot {
  RecordedInput input;  ///< its hash is the writer's to fill
  FrameCopy frame;
  std::vector<HandSample> other_samples;  ///< of the second hand and all after it
  std::size_t rows_end = 0;   ///< place behind the frame's rows in the ring of rows, counted from the start
  bool has_frame = true;      ///< false: only the snapshot behind it counts
  bool has_snapshot = false;  ///< one was taken after the frame (snapshot_room.h)
};

namespace recording {
inline constexpr std::string_view kRun = "/tactum/run";
inline constexpr std::string_view kInput = "/tactum/input";
inline constexpr std::string_view kHand = "/tactum/hand";
inline constexpr std::string_view kCommand = "/tactum/command";
inline constexpr std::string_view kReport = "/tactum/report";
inline constexpr std::string_view kFrame = "/tactum/frame";
inline constexpr std::string_view kContacts = "/tactum/contacts";
inline constexpr std::string_view kSnapshot = "/tactum/snapshot";
inline constexpr int kFormat = 1;  ///< of the messages; a reader takes no other

/// The definitions, as text: a comment and a line for each field.
std::string input_schema();
std::string hand_schema();
std::string command_schema();
std::string report_schema();
std::string frame_schema(const std::vector<TraceColumn>& columns);
std::string contacts_schema();
std::string snapshot_schema();

/// The messages. Those of report and frame are the numbers alone.
std::string input_message(const RecordedInput& input);
std::string hand_message(const RecordedHand& hand);
std::string command_message(const RecordedCommand& command);
std::string contacts_message(const RecordedContacts& contacts);
std::string numbers_message(const std::vector<double>& numbers);
std::string snapshot_message(const RecordedSnapshot& snapshot);

/// Back again; false where the bytes are not such a message.
bool read_input(std::string_view message, RecordedInput& input);
bool read_hand(std::string_view message, RecordedHand& hand);
bool read_command(std::string_view message, RecordedCommand& command);
bool read_numbers(std::string_view message, std::vector<double>& numbers);
/// The state stays where the message is.
bool read_snapshot_message(std::string_view message, RecordedSnapshot& snapshot);

/// What snapshots hold: equal where one program understands those of the other.
std::uint64_t layout_of_snapshots(const FrameState& state) noexcept;
}  // namespace recording

}  // namespace tactum::inline v0_1
