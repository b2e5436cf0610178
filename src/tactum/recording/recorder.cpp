#include "tactum/recording/recorder.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>

#include "tactum/base/hash.h"
#include "tactum/mesh/mapped_file.h"
#include "tactum/recording/frame_numbers.h"
#include "tactum/recording/run_head.h"
#include "tactum/scene/scene_files.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kCommandsInRing = 4096;
constexpr std::size_t kFullChunk = std::size_t{1} << 20;  // bytes; a chunk ends when it has so many

std::uint64_t time_of(const FrameTick& tick) {
  return tick.now_s > 0.0 && tick.now_s < 1e9 ? static_cast<std::uint64_t>(std::llround(tick.now_s * 1e9))
                                              : 0;
}

std::uint64_t hash_of(std::string_view bytes) {
  Hash hash;
  hash.add_bytes(bytes.data(), bytes.size());
  return hash.value();
}

/// Puts one file into the recording, and into the list of its head.
void attach(McapWriter& writer, RunHead& head, const std::string& attachment, const std::string& name,
            std::string_view data) {
  const bool text = attachment.ends_with(".toml");
  writer.add_attachment(
      {attachment, text ? "application/toml" : "application/octet-stream", std::string(data)});
  head.files.push_back({attachment, name, hash_of(data)});
}

Result<void> attach_files(McapWriter& writer, RunHead& head, const SceneDescription& scene) {
  namespace fs = std::filesystem;
  attach(writer, head, kSceneAttachment, "", scene.source.text);
  if (!scene.source.changes.empty()) attach(writer, head, kChangesAttachment, "", scene.source.changes);
  const Result<std::vector<SceneFile>> files = files_of(scene);
  if (!files) return files.error();
  for (std::size_t i = 0; i < files->size(); ++i) {
    const SceneFile& file = (*files)[i];
    const fs::path path(file.path);
    const auto attach_one = [&](const fs::path& from, const std::string& as, const std::string& name) {
      const Result<MappedFile> bytes = MappedFile::open(from.string());
      if (!bytes) return Result<void>(bytes.error());
      attach(writer, head, fmt::format("files/{}/{}", i, as), name, bytes->bytes());
      return Result<void>();
    };
    if (Result<void> done = attach_one(path, path.filename().string(), file.name); !done) return done;
    for (const std::string& beside : file.beside)
      if (Result<void> done = attach_one(path.parent_path() / beside, beside, ""); !done) return done;
  }
  return {};
}

std::vector<FrameSlot> made_slots(const Session& session) {
  const std::size_t bodies = session.scene().world.bodies.size(), hands = session.hands();
  const std::size_t fit = Recorder::kFrameBytes / FrameCopy::bytes(bodies, hands);
  std::vector<FrameSlot> slots;
  slots.reserve(std::clamp(fit, std::size_t{16}, Recorder::kSlots));
  while (slots.size() < slots.capacity())
    slots.push_back({{}, FrameCopy(bodies, hands), std::vector<HandSample>(hands - 1)});
  return slots;
}

}  // namespace

Recorder::Recorder(const RecorderOptions& options, Session& session, RecordSwitch* through,
                   std::unique_ptr<McapWriter> writer)
    : session_(session),
      through_(through),
      midway_(options.midway.has_value()),
      writer_(std::move(writer)),
      snapshots_(session.state(), options.midway ? options.midway->frame : session.scene().settings,
                 options.snapshot_every_s, midway_),
      trace_(session.scene().world, session.scene().settings.dt_s, true, 0, session.hands()),
      slots_(made_slots(session)),
      free_(slots_.size()),
      full_(slots_.size()),
      rows_(kRows),
      proxies_(session.hands()),
      report_numbers_(report_numbers().size()),
      row_(trace_.width()),
      commands_(kCommandsInRing) {
  shown_contacts_.contacts.reserve(kRecordedContacts);
  other_hand_.report.resize(hand_numbers().size());
  for (std::uint32_t slot = 0; slot < slots_.size(); ++slot) free_.push(slot);
}

Result<std::unique_ptr<Recorder>> Recorder::open(const RecorderOptions& options,
                                                 const SceneDescription& scene, Session& session,
                                                 RecordSwitch* through) {
  if (scene.source.text.empty())
    return Error{"only a scene that was read from a text can be recorded", "one made in code",
                 "a scene file, a built-in scene or a mesh", scene.name};
  Result<std::unique_ptr<McapWriter>> writer =
      McapWriter::open(options.path, "", "tactum " + options.version);
  if (!writer) return writer.error();
  std::unique_ptr<Recorder> recorder(new Recorder(options, session, through, std::move(*writer)));
  RunHead head = head_of(session, scene.source.file, options, recorder->trace_.columns());
  if (Result<void> attached = attach_files(*recorder->writer_, head, scene); !attached)
    return attached.error();
  recorder->begin(head);
  if (recorder->writer_->trouble()) return *recorder->writer_->trouble();
  recorder->thread_ = std::thread([&self = *recorder] { self.write_in_background(); });
  if (through != nullptr)
    through->lead_to(recorder.get());
  else
    session.report_to(recorder.get());
  return recorder;
}

