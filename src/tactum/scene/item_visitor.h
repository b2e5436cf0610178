#pragma once
/// The keys of scene files, each with its member of the description, its range and its rules. They are listed
/// once, by the functions visit_items (visit_*.cpp); the visitors are:
///
///   known_keys             which keys a table may have
///   read_description.cpp   TOML into a description, with the defaults of its members
///   check_description.cpp  whether a description made in code could have come from a file
///
/// For src/tactum/scene/*.cpp only.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tactum/haptics/setting_table.h"
#include "tactum/scene/item_errors.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

/// The schema of scene files that this program reads.
inline constexpr int kSceneSchema = 1;

/// Whether a file must have the key.
enum class Need { kOptional, kRequired };

using KeyList = std::vector<const char*>;
using WordList = std::vector<const char*>;

/// The alternatives of a variant, for messages and for keys that only some of them have.
struct Alternatives {
  const char* noun;           ///< "joint"
  WordList names;             ///< of each
  std::vector<KeyList> keys;  ///< of each, beside those that all have
};

class ItemVisitor {
 public:
  using Visit = std::function<void(ItemVisitor&)>;

  virtual ~ItemVisitor() = default;

  // Values; an absent one stays as it is.
  virtual void number(const char* key, double& value, Range range = kAny, Need need = Need::kOptional) = 0;
  /// Degrees in a file, radians in memory; the range is in degrees.
  virtual void angle(const char* key, double& value_rad, Range range_deg = kAny,
                     Need need = Need::kOptional) = 0;
  virtual void integer(const char* key, int& value, int low, int high, Need need = Need::kOptional) = 0;
  virtual void flag(const char* key, bool& value) = 0;
  virtual void text(const char* key, std::string& value, Need need = Need::kOptional) = 0;
  virtual void vector(const char* key, Vec3& value, Need need = Need::kOptional) = 0;
  /// Two numbers; those of a file are multiplied by `unit`.
  virtual void interval(const char* key, Interval& value, double unit) = 0;
  /// `quat_wxyz` or `rpy_deg`.
  virtual void rotation(Mat3& R) = 0;
  virtual void setting(const SettingInfo& info, FrameSettings& frame, SafetySettings& safety) = 0;
  /// The index of one of several words.
  virtual int word(const char* key, int index, const WordList& words, Need need) = 0;

  // Structure.
  /// Whether an item is there: the key in a file, `in_memory` elsewhere.
  virtual bool present(const char* key, bool in_memory) = 0;
  /// The table under `key`, with its keys; an absent one is visited as an empty one.
  virtual void table(const char* key, const KeyList& keys, const Visit& visit) = 0;
  /// Whether an item is an array of tables, where it may be a table: `in_memory` elsewhere than in a file.
  virtual bool several(const char* key, bool in_memory) = 0;
  /// How many tables an array has.
  virtual std::size_t size(const char* key, std::size_t in_memory) = 0;
  virtual void element(const char* key, std::size_t index, const KeyList& keys, const Visit& visit) = 0;
  /// The one of several alternatives that is present, where each has keys of its own, `marks`; -1 and the
  /// error `fault` when there is none or there are several.
  virtual int marked(const std::vector<KeyList>& marks, const WordList& names, int in_memory,
                     const Error& fault) = 0;
  /// Whether all alternatives are visited, for their keys.
  virtual bool visits_all() const { return false; }
  /// An error at each key of alternatives that are not the chosen one.
  virtual void only(const Alternatives& alternatives, int chosen) = 0;

  // Rules.
  /// An error at the key, or at the table where it is null or absent.
  virtual void fail(const char* key, std::string what, std::string found, std::string expected) = 0;
  /// The name of the visited table in messages.
  virtual std::string section() const = 0;

  // Made of the functions above.
  void number(const char* key, std::optional<double>& value, Range range = kAny);
  void angle(const char* key, std::optional<double>& value_rad, Range range_deg = kAny);
  void vector(const char* key, std::optional<Vec3>& value);
  /// Any vector but zero.
  void direction(const char* key, Vec3& value, Need need);
  /// Three numbers above 0.
  void sizes(const char* key, Vec3& value);
  /// `pos_m` and a rotation.
  void pose(Pose& X);
  /// An error of a file that has both keys.
  void exclude(const char* key, const char* other, const char* what);
  /// The error of an absent key.
  void missing(const char* key, const char* expected);

  template <class T, class VisitValue>
  void optional(const char* key, std::optional<T>& value, const VisitValue& visit) {
    if (!present(key, value.has_value())) return value.reset();
    visit(value ? *value : value.emplace());
  }

  template <class Enum>
  void choice(const char* key, Enum& value, const WordList& words, Need need = Need::kOptional) {
    value = static_cast<Enum>(word(key, static_cast<int>(value), words, need));
  }

  template <class T>
  void table(const char* key, T& value);
  template <class T>
  void tables(const char* key, std::vector<T>& values);

  /// The alternative named by the word under `key`, each by its kKind.
  template <class... Kinds>
  void kinds(const char* key, const char* noun, std::variant<Kinds...>& value, Need need);
  /// The alternative of this index; none when it is negative.
  template <class VisitKind, class... Kinds>
  void alternative(const Alternatives& alternatives, int index, std::variant<Kinds...>& value,
                   const VisitKind& visit);
};

