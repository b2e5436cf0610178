/// tactum replay FILE: the frames of a recording again, and whether they are the same.

#include "tactum/recording/replay.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands.h"
#include "tactum/recording/bisect.h"
#include "viewer/server/replay_viewer.h"
#include "watch.h"

namespace tactum {
namespace {

constexpr int kDiffers = 2;  // the exit code

struct ReplayCommand {
  std::string file;
  bool verify = false;
  std::string bisect;
  bool view = false;
  int port = 0;
  ReplayOptions replay;
};

McapFile open_recording(const std::string& path) {
  Result<McapFile> file = McapFile::open(path);
  if (!file) fail(file.error());
  return std::move(*file);
}

void print_extremes(const char* which, const RunExtremes& run, std::uint64_t frames) {
  fmt::print(
      "{:<9} largest force {:.6g} N, torque {:.6g} N m, stretch {:.6g} mm; touched in {} of {} frames\n",
      which, run.max_force_N, run.max_torque_Nm, run.max_stretch_m * 1e3, run.contact_frames, frames);
}

/// What is missing of the file; a recording that was cut is one all the same.
void report_end(const McapEnd& end) {
  if (end.complete) return;
  fmt::print(stderr, "{} {}\n", end.cut ? "The recording has no end:" : "The recording is damaged:",
             end.wrong ? end.wrong->message() : "");
}

/// The replay against another recording, or against other settings, down to what differs first.
void bisect_file(const ReplayCommand& command, const McapFile& file) {
  Result<Bisection> found = Error{};
  if (command.bisect.ends_with(".mcap")) {
    const McapFile other = open_recording(command.bisect);
    found = bisect_recordings(file, command.file, other, command.bisect);
  } else {
    ReplayOptions other = command.replay;
    other.settings = command.bisect;
    found = bisect_settings(file, command.file, command.replay, other);
  }
  if (!found) fail(found.error());
  for (const std::string& note : found->notes) fmt::print("{}\n", note);
  fmt::print("{} frames are the same to the bit\n", found->frames);
  if (found->difference) fmt::print("{}\n", sentence_of(*found->difference));
  for (const DifferingSetting& setting : found->settings) {
    fmt::print("setting {} was {} and is {}", setting.key, setting.before, setting.after);
    if (command.bisect.ends_with(".mcap"))
      fmt::print("\n");
    else
      fmt::print("; this one alone: {}\n", setting.alone ? sentence_of(*setting.alone) : "no frame differs");
  }
  if (found->difference) end_with(kDiffers);
}

/// Serves a page on which the recording is seen, until interrupted.
void view_file(const ReplayCommand& command, const McapFile& file) {
  Result<std::unique_ptr<ReplayedRun>> run = ReplayedRun::open(file, command.file, command.replay);
  if (!run) fail(run.error());
  report_end((*run)->tape().end());
  const double frame = command.replay.from_s / (*run)->tape().head().dt_s;
  if (const Result<void> there = (*run)->seek(static_cast<std::uint64_t>(frame + 0.5)); !there)
    fail(there.error());
  Result<std::unique_ptr<ReplayViewer>> viewer = ReplayViewer::open(std::move(*run), command.port);
  if (!viewer) fail(viewer.error());
  watch_for_interrupts();
  open_page(stdout, (*viewer)->server().address());
  while (!interrupted()) (*viewer)->poll(std::chrono::milliseconds(4));
}

void replay_file(const ReplayCommand& command) {
  const McapFile file = open_recording(command.file);
  if (!command.bisect.empty()) return bisect_file(command, file);
  if (command.view) return view_file(command, file);
  const Result<ReplayResult> replayed = replay(file, command.file, command.replay);
  if (!replayed) fail(replayed.error());
  const ReplayResult& run = *replayed;
  fmt::print("{}: {} frames at {:.0f} Hz, recorded {} by tactum {} ({}) on {}\n", run.head.scene, run.frames,
             1.0 / run.head.dt_s, run.head.date, run.head.version, run.head.compiler, run.head.device.name);
  for (const std::string& note : run.notes) fmt::print("{}\n", note);
  if (command.replay.from_s > 0.0)
    fmt::print("begins at frame {}, {:.3f} s after the start: {}\n", run.first,
               static_cast<double>(run.first) * run.head.dt_s,
               run.first > 0 ? "the last state that was recorded before" : "no state before is of use");
  report_end(run.end);
  if (run.gap)
    fmt::print(stderr, "Frames before frame {} were not recorded; the replay ends at frame {}.\n", *run.gap,
               run.first + run.frames);
  print_extremes("recorded", run.recorded, run.frames);
  print_extremes("replayed", run.replayed, run.frames);
  if (command.verify)
    fmt::print("{}\n", run.difference ? sentence_of(*run.difference)
                                      : fmt::format("all {} frames are the same to the bit", run.same));
  const bool damaged = !run.end.complete && !run.end.cut;
  if (damaged) end_with(1);
  if (command.verify && (run.difference || run.gap)) end_with(kDiffers);
}

}  // namespace

void add_replay(CLI::App& app) {
  auto options = std::make_shared<ReplayCommand>();
  CLI::App* command = app.add_subcommand("replay", "Compute the frames of a recording again");
  command->footer(
      "Exit codes: 0 done, 1 an error or a damaged file, 2 with --verify or --bisect a frame that differs or "
      "was not recorded, or the command line is wrong. A recording that was cut short is replayed as far as "
      "it "
      "goes.");
  command->add_option("FILE", options->file, "A recording of tactum feel --record")->required();
  CLI::Option* verify =
      command->add_flag("--verify", options->verify,
                        "Compare every frame to the bit, and name the first stage and field that differ");
  CLI::Option* view = command->add_flag(
      "--view", options->view, "Serve a page that shows the replay, with a time line, until interrupted");
  CLI::Option* bisect =
      command->add_option("--bisect", options->bisect,
                          "Find the first frame, stage and field that differ from another recording (.mcap), "
                          "as of another build; or "
                          "from a replay with the settings of a file, and which of these settings it is");
  view->excludes(verify)->excludes(bisect);
  bisect->excludes(verify);
  command->add_option("--port", options->port, "Serve the page at this port instead of a free one")
      ->check(whole_number_between(1, 65535, "a port"))
      ->needs(view);
  command
      ->add_option("--response", options->replay.response,
                   "Replay with another response for comparison: constraint or penalty")
      ->check(one_word_of({"constraint", "penalty"}));
  command->add_option("--settings", options->replay.settings,
                      "Put the settings of this file over those of the scene, for comparison");
  command
      ->add_option("--from", options->replay.from_s,
                   "Begin so many seconds after the start, at the last recorded state before")
      ->check(number_between(0.0, 1e9, "seconds"));
  command->callback([options] { replay_file(*options); });
}

}  // namespace tactum
