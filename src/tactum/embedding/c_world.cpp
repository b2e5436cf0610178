/// Worlds of the C interface, put together call by call.

#include <memory>
#include <vector>

#include "tactum/embedding/c_handles.h"
#include "tactum/embedding/c_values.h"

using namespace tactum;  // the C interface stands outside the namespace
using namespace tactum::c_calls;

namespace {

constexpr double kUsualRate_Hz = 1000.0;

tactum_status read_joint(const char* call, const tactum_joint* given, Joint& joint) {
  tactum_joint taken{};
  if (const tactum_status status = take(call, given, taken); status != TACTUM_OK) return status;
  if (taken.kind < TACTUM_JOINT_FREE || taken.kind > TACTUM_JOINT_BALL)
    return bad_call(call, "there is no kind of joint of this number");
  constexpr JointKind kKinds[] = {JointKind::kFree, JointKind::kFixed, JointKind::kHinge, JointKind::kSlider,
                                  JointKind::kBall};
  joint.kind = kKinds[taken.kind];
  joint.axis_W = vector_of(taken.axis_W);
  if (joint.axis_W.isZero(0.0)) joint.axis_W = Vec3::UnitZ();
  joint.anchor_W = vector_of(taken.anchor_W);
  joint.damping = taken.damping;
  joint.friction = taken.friction;
  joint.stiffness = taken.stiffness;
  joint.rest = taken.rest;
  if (taken.has_limits == 0) return TACTUM_OK;
  joint.lower = taken.lower;
  joint.upper = taken.upper;
  return TACTUM_OK;
}

tactum_status read_body(const char* call, const tactum_body_options* given, BodySpec& body) {
  tactum_body_options taken{};
  if (const tactum_status status = take(call, given, taken); status != TACTUM_OK) return status;
  body.name = text_of(taken.name);
  body.material = text_of(taken.material);
  body.V_WB = twist_of(taken.V_WB);
  if (taken.mass_kg != 0.0) body.mass_kg = taken.mass_kg;
  if (taken.density_kg_per_m3 != 0.0) body.density_kg_per_m3 = taken.density_kg_per_m3;
  return taken.joint == nullptr ? TACTUM_OK : read_joint(call, taken.joint, body.joint);
}

tactum_status read_tool(const char* call, const tactum_tool* given, WorldTool& tool) {
  tactum_tool taken{};
  if (const tactum_status status = take(call, given, taken); status != TACTUM_OK) return status;
  tool.body = text_of(taken.body);
  if (taken.device != nullptr) tool.device = taken.device;
  tool.p_BH = vector_of(taken.p_BH);
  return TACTUM_OK;
}

tactum_status add_pair(const char* call, std::vector<MaterialPair> WorldMaker::*table, tactum_world* world,
                       const char* a, const char* b, double coefficient) {
  return guarded([&] {
    if (world == nullptr || a == nullptr || b == nullptr) return bad_call(call, "a pointer is null");
    (world->maker.*table).push_back({a, b, coefficient});
    return TACTUM_OK;
  });
}

}  // namespace

tactum_status tactum_make_world(const double gravity_W[3], tactum_world** world) {
  return guarded([&] {
    if (world == nullptr) return bad_call("tactum_make_world", "a pointer is null");
    auto made = std::make_unique<tactum_world>();
    if (gravity_W != nullptr) made->maker.world.gravity_W = vector_of(gravity_W);
    *world = made.release();
    return TACTUM_OK;
  });
}

tactum_status tactum_add_body(tactum_world* world, const tactum_part* part, const tactum_pose* X_WP,
                              const tactum_body_options* options, int32_t* body) {
  return guarded([&] {
    if (world == nullptr || part == nullptr || X_WP == nullptr)
      return bad_call("tactum_add_body", "a pointer is null");
    BodySpec spec;
    if (const tactum_status status = read_body("tactum_add_body", options, spec); status != TACTUM_OK)
      return status;
    spec.X_WP = pose_of(*X_WP);
    if (Result<void> sound = check_pose(spec.X_WP, "X_WP"); !sound) return refuse(sound.error());
    spec.part = body_part(*part->part);
    const Result<int> added = world->maker.world.add(spec);
    if (!added) return refuse(added.error());
    if (body != nullptr) *body = *added;
    return TACTUM_OK;
  });
}

tactum_status tactum_join_bodies(tactum_world* world, const char* body, const char* parent,
                                 const tactum_joint* joint, int32_t contact) {
  return guarded([&] {
    if (world == nullptr || body == nullptr || parent == nullptr || joint == nullptr)
      return bad_call("tactum_join_bodies", "a pointer is null");
    Joint taken;
    if (const tactum_status status = read_joint("tactum_join_bodies", joint, taken); status != TACTUM_OK)
      return status;
    const Result<void> joined = world->maker.join(body, parent, taken, contact != 0);
    return joined ? TACTUM_OK : refuse(joined.error());
  });
}

tactum_status tactum_set_friction(tactum_world* world, const char* material_a, const char* material_b,
                                  double coefficient) {
  return add_pair("tactum_set_friction", &WorldMaker::friction, world, material_a, material_b, coefficient);
}

tactum_status tactum_set_restitution(tactum_world* world, const char* material_a, const char* material_b,
                                     double coefficient) {
  return add_pair("tactum_set_restitution", &WorldMaker::restitution, world, material_a, material_b,
                  coefficient);
}

tactum_status tactum_open_world(const tactum_world* world, size_t tool_size, const tactum_tool* tools,
                                size_t tool_count, double rate_Hz, tactum_simulation** scene) {
  return guarded([&] {
    if (world == nullptr || scene == nullptr || (tools == nullptr && tool_count > 0))
      return bad_call("tactum_open_world", "a pointer is null");
    if (tool_count > 0 && tool_size < first_size<tactum_tool>())
      return bad_call("tactum_open_world", "tool_size is not that of the struct");
    std::vector<WorldTool> taken(tool_count);
    const auto* bytes = reinterpret_cast<const unsigned char*>(tools);
    for (size_t i = 0; i < tool_count; ++i)
      if (const tactum_status status = read_tool(
              "tactum_open_world", reinterpret_cast<const tactum_tool*>(bytes + i * tool_size), taken[i]);
          status != TACTUM_OK)
        return status;
    return hand_over_scene(world->maker.simulate(taken, rate_Hz == 0.0 ? kUsualRate_Hz : rate_Hz), scene);
  });
}

void tactum_release_world(tactum_world* world) { delete world; }
