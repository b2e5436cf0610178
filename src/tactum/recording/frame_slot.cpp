#include "tactum/recording/frame_slot.h"

#include <fmt/format.h>

#include "tactum/base/hash.h"
#include "tactum/haptics/frame_snapshot.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/recording/byte_io.h"
#include "tactum/recording/frame_numbers.h"

namespace tactum::inline v0_1::recording {
namespace {

/// "[N]" behind a meaning, or nothing.
std::string unit_of(const std::string& unit) { return unit.empty() ? "" : fmt::format(" [{}]", unit); }

template <class... Numbers>
void put_all(ByteWriter& out, const Numbers&... numbers) {
  (out.number(numbers), ...);
}

void put_vector(ByteWriter& out, const Vec3& v) { put_all(out, v[0], v[1], v[2]); }

void take_vector(ByteReader& in, Vec3& v) {
  for (int i = 0; i < 3; ++i) v[i] = in.number<double>();
}

void put_sample(ByteWriter& out, const DeviceSample& sample) {
  put_all(out, sample.valid, sample.has_velocity, sample.motors_on, sample.buttons, sample.time_s);
  put_vector(out, sample.X_DH.p);
  for (int row = 0; row < 3; ++row) put_vector(out, sample.X_DH.R.row(row).transpose());
  put_vector(out, sample.V_DH.v);
  put_vector(out, sample.V_DH.w);
}

void take_sample(ByteReader& in, DeviceSample& sample) {
  for (bool* flag : {&sample.valid, &sample.has_velocity, &sample.motors_on}) *flag = in.number<bool>();
  sample.buttons = in.number<std::uint32_t>();
  sample.time_s = in.number<double>();
  take_vector(in, sample.X_DH.p);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) sample.X_DH.R(row, column) = in.number<double>();
  take_vector(in, sample.V_DH.v);
  take_vector(in, sample.V_DH.w);
}

constexpr const char* kSampleFields = R"(bool valid            # the read succeeded
bool has_velocity     # the device measures V_DH
bool motors_on        # the device says that it pushes
uint32 buttons        # bit 0 is the primary button
float64 time_s        # when the sample was measured, the loop's clock [s]
float64[3] p_DH_m     # the handle in D [m]
float64[9] R_DH       # its axes as columns, row by row
float64[3] v_DH_m_per_s    # velocity of the handle, axes of D [m/s]
float64[3] w_DH_rad_per_s  # angular velocity, axes of D [rad/s]
)";

std::string fields_of(const std::vector<ReportNumber>& numbers) {
  std::string text;
  for (const ReportNumber& number : numbers)
    text +=
        fmt::format("float64 {}  # {}{}\n", number.name, number.field->meaning, unit_of(number.field->unit));
  return text;
}

}  // namespace

std::string input_schema() {
  return std::string(
             R"(# What came into a frame from the device and the loop, to the bit: replay needs nothing else.
# Frames: D is the device's (x to the operator, y to the right, z up), H the handle.
uint64 index          # frames since the start
float64 now_s         # the loop's clock at the frame [s]
float64 period_s      # nominal time between frames [s]
bool late             # the frame came later than the loop allows
bool refused          # the device did not take the last wrench
bool stop             # the wrench is led to zero
)") + kSampleFields +
         R"(uint64 state_hash     # of everything the frame left, for --verify
uint64 dropped        # frames lost before this one, since the start
)";
}

std::string command_schema() {
  return R"(# A command of the page or of a program, carried out before the frame `index`.
uint64 index
uint8 kind            # 0 leads the hand, 1 lets it rest, 2 sets a setting
uint32 buttons        # of 0: bit 0 is the primary button
float64[3] p_WH_m     # of 0: the wanted place of the hand in the world [m]
float64[4] q_WH_wxyz  # of 0: its orientation there
string setting        # of 2: section and key, as in scene files
float64 value         # of 2: in the unit that the key ends with
uint8 hand            # of 0 and 1: counted from 0; missing in older recordings
)";
}

std::string hand_schema() {
  return std::string(
             R"(# What came into a frame from the second hand, or one after it, to the bit, and every field of the report
# that each hand has of its own. Frames as in tactum/Input, of this hand's device.
uint64 index          # frames since the start
uint8 hand            # counted from 0
bool refused          # its device did not take the last wrench
)") + kSampleFields +
         fields_of(hand_numbers());
}

std::string report_schema() {
  return "# The report of the frame, every field; axes and points as told.\n" + fields_of(report_numbers());
}

std::string frame_schema(const std::vector<TraceColumn>& columns) {
  std::string text =
      "# The frame as the columns of a trace (docs/trace.md): axes of the world, wrenches on the hand at the "
      "handle.\n# The end of a name is its unit.\n";
  for (const TraceColumn& column : columns)
    text += fmt::format("float64 {}  # {}\n", column.name, column.meaning);
  return text;
}

std::string contacts_schema() {
  return R"(# The contact points that push most, on the held part first. Axes of the world.
uint64 index
int32 left_out        # contacts beyond these
tactum/Contact[] contacts
================================================================================
MSG: tactum/Contact
int32 body_a          # the force acts on this body; numbers as in /tactum/run
int32 body_b
float64[3] p_W_m      # the point [m]
float64[3] n_BA_W     # from B to A, unit
float64 distance_m    # signed; negative is overlap [m]
float64 force_N       # along the normal, on A [N]
float64 cone_used     # fraction of the friction cone in use, 0 to 1
int32 grip            # 0 no friction, 1 sticks, 2 slips
)";
}

