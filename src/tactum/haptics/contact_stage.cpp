#include "tactum/haptics/contact_stage.h"

#include <algorithm>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The curved surfaces of a part's pieces: those it was made with, else those that shading sees in facets. Of
/// a part that is felt by its surface: the ball that it is.
std::vector<RoundPiece> rounds_of(const Part& part, const Shading& shading) {
  if (!part.groups.rounds.empty() || !shading.on) return part.groups.rounds;
  std::vector<RoundPiece> rounds;
  if (part.is_surface()) {
    const RoundPiece ball = find_ball(part.surface, shading.crease_rad);
    if (ball.kind == RoundKind::kSphere) rounds.push_back(ball);
    return rounds;
  }
  bool any = false;
  for (const Polytope& piece : part.pieces)
    any |= rounds.emplace_back(find_round_piece(piece, shading.crease_rad)).kind != RoundKind::kNone;
  return any ? rounds : std::vector<RoundPiece>{};
}

std::vector<CollisionBody> collision_bodies(const World& world, const Shading& shading) {
  const bool surfaces = std::any_of(world.bodies.begin(), world.bodies.end(),
                                    [](const Body& body) { return body.part->is_surface(); });
  std::vector<CollisionBody> bodies;
  for (const Body& body : world.bodies) {
    CollisionBody& made = bodies.emplace_back();
    made = {body.part.get(), body.moves(), body.no_contact_with, rounds_of(*body.part, shading), {}};
    if (shading.on && (surfaces || (made.moves && made.rounds.empty())))
      made.revolution = find_revolution(body.part->surface, shading.crease_rad);
  }
  return bodies;
}

void find_priorities(std::span<const HandInput> hands, ContactStage& stage) {
  std::vector<std::uint8_t>& priority = stage.priority;
  std::fill(priority.begin(), priority.end(), priority::kOther);
  for (const HandInput& hand : hands) {
    const int grasped = hand.grasped.body;
    if (grasped < 0) continue;
    for (const ContactPatch& patch : stage.finder.patches()) {
      if (patch.body_a == grasped) priority[Index(patch.body_b)] = priority::kTouchesGrasped;
      if (patch.body_b == grasped) priority[Index(patch.body_a)] = priority::kTouchesGrasped;
    }
  }
  for (const HandInput& hand : hands)
    if (hand.grasped.body >= 0) priority[Index(hand.grasped.body)] = priority::kGrasped;
}

/// Reports the distances that the frame found, before anything moved.
void report_distances(const World& world, std::span<const ContactPatch> patches, FrameReport& report) {
  for (const ContactPatch& patch : patches) {
    const double size =
        world.bodies[Index(patch.body_a)].part->size + world.bodies[Index(patch.body_b)].part->size;
    report.penetrating |= -patch.distance > tolerances::kPenetrating * size;
    report.tolerance_m = std::max(report.tolerance_m, patch.tolerance);
    const bool first = &patch == patches.data();
    report.min_distance_m = first ? patch.distance : std::min(report.min_distance_m, patch.distance);
  }
}

std::uint32_t flags_of(const ContactWork& work) {
  return (work.unchecked > 0 ? frame_flag::kBudgetShort : 0u) |
         (work.capacity_reached ? frame_flag::kCapacityReached : 0u) |
         (work.uncertified > 0 ? frame_flag::kUncertified : 0u);
}

}  // namespace

ContactStage::ContactStage(const World& world, const FrameSettings& settings, std::span<const Pose> X_WB)
    : finder(collision_bodies(world, settings.shading), X_WB, settings.budget.capacity, settings.dt_s,
             settings.smallest_scale()),
      priority(world.bodies.size(), priority::kOther) {
  if (!settings.shading.on) return;
  bool some_bend = false;
  for (const Body& body : world.bodies)
    some_bend |= shading.emplace_back(*body.part, settings.shading.crease_rad).bends();
  if (!some_bend) shading.clear();
}

void find_near_pairs(const FrameSettings& settings, std::span<const Pose> X_WB,
                     std::span<const double> motion_bound, std::span<const HandInput> hands,
                     ContactStage& stage) noexcept {
  find_priorities(hands, stage);
  stage.finder.find_near_pairs(X_WB, motion_bound,
                               settings.penalty.min_tolerance_m * settings.smallest_scale());
}

std::span<const ContactPatch> find_patches(const World& world, const FrameSettings& settings,
                                           std::span<const Pose> X_WB, PatchPoints points,
                                           ContactStage& stage, FrameReport& report) noexcept {
  stage.finder.find_patches(X_WB, settings.budget.max_exact_tests, points, stage.priority);
  report.work = stage.finder.work();
  report.flags |= flags_of(report.work);
  report_distances(world, stage.finder.patches(), report);
  return stage.finder.patches();
}

}  // namespace tactum::inline v0_1
