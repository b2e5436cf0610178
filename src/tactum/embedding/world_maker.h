#pragma once
/// A world that a program in another language puts together call by call, with names in place of indices, and
/// then steps.
///
///   WorldMaker maker;
///   maker.world.gravity_W = ...;
///   maker.world.add({...});  maker.join("lid", "box", hinge);  maker.friction.push_back({...});
///   auto scene = maker.simulate({{.body = "lid"}}, 1000.0);

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactum/dynamics/world.h"
#include "tactum/embedding/part_query.h"
#include "tactum/embedding/stepped_scene.h"
#include "tactum/haptics/materials.h"

namespace tactum::inline v0_1 {

/// What a hand holds, and the device that the hand is on.
struct WorldTool {
  std::string body = {};                    ///< its name; empty: the hand is empty
  std::string device = "premium-1.5-6dof";  ///< whose limits hold, as in drivers/registry.h
  std::optional<Vec3> p_BH = {};            ///< where the hand holds it; absent: its centre of mass [m]
};

/// Constant while its scenes run: each has a copy of the world.
class WorldMaker {
 public:
  World world;
  std::vector<MaterialPair> friction;     ///< Coulomb's coefficients; of one pair the last counts
  std::vector<MaterialPair> restitution;  ///< the same of impacts

  /// The index of the body of that name, or an error.
  Result<int> body_called(const std::string& name) const;
  /// World::join of bodies by name.
  Result<void> join(const std::string& body, const std::string& parent, const Joint& joint, bool contact);
  /// The world with a hand for each tool; one hand that is empty where there is none. An error says what is
  /// wrong: a rate, a device, a body or a material that is not there. Slow; allocates.
  Result<std::unique_ptr<SteppedScene>> simulate(std::span<const WorldTool> tools, double rate_Hz) const;
};

/// The joint of that name: free, fixed, hinge, slider or ball.
Result<JointKind> joint_kind_called(const std::string& name);

/// The part as a body has it: about its centre of mass, with the origin of its file known.
std::shared_ptr<const Part> body_part(const QueriedPart& queried);

}  // namespace tactum::inline v0_1
