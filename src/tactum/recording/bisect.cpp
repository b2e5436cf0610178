#include "tactum/recording/bisect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/haptics/setting_table.h"
#include "tactum/recording/frame_numbers.h"
#include "tactum/recording/recording_tape.h"
#include "tactum/recording/replayed_run.h"

namespace tactum::inline v0_1 {
namespace {

/// In what two heads differ beside the settings.
std::vector<std::string> notes_on(const RunHead& before, const RunHead& after) {
  std::vector<std::string> notes;
  const auto compare = [&](const char* what, const std::string& a, const std::string& b) {
    if (a != b) notes.push_back(fmt::format("the {} was \"{}\" and is \"{}\"", what, a, b));
  };
  compare("version of the program", before.version, after.version);
  compare("compiler", before.compiler, after.compiler);
  compare("scene", before.scene, after.scene);
  compare("device", before.device.name, after.device.name);
  for (std::size_t i = 0; i < std::min(before.other_devices.size(), after.other_devices.size()); ++i)
    compare(fmt::format("device of hand {}", i + 2).c_str(), before.other_devices[i].name,
            after.other_devices[i].name);
  compare("grip", before.grip, after.grip);
  if (before.dt_s != after.dt_s)
    notes.push_back(fmt::format("the step was {} s and is {} s", before.dt_s, after.dt_s));
  for (const RecordedFile& file : after.files) {
    const auto same = std::find_if(before.files.begin(), before.files.end(), [&](const RecordedFile& other) {
      return other.attachment == file.attachment;
    });
    if (same == before.files.end() || same->hash != file.hash)
      notes.push_back(fmt::format("the file \"{}\" is another", file.attachment));
  }
  return notes;
}

std::vector<DifferingSetting> differing(const std::vector<std::pair<std::string, double>>& before,
                                        const std::vector<std::pair<std::string, double>>& after) {
  std::vector<DifferingSetting> settings;
  for (const auto& [key, value] : after)
    for (const auto& [other, was] : before)
      if (other == key && was != value) settings.push_back({key, was, value, {}});
  return settings;
}

std::vector<std::pair<std::string, double>> settings_of(const ReplayedRun& run) {
  return settings_in_force(run.simulation().settings(), run.scene().safety);
}

/// Steps both runs, from the same frame on, until a frame differs.
Result<std::optional<FrameDifference>> first_difference(ReplayedRun& before, ReplayedRun& after,
                                                        std::uint64_t& same) {
  std::vector<double> a(report_numbers().size()), b(a.size());
  while (true) {
    const Result<const TapeFrame*> one = before.step();
    const Result<const TapeFrame*> other = after.step();
    if (!one) return one.error();
    if (!other) return other.error();
    if (*one == nullptr || *other == nullptr) return std::optional<FrameDifference>{};
    const Simulation &first = before.simulation(), &second = after.simulation();
    put_report(first.report(), a.data());
    put_report(second.report(), b.data());
    const std::uint64_t index = second.report().index;
    if (std::optional<FrameDifference> found = difference_of(index, a, b)) return found;
    if (state_hash(first.report(), first.state()) != state_hash(second.report(), second.state())) {
      FrameDifference hidden;
      hidden.frame = index;
      return std::optional<FrameDifference>{hidden};
    }
    ++same;
  }
}

}  // namespace

Result<Bisection> bisect_recordings(const McapSource& before, const std::string& name_before,
                                    const McapSource& after, const std::string& name_after) {
  Result<std::unique_ptr<RecordingTape>> one = RecordingTape::open(before, name_before);
  if (!one) return one.error();
  Result<std::unique_ptr<RecordingTape>> other = RecordingTape::open(after, name_after);
  if (!other) return other.error();
  RecordingTape &a = **one, &b = **other;
  if (std::max(a.first(), b.first()) >= std::min(a.past(), b.past()))
    return Error{"the recordings have no frame in common",
                 fmt::format("frames {} to {} and {} to {}", a.first(), a.past(), b.first(), b.past()), "",
                 name_after};
  Bisection bisection;
  bisection.notes = notes_on(a.head(), b.head());
  bisection.settings = differing(a.head().settings, b.head().settings);
  Result<const TapeFrame*> left = a.next(), right = b.next();
  while (left && right && *left != nullptr && *right != nullptr) {
    const std::uint64_t at = (*left)->input.tick.index, there = (*right)->input.tick.index;
    if (at < there) {
      left = a.next();
      continue;
    }
    if (there < at) {
      right = b.next();
      continue;
    }
    bisection.difference = difference_of((*left)->input, (*right)->input);
    const std::vector<RecordedHand>&ours = (*left)->others, &theirs = (*right)->others;
    for (std::size_t i = 0; i < std::min(ours.size(), theirs.size()) && !bisection.difference; ++i)
      bisection.difference = difference_of(ours[i], theirs[i]);
    if (!bisection.difference) bisection.difference = difference_of(at, (*left)->report, (*right)->report);
    if (!bisection.difference && (*left)->input.hash != (*right)->input.hash)
      bisection.difference.emplace().frame = at;
    if (bisection.difference) break;
    ++bisection.frames;
    left = a.next();
    right = b.next();
  }
  if (!left) return left.error();
  if (!right) return right.error();
  return bisection;
}

Result<Bisection> bisect_settings(const McapSource& source, const std::string& name,
                                  const ReplayOptions& before, const ReplayOptions& after) {
  Result<std::unique_ptr<ReplayedRun>> one = ReplayedRun::open(source, name, before);
  if (!one) return one.error();
  Result<std::unique_ptr<ReplayedRun>> other = ReplayedRun::open(source, name, after);
  if (!other) return other.error();
  Bisection bisection;
  bisection.settings = differing(settings_of(**one), settings_of(**other));
  Result<std::optional<FrameDifference>> difference = first_difference(**one, **other, bisection.frames);
  if (!difference) return difference.error();
  bisection.difference = std::move(*difference);
  for (DifferingSetting& setting : bisection.settings) {
    ReplayOptions changed = before;
    changed.changed.emplace_back(setting_called(setting.key), setting.after);
    Result<std::unique_ptr<ReplayedRun>> alone = ReplayedRun::open(source, name, changed);
    if (!alone) return alone.error();
    std::uint64_t same = 0;
    if (Result<void> again = (*one)->restore(-1); !again) return again.error();
    Result<std::optional<FrameDifference>> found = first_difference(**one, **alone, same);
    if (!found) return found.error();
    setting.alone = std::move(*found);
  }
  return bisection;
}

}  // namespace tactum::inline v0_1