Recorder::~Recorder() { finish(); }

void Recorder::begin(const RunHead& head) {
  writer_->add_metadata("tactum", {{"version", head.version},
                                   {"scene", head.scene},
                                   {"compiler", head.compiler},
                                   {"format", std::to_string(recording::kFormat)}});
  add_channels();
  writer_->add_message(run_, 0, head_text(head));
  shown_->show_scene(session_.scene().world);
  writer_->end_chunk();
}

void Recorder::add_channels() {
  using namespace recording;
  const auto add = [&](const char* schema, const std::string& text, std::string_view topic) {
    const std::uint16_t id = writer_->add_schema({schema, "ros1msg", text});
    return writer_->add_channel({id, std::string(topic), "ros1", {}});
  };
  const std::uint16_t run = writer_->add_schema({"tactum.Run", "jsonschema", R"({"type":"object"})"});
  run_ = writer_->add_channel({run, std::string(kRun), "json", {}});
  input_ = add("tactum/Input", input_schema(), kInput);
  if (session_.hands() > 1) hand_ = add("tactum/Hand", hand_schema(), kHand);
  command_ = add("tactum/Command", command_schema(), kCommand);
  report_ = add("tactum/Report", report_schema(), kReport);
  frame_ = add("tactum/Frame", frame_schema(trace_.columns()), kFrame);
  contacts_ = add("tactum/Contacts", contacts_schema(), kContacts);
  snapshot_ = add("tactum/Snapshot", snapshot_schema(), kSnapshot);
  shown_.emplace(*writer_, session_.scene().world, session_.scene().settings.dt_s, trace_.columns(),
                 session_.hands());
}

void Recorder::obeyed(std::uint64_t index, const SessionCommand& command) noexcept {
  if (failed_.load(std::memory_order_relaxed) || midway_) return;
  if (!commands_.push({index, command})) dropped_.fetch_add(1, std::memory_order_relaxed);
}

/// A free slot, where there is one, and room for so many rows.
std::optional<std::uint32_t> Recorder::room_for(std::size_t rows) noexcept {
  // A frame's rows do not go around the ring's end: those before it are passed over.
  const std::size_t to_end = rows_.size() - rows_taken_ % rows_.size();
  const std::size_t from = rows > to_end ? rows_taken_ + to_end : rows_taken_;
  if (from + rows - rows_free_.load(std::memory_order_acquire) > rows_.size()) return {};
  std::uint32_t place = 0;
  if (!free_.pop(place)) return {};
  rows_taken_ = from;
  return place;
}

void Recorder::copy_rows(const FrameState& state, FrameSlot& slot) noexcept {
  const std::span<const ContactRow> rows = state.response.rows();
  CopiedRow* const to = rows_.data() + rows_taken_ % rows_.size();
  slot.frame.rows = {to, rows.size()};
  tactum::copy_rows(rows, state.response.friction_uses(), to);
  rows_taken_ += rows.size();
  slot.rows_end = rows_taken_;
}

