#include "app/sweep/sweep_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/hdf5/export_hdf5.h"
#include "app/hdf5/h5_file.h"
#include "tactum/version.h"

namespace tactum {
namespace {

void describe_plan(H5File& file, const SweepPlan& plan) {
  file.group("axes");
  file.group("runs");
  file.attribute("/", "format", std::string("tactum sweep"));
  file.attribute("/", "format_version", 1.0);
  file.attribute("/", "tactum_version",
                 fmt::format("{}.{}.{}", TACTUM_VERSION_MAJOR, TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH));
  file.attribute("/", "description", plan.description);
  file.attribute("/", "scene", plan.scene_name);
  file.attribute("/", "plan_hash", fmt::format("{:016x}", plan.hash));
  file.attribute("/", "jam_force_N", plan.jam.force_N);
  file.attribute("/", "jam_speed_m_per_s", plan.jam.speed_m_per_s);
  file.attribute(
      "/", "legend",
      std::string("Numbers are SI. /runs: one row a run; the last axis changes first, so that a "
                  "column takes the shape of the axes' lengths in the order of the attribute axes."));
  file.text("sweep.toml", plan.text);
  file.text("scene.toml", plan.scene_text);
  std::vector<std::string> names;
  for (const SweepAxis& axis : plan.axes) names.push_back(axis.name);
  file.attribute("/", "axes", names);
}

void write_axes(H5File& file, const SweepPlan& plan) {
  for (const SweepAxis& axis : plan.axes) {
    const std::string name = "axes/" + axis.name;
    {
      H5Column<double> column(file, name);
      for (std::size_t i = 0; i < axis.values.size(); ++i) column.add(number_of(axis, i));
    }
    file.attribute(name, "unit", unit_of_axis(axis.name));
    file.attribute(name, "paths", axis.paths);
    std::vector<std::string> words;
    for (const SweepValue& value : axis.values)
      if (const auto* word = std::get_if<std::string>(&value)) words.push_back(*word);
    if (!words.empty()) file.attribute(name, "words", words);
    const std::string in_runs = "runs/" + axis.name;
    {
      H5Column<double> column(file, in_runs);
      const auto place = static_cast<std::size_t>(&axis - plan.axes.data());
      for (std::uint64_t run = 0; run < plan.runs(); ++run)
        column.add(number_of(axis, plan.places(run)[place]));
    }
    file.attribute(in_runs, "unit", unit_of_axis(axis.name));
    file.attribute(in_runs, "meaning", std::string("the value of the axis"));
  }
}

}  // namespace

Result<void> write_sweep(const SweepPlan& plan, const std::map<std::uint64_t, SweepResult>& results,
                         const std::string& path) {
  Result<H5File> file = H5File::create(path);
  if (!file) return file.error();
  describe_plan(*file, plan);
  write_axes(*file, plan);
  for (std::size_t i = 0; i < kSweepMetrics.size(); ++i) {
    const std::string name = std::string("runs/") + kSweepMetrics[i].name;
    {
      H5Column<double> column(*file, name);
      for (const auto& [run, result] : results) column.add(result.numbers[i]);
    }
    file->attribute(name, "unit", std::string(kSweepMetrics[i].unit));
    file->attribute(name, "meaning", std::string(kSweepMetrics[i].meaning));
  }
  std::vector<std::string> errors;
  {
    H5Column<std::uint8_t> computed(*file, "runs/computed");
    H5Column<std::uint64_t> hashes(*file, "runs/frames_hash");
    for (const auto& [run, result] : results) {
      computed.add(result.error.empty() ? 1 : 0);
      hashes.add(result.hash);
      if (!result.error.empty()) errors.push_back(result.error);
    }
  }
  file->attribute("runs/computed", "unit", std::string("1"));
  file->attribute("runs/computed", "meaning", std::string("0 where there was no run, for an error"));
  file->attribute("runs/frames_hash", "unit", std::string("1"));
  file->attribute("runs/frames_hash", "meaning", std::string("the hash of all frames of the run"));
  if (!errors.empty()) file->attribute("runs", "errors", errors);
  return file->close();
}

std::string unit_of_axis(const std::string& name) {
  return name.ends_with("_deg") ? "deg" : name.ends_with("_kg") ? "kg" : unit_of_column(name);
}

double number_of(const SweepAxis& axis, std::size_t place) {
  const SweepValue& value = axis.values[place];
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? 1.0 : 0.0;
  return static_cast<double>(place);
}

std::string sentence_on(const std::map<std::uint64_t, SweepResult>& results) {
  std::uint64_t succeeded = 0, failed = 0;
  for (const auto& [run, result] : results) {
    succeeded += result.numbers[0] == 1.0;
    failed += !result.error.empty();
  }
  std::string text = fmt::format("{} runs: {} met all goals", results.size(), succeeded);
  if (failed > 0) text += fmt::format(", {} could not be computed", failed);
  return text;
}

}  // namespace tactum
