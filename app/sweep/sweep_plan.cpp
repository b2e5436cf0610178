#include "app/sweep/sweep_plan.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "tactum/base/hash.h"
#include "tactum/mesh/mapped_file.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"
#include "tactum/scene/scene_files.h"
#include "tactum/scene/toml_reader.h"
#include "tactum/scene/toml_slips.h"
#include "tactum/version.h"

namespace tactum {
namespace {

constexpr std::uint64_t kMostRuns = 1000000;
constexpr int kMostValues = 100000;

/// The values of an axis: a list, or a range with its ends.
void read_values(const TomlReader& reader, const toml::table& table, SweepAxis& axis) {
  if (reader.has("values") == reader.has("from")) {
    reader.fail(nullptr, "an axis has either values or a range", reader.has("from") ? "both" : "neither",
                "values = [...], or from, to and count");
    return;
  }
  if (reader.has("from")) {
    const bool log = reader.choice("scale", "linear", {"linear", "log"}) == "log";
    const Range range = log ? kPositive : kAny;
    const double from = reader.number("from", {}, range), to = reader.number("to", {}, range);
    const int count = reader.integer("count", {}, 2, kMostValues);
    for (int i = 0; i < count && !reader.errors(); ++i) {
      const double share = static_cast<double>(i) / (count - 1);
      // The ends are exactly those of the file.
      axis.values.emplace_back(i == 0           ? from
                               : i == count - 1 ? to
                               : log            ? from * std::pow(to / from, share)
                                                : from + share * (to - from));
    }
    return;
  }
  const toml::array* list = table["values"].as_array();
  if (list == nullptr || list->empty())
    return reader.fail("values", "an axis needs a list of values", "", "values = [...]");
  for (const toml::node& node : *list) {
    if (node.is_integer())
      axis.values.emplace_back(node.as_integer()->get());
    else if (node.is_floating_point())
      axis.values.emplace_back(node.as_floating_point()->get());
    else if (node.is_boolean())
      axis.values.emplace_back(node.as_boolean()->get());
    else if (node.is_string())
      axis.values.emplace_back(node.as_string()->get());
    else
      reader.fail("values", "a value is of a kind that no axis has", "", "numbers, words, true or false");
  }
}

void read_axis(const TomlReader& reader, const toml::table& table, SweepPlan& plan) {
  SweepAxis axis;
  axis.name = reader.text("name");
  if (axis.name.empty() || axis.name.find_first_of("/. ") != std::string::npos)
    reader.fail("name", "the name of an axis is the name of a column", "\"" + axis.name + "\"",
                "a word without blanks, dots and slashes");
  for (const SweepAxis& other : plan.axes)
    if (other.name == axis.name) reader.fail("name", "two axes have one name", "\"" + axis.name + "\"");
  if (reader.has("path") == reader.has("paths"))
    reader.fail(nullptr, "an axis sets one key or several", reader.has("path") ? "path and paths" : "neither",
                "path = \"...\" or paths = [...]");
  if (reader.has("path")) axis.paths = {reader.text("path")};
  if (const toml::array* paths = table["paths"].as_array())
    for (const toml::node& path : *paths) axis.paths.push_back(path.value_or(std::string()));
  if (axis.paths.empty()) reader.fail("paths", "an axis without a path", "", "paths = [\"...\"]");
  read_values(reader, table, axis);
  plan.axes.push_back(std::move(axis));
}

struct SweptSource {
  std::string scene, recording;
};

Result<SweptSource> read_keys(const toml::table& table, SweepPlan& plan) {
  FirstError errors;
  const TomlReader reader(table, plan.file, "",
                          {"schema", "description", "scene", "recording", "duration_s", "jam", "axis"},
                          errors);
  if (reader.integer("schema", {}, 1, 1) != 1) return errors.error();
  plan.description = reader.text("description", "");
  if (reader.has("scene") == reader.has("recording"))
    reader.fail(nullptr, "a sweep is of a scene or of a recording", reader.has("scene") ? "both" : "neither",
                "scene = \"NAME or FILE.toml\" or recording = \"FILE.mcap\"");
  const SweptSource source{reader.text("scene", ""), reader.text("recording", "")};
  plan.duration_s = reader.number("duration_s", 0.0, kNotNegative);
  const TomlReader jam = reader.table("jam", {"force_N", "speed_m_per_s"});
  plan.jam.force_N = jam.number("force_N", plan.jam.force_N, kNotNegative);
  plan.jam.speed_m_per_s = jam.number("speed_m_per_s", plan.jam.speed_m_per_s, kNotNegative);
  static constexpr std::array kAxisKeys = {"name", "path", "paths", "values", "from", "to", "count", "scale"};
  const toml::array* axes = table["axis"].as_array();
  for (std::size_t i = 0; i < reader.size("axis") && !errors; ++i)
    read_axis(reader.element("axis", i, kAxisKeys), *axes->get(i)->as_table(), plan);
  if (plan.axes.empty()) reader.fail(nullptr, "a sweep needs something that varies", "no axis", "[[axis]]");
  if (errors) return errors.error();
  return source;
}

/// Keeps everything of a recording that its runs need.
class SweptReading final : public RecordingVisitor {
 public:
  using RecordingVisitor::RecordingVisitor;
  SweptRecording read;