void Recorder::frame_over(const DeviceSample& sample, const FrameTick& tick,
                          std::span<const HandSample> others, const FrameSource& frame,
                          const StageClock* clock) noexcept {
  if (failed_.load(std::memory_order_relaxed)) return;
  const std::optional<std::uint32_t> place = room_for(frame.state.response.rows().size());
  if (!place) {
    remember_proxies(frame, proxies_);
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  FrameSlot& slot = slots_[*place];
  slot.has_snapshot = snapshots_.take(tick.index + 1, frame.state, frame.settings, session_.scene().safety);
  slot.has_frame = !midway_;
  midway_ = midway_ && !slot.has_snapshot;
  slot.input.sample = sample;
  slot.input.tick = tick;
  slot.input.dropped = dropped();
  std::copy(others.begin(), others.end(), slot.other_samples.begin());
  copy_frame(frame, clock, proxies_, slot.frame);
  copy_rows(frame.state, slot);
  ++taken_;
  full_.push(*place);
}

void Recorder::write_in_background() {
  // A file that may grow no more is told by the write, not by a signal that ends the program.
  sigset_t signals;
  sigfillset(&signals);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  auto last = std::chrono::steady_clock::now();
  while (true) {
    const bool ends = ends_.load(std::memory_order_acquire);  // before the last look at the ring
    const bool any = drain();
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - last).count() >= kChunk_s) {
      writer_->end_chunk();
      last = now;
    }
    if (ends) writer_->close();
    if (writer_->trouble() && !failed_.exchange(true)) {
      const std::lock_guard lock(mutex_);
      trouble_ = writer_->trouble();
    }
    if (ends) return;
    snapshots_.make_room();
    if (!any) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

bool Recorder::drain() {
  std::uint32_t place = 0;
  bool any = false;
  while (full_.pop(place)) {
    any = true;
    FrameSlot& slot = slots_[place];
    if (!failed_.load(std::memory_order_relaxed)) write(slot);
    rows_free_.store(slot.rows_end, std::memory_order_release);
    passed_.fetch_add(1, std::memory_order_release);
    free_.push(place);
    if (writer_->gathered() >= kFullChunk) writer_->end_chunk();
    if (writer_->trouble()) break;
  }
  return any;
}

void Recorder::write(FrameSlot& slot) {
  const std::uint64_t time_ns = time_of(slot.input.tick);
  if (slot.has_frame) write_frame(slot, time_ns);
  if (!slot.has_snapshot) return;
  writer_->add_message(snapshot_, time_ns, recording::snapshot_message(snapshots_.taken()));
  snapshots_.release();
}

/// Makes numbers of the copied frame, and messages of these.
void Recorder::write_frame(FrameSlot& slot, std::uint64_t time_ns) {
  using namespace recording;
  const FrameCopy& frame = slot.frame;
  slot.input.hash = state_hash(frame);
  put_report(frame.report, report_numbers_.data());
  write_row(trace_, frame, row_);
  shown_contacts_.index = slot.input.tick.index;
  shown_contacts_.left_out = show_contacts(frame.rows, frame.grasped_body, acted_s(frame.report, frame.dt_s),
                                           kRecordedContacts, shown_contacts_.contacts);
  write_commands(slot.input.tick.index);
  writer_->add_message(input_, time_ns, input_message(slot.input));
  write_other_hands(slot, time_ns);
  writer_->add_message(report_, time_ns, numbers_message(report_numbers_));
  writer_->add_message(frame_, time_ns, numbers_message(row_));
  if (!shown_contacts_.contacts.empty())
    writer_->add_message(contacts_, time_ns, contacts_message(shown_contacts_));
  shown_->show(slot.input.tick.index, row_, time_ns);
  written_.fetch_add(1, std::memory_order_relaxed);
}

/// Before the report, with which the frame counts as whole.
void Recorder::write_other_hands(const FrameSlot& slot, std::uint64_t time_ns) {
  for (std::size_t i = 0; i < slot.other_samples.size(); ++i) {
    other_hand_.index = slot.input.tick.index;
    other_hand_.hand = static_cast<std::uint8_t>(i + 1);
    other_hand_.sample = slot.other_samples[i];
    put_hand_report(slot.frame.other_reports[i], other_hand_.report.data());
    writer_->add_message(hand_, time_ns, recording::hand_message(other_hand_));
  }
}

/// The commands carried out before the frame. A later one waits for its own.
void Recorder::write_commands(std::uint64_t index) {
  while (command_waits_ || commands_.pop(waiting_)) {
    command_waits_ = waiting_.index > index;
    if (command_waits_) return;
    const double dt_s = session_.rate_Hz() > 0.0 ? 1.0 / session_.rate_Hz() : 0.0;
    const auto time_ns = static_cast<std::uint64_t>(static_cast<double>(waiting_.index) * dt_s * 1e9);
    writer_->add_message(command_, time_ns, recording::command_message(waiting_));
  }
}

void Recorder::wait_for_room() const {
  const auto full = [this] { return taken_ - passed_.load(std::memory_order_acquire) + 2 > slots_.size(); };
  const auto rows_full = [this] {  // no frame has half of the rows
    return rows_taken_ - rows_free_.load(std::memory_order_acquire) > rows_.size() / 2;
  };
  while (!failed_.load(std::memory_order_relaxed) && (full() || rows_full() || snapshots_.in_use()))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

std::optional<Error> Recorder::trouble() {
  if (!failed_.load(std::memory_order_relaxed)) return {};
  const std::lock_guard lock(mutex_);
  return std::exchange(trouble_, std::nullopt);
}

void Recorder::finish() {
  if (!thread_.joinable()) return;
  if (through_ != nullptr)
    through_->lead_to(nullptr);
  else
    session_.report_to(nullptr);
  ends_.store(true, std::memory_order_release);
  thread_.join();
}

}  // namespace tactum::inline v0_1