std::string snapshot_schema() {
  return R"(# Everything that a frame carries to the next, so that a replay can begin before the frame `index`.
uint64 index
uint64 layout         # of `state`; programs with another one begin a replay at the start
float64[] settings    # in force, in the order of `settings` in /tactum/run, in their units; of each hand in turn
uint8[] state         # as src/tactum/base/carried_state.h writes it
)";
}

std::string input_message(const RecordedInput& input) {
  std::string message;
  ByteWriter out(message);
  const FrameTick& tick = input.tick;
  put_all(out, tick.index, tick.now_s, tick.period_s, tick.late, tick.refused, tick.stop);
  put_sample(out, input.sample);
  put_all(out, input.hash, input.dropped);
  return message;
}

bool read_input(std::string_view message, RecordedInput& input) {
  ByteReader in(message);
  FrameTick& tick = input.tick;
  tick.index = in.number<std::uint64_t>();
  tick.now_s = in.number<double>();
  tick.period_s = in.number<double>();
  for (bool* flag : {&tick.late, &tick.refused, &tick.stop}) *flag = in.number<bool>();
  take_sample(in, input.sample);
  input.hash = in.number<std::uint64_t>();
  input.dropped = in.number<std::uint64_t>();
  return in.good() && in.done();
}

std::string hand_message(const RecordedHand& hand) {
  std::string message;
  ByteWriter out(message);
  put_all(out, hand.index, hand.hand, hand.sample.refused);
  put_sample(out, hand.sample);
  for (const double number : hand.report) out.number(number);
  return message;
}

bool read_hand(std::string_view message, RecordedHand& hand) {
  ByteReader in(message);
  hand.index = in.number<std::uint64_t>();
  hand.hand = in.number<std::uint8_t>();
  hand.sample.refused = in.number<bool>();
  take_sample(in, hand.sample);
  hand.report.resize(hand_numbers().size());
  for (double& number : hand.report) number = in.number<double>();
  return in.good() && in.done();
}

std::string command_message(const RecordedCommand& recorded) {
  const SessionCommand& command = recorded.command;
  const std::span<const SettingInfo> table = setting_table();
  std::string setting;
  if (command.kind == SessionCommand::Kind::kSet && command.setting >= 0 &&
      command.setting < static_cast<int>(table.size())) {
    const SettingInfo& info = table[static_cast<std::size_t>(command.setting)];
    setting = info.section[0] == '\0' ? info.key : fmt::format("{}.{}", info.section, info.key);
  }
  std::string message;
  ByteWriter out(message);
  put_all(out, recorded.index, static_cast<std::uint8_t>(command.kind), command.buttons);
  for (const double number : command.p_WH) out.number(number);
  for (const double number : command.quat_wxyz_WH) out.number(number);
  out.text(setting);
  out.number(command.value);
  out.number(static_cast<std::uint8_t>(command.hand));
  return message;
}

bool read_command(std::string_view message, RecordedCommand& recorded) {
  ByteReader in(message);
  SessionCommand& command = recorded.command;
  recorded.index = in.number<std::uint64_t>();
  const auto kind = in.number<std::uint8_t>();
  command.buttons = in.number<std::uint32_t>();
  for (double& number : command.p_WH) number = in.number<double>();
  for (double& number : command.quat_wxyz_WH) number = in.number<double>();
  command.setting = setting_called(in.text());
  command.value = in.number<double>();
  command.hand = in.done() ? 0 : in.number<std::uint8_t>();  // older recordings have one hand that is led
  if (kind > static_cast<std::uint8_t>(SessionCommand::Kind::kSet)) return false;
  command.kind = static_cast<SessionCommand::Kind>(kind);
  return in.good() && in.done();
}

std::string contacts_message(const RecordedContacts& recorded) {
  std::string message;
  ByteWriter out(message);
  put_all(out, recorded.index, static_cast<std::int32_t>(recorded.left_out),
          static_cast<std::uint32_t>(recorded.contacts.size()));
  for (const ShownContact& contact : recorded.contacts) {
    put_all(out, contact.body_a, contact.body_b);
    put_vector(out, contact.p_W);
    put_vector(out, contact.n_W);
    put_all(out, contact.distance_m, contact.force_N, contact.cone_used,
            static_cast<std::int32_t>(contact.grip));
  }
  return message;
}

std::string numbers_message(const std::vector<double>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)};
}

std::string snapshot_message(const RecordedSnapshot& snapshot) {
  std::string message;
  ByteWriter out(message);
  put_all(out, snapshot.index, snapshot.layout, static_cast<std::uint32_t>(snapshot.settings.size()));
  for (const double value : snapshot.settings) out.number(value);
  out.text(snapshot.state);
  return message;
}

bool read_snapshot_message(std::string_view message, RecordedSnapshot& snapshot) {
  ByteReader in(message);
  snapshot.index = in.number<std::uint64_t>();
  snapshot.layout = in.number<std::uint64_t>();
  const auto count = in.number<std::uint32_t>();
  if (count > message.size() / sizeof(double)) return false;
  snapshot.settings.resize(count);
  for (double& value : snapshot.settings) value = in.number<double>();
  snapshot.state = in.text();
  return in.good() && in.done();
}

std::uint64_t layout_of_snapshots(const FrameState& state) noexcept {
  Hash hash;
  const std::uint64_t layout = snapshot_layout(state);
  hash.add_bytes(&layout, sizeof layout);
  for (const SettingInfo& setting : setting_table()) {
    hash.add_bytes(setting.section, std::char_traits<char>::length(setting.section));
    hash.add_bytes(setting.key, std::char_traits<char>::length(setting.key));
  }
  return hash.value();
}

bool read_numbers(std::string_view message, std::vector<double>& numbers) {
  ByteReader in(message);
  for (double& number : numbers) number = in.number<double>();
  return in.good() && in.done();
}

}  // namespace tactum::inline v0_1::recording