/// Collects the keys of the table that is visited, not those of tables in it.
class KeyVisitor final : public ItemVisitor {
 public:
  using ItemVisitor::angle;
  using ItemVisitor::number;
  using ItemVisitor::table;
  using ItemVisitor::vector;

  KeyList keys;

  void number(const char* key, double&, Range, Need) override { add(key); }
  void angle(const char* key, double&, Range, Need) override { add(key); }
  void integer(const char* key, int&, int, int, Need) override { add(key); }
  void flag(const char* key, bool&) override { add(key); }
  void text(const char* key, std::string&, Need) override { add(key); }
  void vector(const char* key, Vec3&, Need) override { add(key); }
  void interval(const char* key, Interval&, double) override { add(key); }
  void rotation(Mat3&) override;
  void setting(const SettingInfo& info, FrameSettings&, SafetySettings&) override { add(info.key); }
  int word(const char* key, int index, const WordList&, Need) override;
  bool present(const char*, bool) override { return true; }
  void table(const char* key, const KeyList&, const Visit&) override { add(key); }
  bool several(const char*, bool) override { return false; }
  std::size_t size(const char* key, std::size_t) override;
  void element(const char*, std::size_t, const KeyList&, const Visit&) override {}
  int marked(const std::vector<KeyList>&, const WordList&, int index, const Error&) override { return index; }
  bool visits_all() const override { return true; }
  void only(const Alternatives&, int) override {}
  void fail(const char*, std::string, std::string, std::string) override {}
  std::string section() const override { return {}; }

 private:
  void add(const char* key);
};

/// The keys of the table of a T.
template <class T>
const KeyList& known_keys() {
  static const KeyList keys = [] {
    KeyVisitor visitor;
    T scratch{};
    visit_items(visitor, scratch);
    return visitor.keys;
  }();
  return keys;
}

template <class T>
void ItemVisitor::table(const char* key, T& value) {
  table(key, known_keys<T>(), [&](ItemVisitor& visitor) { visit_items(visitor, value); });
}

template <class T>
void ItemVisitor::tables(const char* key, std::vector<T>& values) {
  values.resize(size(key, values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
    element(key, i, known_keys<T>(), [&](ItemVisitor& visitor) { visit_items(visitor, values[i]); });
}

template <class... Kinds>
void ItemVisitor::kinds(const char* key, const char* noun, std::variant<Kinds...>& value, Need need) {
  static const Alternatives alternatives{noun, {Kinds::kKind...}, {known_keys<Kinds>()...}};
  alternative(alternatives, word(key, static_cast<int>(value.index()), alternatives.names, need), value,
              [this](auto& kind) { visit_items(*this, kind); });
}

template <class VisitKind, class... Kinds>
void ItemVisitor::alternative(const Alternatives& alternatives, int index, std::variant<Kinds...>& value,
                              const VisitKind& visit) {
  if (visits_all()) {
    const auto visit_fresh = [&](auto fresh) { visit(fresh); };
    (visit_fresh(Kinds{}), ...);
    return;
  }
  if (index < 0) return;
  only(alternatives, index);
  if (value.index() != static_cast<std::size_t>(index)) {
    int at = 0;
    ((at++ == index ? static_cast<void>(value = Kinds{}) : static_cast<void>(0)), ...);
  }
  std::visit(visit, value);
}

// Parts: visit_parts.cpp.
void visit_items(ItemVisitor& visitor, PartDescription& part);

// Bodies: visit_bodies.cpp.
void visit_items(ItemVisitor& visitor, JointDescription& joint);
void visit_items(ItemVisitor& visitor, ComponentDescription& component);
void visit_items(ItemVisitor& visitor, SamplePoint& point);
void visit_items(ItemVisitor& visitor, InertialDescription& inertial);
void visit_items(ItemVisitor& visitor, BodyDescription& body);

/// The table [settings], whose settings count more than those of the sections.
void visit_changes(ItemVisitor& visitor, SettingsDescription& settings);

// Fields and goals: visit_fields.cpp, visit_goals.cpp.
void visit_items(ItemVisitor& visitor, FieldDescription& field);
void visit_items(ItemVisitor& visitor, GoalDescription& goal);

// The hand: visit_hand.cpp.
void visit_items(ItemVisitor& visitor, ToolDescription& tool);
void visit_items(ItemVisitor& visitor, WorkspaceDescription& workspace);
void visit_items(ItemVisitor& visitor, HandStep& step);
void visit_items(ItemVisitor& visitor, TremorDescription& tremor);
/// [hand]; the file's key `device` stands outside it.
void visit_items(ItemVisitor& visitor, HandDescription& hand);

/// A [[tool]] behind the first, with what belongs to its hand.
void visit_items(ItemVisitor& visitor, OtherHandDescription& other);
/// The table of a section of settings that a hand has of its own.
void visit_own_section(ItemVisitor& visitor, const char* section, std::vector<OwnSetting>& own);
/// An error where code gives a hand a setting of another section.
void check_own(ItemVisitor& visitor, std::span<const char* const> sections,
               const std::vector<OwnSetting>& own);

// The whole: visit_scene.cpp.
void visit_items(ItemVisitor& visitor, SceneDescription& scene);

/// Degrees as a file has them, in radians.
inline double radians(double degrees) { return degrees * (kPi / 180.0); }

}  // namespace tactum::inline v0_1
