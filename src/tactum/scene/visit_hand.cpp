#include <algorithm>

#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {

void visit_items(ItemVisitor&, CentreGrasp&) {}

void visit_items(ItemVisitor& visitor, RimGrasp& grasp) {
  visitor.number("radius_m", grasp.radius_m, kPositive, Need::kRequired);
  visitor.angle("angle_deg", grasp.angle_rad);
}

void visit_items(ItemVisitor& visitor, PointGrasp& grasp) {
  visitor.vector("pos_m", grasp.pos_m, Need::kRequired);
}

void visit_items(ItemVisitor& visitor, BodyTool& tool) {
  visitor.text("body", tool.body, Need::kRequired);
  visitor.kinds("grasp", "grasp", tool.grasp, Need::kOptional);
}

void visit_items(ItemVisitor& visitor, PickingTool& tool) {
  visitor.number("pick_distance_m", tool.pick_distance_m, kPositive);
  visitor.number("centre_fraction", tool.centre_fraction, {0.0, 1.0});
}

void visit_items(ItemVisitor& visitor, ToolDescription& tool) {
  static const Alternatives tools{
      "tool", {"picks = false", "picks = true"}, {known_keys<BodyTool>(), known_keys<PickingTool>()}};
  const auto visit_tool = [&](auto& kind) { visit_items(visitor, kind); };
  bool picks = std::holds_alternative<PickingTool>(tool);
  visitor.flag("picks", picks);
  visitor.alternative(tools, picks ? 1 : 0, tool, visit_tool);
}

void visit_items(ItemVisitor& visitor, WorkspaceDescription& workspace) {
  visitor.vector("pos_m", workspace.pos_m);
  visitor.rotation(workspace.R_WD);
}

void visit_items(ItemVisitor& visitor, HoldStep& step) {
  visitor.number("hold_s", step.hold_s, kPositive, Need::kRequired);
  visitor.flag("button", step.button);
}

namespace {

void visit_travel(ItemVisitor& visitor, double& duration_s, MotionProfile& profile, bool& button) {
  visitor.number("duration_s", duration_s, kPositive, Need::kRequired);
  visitor.choice("profile", profile, {"minimum-jerk", "steady"});
  visitor.flag("button", button);
}

}  // namespace

void visit_items(ItemVisitor& visitor, TurnStep& step) {
  visitor.optional("axis", step.axis, [&](Vec3& axis) { visitor.direction("axis", axis, Need::kOptional); });
  visitor.vector("anchor_m", step.anchor_m);
  visitor.angle("turn_deg", step.turn_rad, kAny, Need::kRequired);
  visit_travel(visitor, step.duration_s, step.profile, step.button);
}

void visit_items(ItemVisitor& visitor, MoveStep& step) {
  visitor.vector("offset_m", step.offset_m);
  const bool turned = step.rotation_W.has_value();
  if (visitor.present("rpy_deg", turned) || visitor.present("quat_wxyz", turned))
    visitor.rotation(step.rotation_W ? *step.rotation_W : step.rotation_W.emplace(Mat3::Identity()));
  if (!step.offset_m && !step.rotation_W)
    visitor.fail(nullptr, visitor.section() + " goes nowhere", "no pose", "offset_m or an orientation");
  visit_travel(visitor, step.duration_s, step.profile, step.button);
}

void visit_items(ItemVisitor& visitor, HandStep& step) {
  static const Alternatives steps{"step",
                                  {"hold_s", "turn_deg", "offset_m and an orientation"},
                                  {known_keys<HoldStep>(), known_keys<TurnStep>(), known_keys<MoveStep>()}};
  static const std::vector<KeyList> marks{{"hold_s"}, {"turn_deg"}, {"offset_m", "rpy_deg", "quat_wxyz"}};
  const Error fault{visitor.section() + " must do one thing", "",
                    "hold_s, turn_deg, or offset_m and an orientation", ""};
  const int index = visitor.marked(marks, steps.names, static_cast<int>(step.index()), fault);
  visitor.alternative(steps, index, step, [&](auto& kind) { visit_items(visitor, kind); });
}

void visit_items(ItemVisitor& visitor, TremorDescription& tremor) {
  visitor.number("translation_m", tremor.translation_m, {0.0, 0.01});
  visitor.angle("rotation_deg", tremor.rotation_rad, {0.0, 20.0});
  visitor.integer("seed", tremor.seed, 0, 1'000'000'000);
}

void visit_items(ItemVisitor& visitor, HandDescription& hand) {
  visitor.text("grip", hand.grip);
  visitor.integer("repeat", hand.repeat, 1, 1000);
  visitor.optional("tremor", hand.tremor,
                   [&](TremorDescription& tremor) { visitor.table("tremor", tremor); });
  visitor.tables("step", hand.steps);
}

namespace {

std::string own_name(const SettingInfo& info) { return std::string(info.section) + "." + info.key; }

void visit_own(ItemVisitor& visitor, const SettingInfo& info, std::vector<OwnSetting>& own) {
  const auto at = std::find_if(own.begin(), own.end(),
                               [&](const OwnSetting& each) { return each.setting == own_name(info); });
  if (!visitor.present(info.key, at != own.end())) return;
  FrameSettings frame;
  SafetySettings safety;
  if (at != own.end()) info.set(frame, safety, at->value);
  visitor.setting(info, frame, safety);
  const double value = info.get(frame, safety);
  if (at != own.end())
    at->value = value;
  else
    own.push_back({own_name(info), value});
}

KeyList keys_of_section(std::string_view section) {
  KeyList keys;
  for (const SettingInfo& info : setting_table())
    if (section == info.section) keys.push_back(info.key);
  return keys;
}

void visit_settings_of(ItemVisitor& visitor, std::string_view section, std::vector<OwnSetting>& own) {
  for (const SettingInfo& info : setting_table())
    if (section == info.section) visit_own(visitor, info, own);
}

}  // namespace

void visit_own_section(ItemVisitor& visitor, const char* section, std::vector<OwnSetting>& own) {
  visitor.table(section, keys_of_section(section),
                [&](ItemVisitor& inside) { visit_settings_of(inside, section, own); });
}

void check_own(ItemVisitor& visitor, std::span<const char* const> sections,
               const std::vector<OwnSetting>& own) {
  for (const OwnSetting& each : own) {
    const std::string section = each.setting.substr(0, each.setting.find('.'));
    const bool is_own = std::find(sections.begin(), sections.end(), section) != sections.end();
    if (!is_own || setting_called(each.setting) < 0)
      visitor.fail(nullptr, "a hand has no such setting of its own", "'" + each.setting + "'",
                   std::string("one of ") + sections.front() + (sections.size() > 1 ? ", ..." : ""));
  }
}

void visit_items(ItemVisitor& visitor, OtherHandDescription& other) {
  static constexpr const char* kOwnSections[] = {"coupling", "smoothing", "safety", "workspace"};
  visit_items(visitor, other.tool);
  visitor.text("device", other.hand.device);
  KeyList place = known_keys<WorkspaceDescription>();
  for (const char* key : keys_of_section("workspace")) place.push_back(key);
  visitor.table("workspace", place, [&](ItemVisitor& inside) {
    visit_items(inside, other.workspace);
    visit_settings_of(inside, "workspace", other.hand.own);
  });
  for (const char* section : {"coupling", "smoothing", "safety"})
    visit_own_section(visitor, section, other.hand.own);
  check_own(visitor, kOwnSections, other.hand.own);
  visitor.table("hand", other.hand);
}

}  // namespace tactum::inline v0_1
