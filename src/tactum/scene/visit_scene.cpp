#include <algorithm>
#include <memory>
#include <string_view>

#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {
namespace {

template <class Take>
void each_setting(std::string_view section, const Take& take) {
  for (const SettingInfo& info : setting_table())
    if (section == info.section) take(info);
}

void visit_section(ItemVisitor& visitor, std::string_view section, SettingsDescription& settings) {
  each_setting(section,
               [&](const SettingInfo& info) { visitor.setting(info, settings.frame, settings.safety); });
}

/// The sections of settings; that of the workspace also has the place of the device, where that is asked for.
void visit_sections(ItemVisitor& visitor, SettingsDescription& settings, WorkspaceDescription* workspace) {
  std::string_view last;
  for (const SettingInfo& info : setting_table()) {
    const std::string_view section = info.section;
    if (section.empty() || section == last) continue;
    last = section;
    const bool places = workspace != nullptr && section == "workspace";
    KeyList keys;
    each_setting(section, [&](const SettingInfo& setting) { keys.push_back(setting.key); });
    const KeyList& pose = known_keys<WorkspaceDescription>();
    if (places) keys.insert(keys.end(), pose.begin(), pose.end());
    visitor.table(info.section, keys, [&](ItemVisitor& inside) {
      visit_section(inside, section, settings);
      if (places) visit_items(inside, *workspace);
    });
  }
}

void visit_pair(ItemVisitor& visitor, MaterialPair& pair, Range range) {
  visitor.text("material_a", pair.material_a, Need::kRequired);
  visitor.text("material_b", pair.material_b, Need::kRequired);
  visitor.number("coefficient", pair.coefficient, range, Need::kRequired);
}

void visit_pairs(ItemVisitor& visitor, const char* key, std::vector<MaterialPair>& pairs, Range range) {
  KeyVisitor keys;
  MaterialPair scratch;
  visit_pair(keys, scratch, range);
  pairs.resize(visitor.size(key, pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    visitor.element(key, i, keys.keys, [&](ItemVisitor& inside) { visit_pair(inside, pairs[i], range); });
}

/// Checks for items that code could give twice; a file cannot.
void check_settings(ItemVisitor& visitor, const SettingsDescription& settings) {
  const FrameSettings& frame = settings.frame;
  const FrameSettings usual;
  bool same = true;
  each_setting("coupling",
               [&](const SettingInfo& info) { same = same && info.get(frame, {}) == info.get(usual, {}); });
  if (settings.coupling_by_device && !same)
    visitor.fail("coupling", "the coupling is set, and chosen by the device", "settings.frame.coupling",
                 "coupling_by_device = false with it");
  if (frame.tool.body >= 0 || frame.tool.picks || !frame.other_hands.empty())
    visitor.fail("tool", "the grasp is set by a body's index", "settings.frame.tool",
                 "SceneDescription::tool");
  if (!frame.friction.coefficients.empty() || !frame.impacts.restitution.coefficients.empty())
    visitor.fail("friction", "coefficients are set by the indices of bodies", "settings.frame",
                 "SettingsDescription::friction and restitution");
}

void visit_settings(ItemVisitor& visitor, SettingsDescription& settings, WorkspaceDescription& workspace) {
  settings.coupling_by_device = !visitor.present("coupling", !settings.coupling_by_device);
  visit_section(visitor, "", settings);
  visit_sections(visitor, settings, &workspace);
  visit_changes(visitor, settings);
  visit_pairs(visitor, "friction", settings.friction, kNotNegative);
  visit_pairs(visitor, "restitution", settings.restitution, {0.0, 1.0});
  check_settings(visitor, settings);
}

/// [tool], or several [[tool]]: the first is the hand of the tables [workspace] and [hand] and of the key
/// `device`, each after it has its own. All may have limits of their own.
void visit_tools(ItemVisitor& visitor, SceneDescription& scene) {
  static constexpr const char* kFirstSections[] = {"safety"};
  check_own(visitor, kFirstSections, scene.hand.own);
  if (!visitor.several("tool", !scene.other_hands.empty()))
    return visitor.optional("tool", scene.tool, [&](ToolDescription& tool) { visitor.table("tool", tool); });
  const std::size_t tools = visitor.size("tool", 1 + scene.other_hands.size());
  if (!scene.tool && !scene.other_hands.empty())
    visitor.fail("tool", "the scene has a second hand, and no first", "SceneDescription::other_hands alone",
                 "SceneDescription::tool with them");
  if (tools == 0) return;
  ToolDescription& first = scene.tool ? *scene.tool : scene.tool.emplace();
  KeyList keys = known_keys<ToolDescription>();
  keys.push_back("safety");
  visitor.element("tool", 0, keys, [&](ItemVisitor& inside) {
    visit_items(inside, first);
    visit_own_section(inside, "safety", scene.hand.own);
  });
  scene.other_hands.resize(tools - 1);
  for (std::size_t i = 1; i < tools; ++i)
    visitor.element("tool", i, known_keys<OtherHandDescription>(),
                    [&](ItemVisitor& inside) { visit_items(inside, scene.other_hands[i - 1]); });
}

}  // namespace

void visit_changes(ItemVisitor& visitor, SettingsDescription& settings) {
  KeyList keys;
  for (const SettingInfo& info : setting_table()) {
    const char* key = *info.section == '\0' ? info.key : info.section;
    if (keys.empty() || std::string_view(keys.back()) != key) keys.push_back(key);
  }
  if (visitor.present("settings", false) && settings.before_changes == nullptr)
    settings.before_changes = std::make_shared<const SettingsDescription>(settings);
  visitor.table("settings", keys, [&](ItemVisitor& inside) {
    if (inside.present("coupling", false)) settings.coupling_by_device = false;
    visit_section(inside, "", settings);
    visit_sections(inside, settings, nullptr);
  });
}

void visit_items(ItemVisitor& visitor, SceneDescription& scene) {
  int schema = kSceneSchema;
  visitor.integer("schema", schema, kSceneSchema, kSceneSchema, Need::kRequired);
  visitor.text("description", scene.description);
  visitor.vector("gravity_m_per_s2", scene.gravity_W);
  visitor.tables("body", scene.bodies);
  if (scene.bodies.empty()) visitor.fail(nullptr, "the scene has no [[body]]", "none", "at least one");
  visitor.tables("field", scene.fields);
  visit_settings(visitor, scene.settings, scene.workspace);
  visit_tools(visitor, scene);
  visitor.text("device", scene.hand.device);
  visitor.table("hand", scene.hand);
  visitor.tables("goal", scene.goals);
}

}  // namespace tactum::inline v0_1
