#include "tactum/scene/read_description.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>

#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {
namespace {

/// A value's own default, unless the file must have it.
template <class T>
std::optional<T> fallback(const T& value, Need need) {
  return need == Need::kRequired ? std::nullopt : std::optional<T>(value);
}

std::vector<std::string> texts(const WordList& words) { return {words.begin(), words.end()}; }

bool has_word(const WordList& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

class TomlVisitor final : public ItemVisitor {
 public:
  using ItemVisitor::angle;
  using ItemVisitor::number;
  using ItemVisitor::table;
  using ItemVisitor::vector;

  TomlVisitor(TomlReader reader, SceneSource& source) : reader_(std::move(reader)), source_(source) {
    note_place(reader_.path(), nullptr);
  }

  void number(const char* key, double& value, Range range, Need need) override {
    value = reader_.number(noted(key), fallback(value, need), range);
  }
  void angle(const char* key, double& value_rad, Range range_deg, Need need) override {
    if (reader_.has(noted(key)) || need == Need::kRequired)
      value_rad = radians(reader_.number(key, {}, range_deg));
  }
  void integer(const char* key, int& value, int low, int high, Need need) override {
    value = reader_.integer(noted(key), fallback(value, need), low, high);
  }
  void flag(const char* key, bool& value) override { value = reader_.flag(noted(key), value); }
  void text(const char* key, std::string& value, Need need) override {
    value = reader_.text(noted(key), fallback(value, need));
  }
  void vector(const char* key, Vec3& value, Need need) override {
    value = reader_.vector3(noted(key), fallback(value, need));
  }
  void interval(const char* key, Interval& value, double unit) override {
    const std::vector<double> ends = reader_.numbers(noted(key), 2);
    if (!ends.empty()) value = {unit * ends[0], unit * ends[1]};
  }
  void rotation(Mat3& R) override {
    noted("quat_wxyz");
    noted("rpy_deg");
    if (reader_.has("quat_wxyz") || reader_.has("rpy_deg")) R = reader_.rotation();
  }
  void setting(const SettingInfo& info, FrameSettings& frame, SafetySettings& safety) override;
  int word(const char* key, int index, const WordList& words, Need need) override;

  bool present(const char* key, bool) override { return reader_.has(key); }
  void table(const char* key, const KeyList& keys, const Visit& visit) override {
    noted(key);
    TomlVisitor inside(reader_.table(key, keys), source_);
    visit(inside);
  }
  bool several(const char* key, bool) override { return reader_.is_array(key); }
  std::size_t size(const char* key, std::size_t) override { return reader_.size(noted(key)); }
  void element(const char* key, std::size_t index, const KeyList& keys, const Visit& visit) override {
    TomlVisitor inside(reader_.element(key, index, keys), source_);
    visit(inside);
  }
  int marked(const std::vector<KeyList>& marks, const WordList& names, int, const Error& fault) override;
  void only(const Alternatives& alternatives, int chosen) override;

  void fail(const char* key, std::string what, std::string found, std::string expected) override {
    reader_.fail(key, std::move(what), std::move(found), std::move(expected));
  }
  std::string section() const override { return reader_.section(); }

 private:
  /// The key, whose place is stored where the file has it.
  const char* noted(const char* key) {
    if (reader_.has(key)) note_place(item_path(reader_.path(), key), key);
    return key;
  }
  void note_place(const std::string& path, const char* key) {
    const toml::source_position at = reader_.position(key);
    if (at.line > 0) source_.places[path] = {static_cast<int>(at.line), static_cast<int>(at.column)};
  }

  TomlReader reader_;
  SceneSource& source_;
};

/// Why the numbers of a section are bounded, where that is no matter of course.
const char* reason_of(const SettingInfo& info) {
  const std::string_view section = info.section;
  if (section == "coupling")
    return ": beyond that no hand-held device is stable (docs/algorithms/stability.md); what [coupling] "
           "leaves "
           "out has its default, and without the section all is chosen for the device";
  if (section == "penalty") return ": beyond that contact springs swing at these rates (docs/settings.md)";
  return "";
}

void TomlVisitor::setting(const SettingInfo& info, FrameSettings& frame, SafetySettings& safety) {
  if (!reader_.has(noted(info.key))) return;
  double value = info.get(frame, safety);
  const int low = static_cast<int>(info.low);
  switch (info.kind) {
    case SettingKind::kNumber:
      value = reader_.number(info.key, value, {info.low, info.high}, reason_of(info));
      break;
    case SettingKind::kInteger:
      value = reader_.integer(info.key, static_cast<int>(value), low, static_cast<int>(info.high));
      break;
    case SettingKind::kOnOff:
      value = reader_.flag(info.key, value != 0.0) ? 1.0 : 0.0;
      break;
    case SettingKind::kChoice:
      value = word(info.key, static_cast<int>(value), {info.choices.begin(), info.choices.end()},
                   Need::kOptional);
      break;
  }
  info.set(frame, safety, value);
}

int TomlVisitor::word(const char* key, int index, const WordList& words, Need need) {
  const std::string usual = words[static_cast<std::size_t>(index)];
  const std::string read = reader_.choice(noted(key), fallback(usual, need), texts(words));
  return static_cast<int>(std::find(words.begin(), words.end(), read) - words.begin());
}

int TomlVisitor::marked(const std::vector<KeyList>& marks, const WordList& names, int, const Error& fault) {
  std::vector<std::string> found;
  int chosen = -1;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (std::none_of(marks[i].begin(), marks[i].end(), [&](const char* key) { return reader_.has(key); }))
      continue;
    found.emplace_back(names[i]);
    chosen = static_cast<int>(i);
  }
  if (found.size() == 1) return chosen;
  fail(nullptr, fault.what, found.empty() ? "none" : fmt::format("{}", fmt::join(found, " and ")),
       fault.expected);
  return -1;
}

void TomlVisitor::only(const Alternatives& alternatives, int chosen) {
  const KeyList& own = alternatives.keys[static_cast<std::size_t>(chosen)];
  for (const KeyList& keys : alternatives.keys)
    for (const char* key : keys) {
      if (has_word(own, key) || !reader_.has(key)) continue;
      WordList owners;
      for (std::size_t i = 0; i < alternatives.keys.size(); ++i)
        if (has_word(alternatives.keys[i], key)) owners.push_back(alternatives.names[i]);
      fail(key, fmt::format("\"{}\" in {} is not for this kind of {}", key, section(), alternatives.noun),
           alternatives.names[static_cast<std::size_t>(chosen)], fmt::format("{}", fmt::join(owners, ", ")));
    }
}

}  // namespace

void read_description(const toml::table& document, SceneDescription& scene, FirstError& errors) {
  // Before any key: those of a newer schema may be unknown here.
  const toml::node* schema = document.get("schema");
  const std::int64_t number = schema && schema->is_integer() ? schema->as_integer()->get() : kSceneSchema;
  if (number > kSceneSchema)
    return errors.add({fmt::format("schema {} is newer than this program ({})", number, kSceneSchema), "",
                       fmt::format("schema = {}, or a newer tactum", kSceneSchema),
                       place(scene.source.file, schema->source().begin)});
  TomlVisitor visitor(TomlReader(document, scene.source.file, "", known_keys<SceneDescription>(), errors),
                      scene.source);
  visit_items(visitor, scene);
}

void read_changes(const toml::table& document, const std::string& file, SettingsDescription& settings,
                  FirstError& errors) {
  SceneSource source;
  source.file = file;
  TomlVisitor visitor(TomlReader(document, file, "", {"settings"}, errors), source);
  if (!visitor.present("settings", false)) visitor.missing("settings", "a table [settings]");
  visit_changes(visitor, settings);
}

}  // namespace tactum::inline v0_1