 private:
  Result<void> begin(Files files) override {
    read.head = head();
    read.files = std::move(files);
    return {};
  }
  Result<void> command(const RecordedCommand& command) override {
    if (command.command.kind == SessionCommand::Kind::kSet && command.command.setting >= 0)
      read.commands.push_back(command);
    return {};
  }
  Result<void> input(const RecordedInput& input) override {
    if (input.tick.index == read.inputs.size()) read.inputs.push_back(input);
    return {};
  }
  Result<void> hand(const RecordedHand& hand) override {
    if (hand.index + 1 == read.inputs.size()) read.others.push_back(hand.sample);
    return {};
  }
};

Result<void> read_recorded(const std::string& path, SweepPlan& plan) {
  const Result<McapFile> file = McapFile::open(path);
  if (!file) return file.error();
  SweptReading reading(path);
  const McapEnd end = read_recording(*file, reading);
  if (!reading.begun() || reading.read.inputs.empty() || !reading.read.files.contains(kSceneAttachment))
    return end.wrong ? *end.wrong
                     : Error{"the recording has no frames", path, "a run with its scene", plan.file};
  const std::size_t others = reading.read.head.other_devices.size();
  if (others > 0) {  // the last frame may lack the hands that stood in a chunk that is cut off
    const std::size_t whole = std::min(reading.read.inputs.size(), reading.read.others.size() / others);
    reading.read.inputs.resize(whole);
    reading.read.others.resize(whole * others);
  }
  plan.scene_name = reading.read.head.scene;
  plan.scene_text = reading.read.files[kSceneAttachment];
  plan.source.file = reading.read.head.scene_file;
  plan.recording = std::make_shared<const SweptRecording>(std::move(reading.read));
  return {};
}

Result<void> read_scene(const std::string& path, SweepPlan& plan) {
  Result<SceneDescription> scene = describe_scene(path);
  if (!scene) return scene.error();
  plan.scene_name = scene->name;
  plan.scene_text = scene->source.text;
  plan.source = std::move(scene->source);
  return {};
}

void add_text(Hash& hash, const std::string& text) {
  hash.add(static_cast<std::uint64_t>(text.size()));
  hash.add_bytes(text.data(), text.size());
}

/// Of the program's version, both texts, and all files that the scene needs.
Result<std::uint64_t> hash_of_plan(const SweepPlan& plan) {
  Hash hash;
  hash.add(TACTUM_VERSION);
  add_text(hash, plan.text);
  add_text(hash, plan.scene_text);
  if (plan.recording) {
    for (const auto& [name, content] : plan.recording->files) add_text(hash, content);
    for (const RecordedInput& input : plan.recording->inputs) hash.add(input.hash);
    return hash.value();
  }
  const Result<SceneDescription> scene =
      parse_description(plan.scene_text, plan.scene_name, plan.source.file, plan.source.folders);
  if (!scene) return scene.error();
  const Result<std::vector<SceneFile>> files = files_of(*scene);
  if (!files) return files.error();
  for (const SceneFile& file : *files) {
    const Result<MappedFile> bytes = MappedFile::open(file.path);
    if (!bytes) return bytes.error();
    add_text(hash, std::string(bytes->bytes()));
  }
  return hash.value();
}

std::string beside(const std::string& sweep, const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path path = fs::path(sweep).parent_path() / name;
  std::error_code ignored;
  return fs::exists(path, ignored) ? path.string() : name;
}

std::string value_text_of(const SweepValue& value) {
  return std::visit([](const auto& plain) { return fmt::format("{}", plain); }, value);
}

}  // namespace

std::uint64_t SweepPlan::runs() const {
  std::uint64_t count = 1;
  for (const SweepAxis& axis : axes) count *= axis.values.size();
  return count;
}

std::vector<std::size_t> SweepPlan::places(std::uint64_t run) const {
  std::vector<std::size_t> places(axes.size());
  for (std::size_t i = axes.size(); i-- > 0;) {
    places[i] = run % axes[i].values.size();
    run /= axes[i].values.size();
  }
  return places;
}

Result<SweepPlan> read_sweep(const std::string& path) {
  SweepPlan plan;
  plan.file = path;
  std::ostringstream text;
  std::ifstream stream(path, std::ios::binary);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored) || !(text << stream.rdbuf()))
    return Error{"cannot read the sweep", "no such file", "a sweep file (.toml)", path};
  plan.text = text.str();
  Result<SweptSource> source = Error{};
  try {
    source = read_keys(toml::table(toml::parse(plan.text, path)), plan);
  } catch (const toml::parse_error& error) {
    return toml_error(plan.text, path, error);
  }
  if (!source) return source.error();
  double runs = 1.0;
  for (const SweepAxis& axis : plan.axes) runs *= static_cast<double>(axis.values.size());
  if (runs > static_cast<double>(kMostRuns))
    return Error{"the sweep is too large", fmt::format("{:.0f} runs", runs),
                 fmt::format("at most {}", kMostRuns), path};
  Result<void> read = source->recording.empty() ? read_scene(beside(path, source->scene), plan)
                                                : read_recorded(beside(path, source->recording), plan);
  if (!read) return read.error();
  const Result<std::uint64_t> hash = hash_of_plan(plan);
  if (!hash) return hash.error();
  plan.hash = *hash;
  // A path that leads nowhere is told before anything is computed.
  if (const Result<std::string> first = scene_text_of(plan, 0); !first) return first.error();
  return plan;
}

Result<std::string> scene_text_of(const SweepPlan& plan, std::uint64_t run) {
  std::string text = plan.scene_text;
  const std::vector<std::size_t> places = plan.places(run);
  for (std::size_t i = 0; i < plan.axes.size(); ++i)
    for (const std::string& path : plan.axes[i].paths) {
      Result<std::string> changed = with_value(text, path, plan.axes[i].values[places[i]]);
      if (!changed) {
        Error error = changed.error();
        error.where = plan.file;
        return error;
      }
      text = std::move(*changed);
    }
  return text;
}

std::string values_of(const SweepPlan& plan, std::uint64_t run) {
  const std::vector<std::size_t> places = plan.places(run);
  std::string text;
  for (std::size_t i = 0; i < plan.axes.size(); ++i)
    text += fmt::format("{}{} = {}", i == 0 ? "" : ", ", plan.axes[i].name,
                        value_text_of(plan.axes[i].values[places[i]]));
  return text;
}

}  // namespace tactum
