/// tactum replay FILE: the frames of a recording again, and whether they are the same.

#include "tactum/recording/replay.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands.h"

namespace tactum {
namespace {

constexpr int kDiffers = 2;  // the exit code

struct ReplayCommand {
  std::string file;
  bool verify = false;
  ReplayOptions replay;
};

McapFile open_recording(const std::string& path) {
  Result<McapFile> file = McapFile::open(path);
  if (!file) fail(file.error());
  return std::move(*file);
}

std::string sentence_of(const ReplayDifference& difference) {
  if (difference.field.empty())
    return fmt::format(
        "frame {} is the first that differs: in what it carries to the next, while every field of its report "
        "is the same",
        difference.frame);
  return fmt::format("frame {} is the first that differs: stage \"{}\", field {} ({}) was {} and is {}",
                     difference.frame, difference.stage, difference.field, difference.meaning,
                     difference.recorded, difference.replayed);
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

void replay_file(const ReplayCommand& command) {
  const McapFile file = open_recording(command.file);
  const Result<ReplayResult> replayed = replay(file, command.file, command.replay);
  if (!replayed) fail(replayed.error());
  const ReplayResult& run = *replayed;
  fmt::print("{}: {} frames at {:.0f} Hz, recorded {} by tactum {} ({}) on {}\n", run.head.scene, run.frames,
             1.0 / run.head.dt_s, run.head.date, run.head.version, run.head.compiler, run.head.device.name);
  for (const std::string& note : run.notes) fmt::print("{}\n", note);
  report_end(run.end);
  if (run.gap)
    fmt::print(stderr, "Frames before frame {} were not recorded; the replay ends at frame {}.\n", *run.gap,
               run.frames);
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
      "Exit codes: 0 done, 1 an error or a damaged file, 2 with --verify a frame that differs or was not "
      "recorded, or the command line is wrong. A recording that was cut short is replayed as far as it "
      "goes.");
  command->add_option("FILE", options->file, "A recording of tactum feel --record")->required();
  command->add_flag("--verify", options->verify,
                    "Compare every frame to the bit, and name the first stage and field that differ");
  command
      ->add_option("--response", options->replay.response,
                   "Replay with another response for comparison: constraint or penalty")
      ->check(one_word_of({"constraint", "penalty"}));
  command->add_option("--settings", options->replay.settings,
                      "Put the settings of this file over those of the scene, for comparison");
  command->callback([options] { replay_file(*options); });
}

}  // namespace tactum
