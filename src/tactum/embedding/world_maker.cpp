#include "tactum/embedding/world_maker.h"

#include <utility>

#include "tactum/drivers/registry.h"

namespace tactum::inline v0_1 {
namespace {

/// The settings of a hand on its device, in those of a whole frame.
Result<FrameSettings> settings_of_tool(const WorldMaker& maker, const WorldTool& tool, const Device& device,
                                       double rate_Hz) {
  FrameSettings settings = settings_for(device.info(), rate_Hz);
  if (tool.p_BH) settings.tool.X_BH.p = *tool.p_BH;
  if (tool.body.empty()) return settings;
  const Result<int> body = maker.body_called(tool.body);
  if (!body) return body.error();
  settings.tool.body = *body;
  return settings;
}

Result<void> set_all(const World& world, const std::vector<MaterialPair>& pairs, PairCoefficients& table) {
  for (const MaterialPair& pair : pairs)
    if (Result<void> set = set_coefficient(world, pair, table); !set) return set;
  return {};
}

}  // namespace

Result<int> WorldMaker::body_called(const std::string& name) const {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].name == name) return static_cast<int>(i);
  return Error{"there is no such body", name, "one of the bodies' names", "world"};
}

Result<void> WorldMaker::join(const std::string& body, const std::string& parent, const Joint& joint,
                              bool contact) {
  const Result<int> jointed = body_called(body);
  if (!jointed) return jointed.error();
  const Result<int> to = body_called(parent);
  if (!to) return to.error();
  return world.join(*jointed, *to, joint, contact);
}

Result<std::unique_ptr<SteppedScene>> WorldMaker::simulate(std::span<const WorldTool> tools,
                                                           double rate_Hz) const {
  const WorldTool empty;
  if (tools.empty()) tools = {&empty, 1};
  if (Result<void> rate = check_rate(rate_Hz); !rate) return rate.error();
  FrameSettings settings;
  std::vector<std::unique_ptr<Device>> devices;
  for (const WorldTool& tool : tools) {
    Result<std::unique_ptr<Device>> device = make_device(listed_device_name(tool.device), {});
    if (!device) return device.error();
    Result<FrameSettings> own = settings_of_tool(*this, tool, **device, rate_Hz);
    if (!own) return own.error();
    if (devices.empty())
      settings = std::move(*own);
    else
      settings.other_hands.push_back(static_cast<const HandSettings&>(*own));
    devices.push_back(std::move(*device));
  }
  if (Result<void> set = set_all(world, friction, settings.friction); !set) return set.error();
  if (Result<void> set = set_all(world, restitution, settings.impacts.restitution); !set) return set.error();
  return SteppedScene::open(world, settings, std::move(devices));
}

Result<JointKind> joint_kind_called(const std::string& name) {
  constexpr std::pair<const char*, JointKind> kKinds[] = {{"free", JointKind::kFree},
                                                          {"fixed", JointKind::kFixed},
                                                          {"hinge", JointKind::kHinge},
                                                          {"slider", JointKind::kSlider},
                                                          {"ball", JointKind::kBall}};
  for (const auto& [word, kind] : kKinds)
    if (name == word) return kind;
  return Error{"no such joint", name, "free, fixed, hinge, slider or ball", "joint"};
}

std::shared_ptr<const Part> body_part(const QueriedPart& queried) {
  Part part = queried.file().part;
  part.origin = queried.file().origin;
  return std::make_shared<const Part>(std::move(part));
}

}  // namespace tactum::inline v0_1
