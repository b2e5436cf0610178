#include "view_part.h"

#include "commands.h"
#include "tactum/scene/scene.h"
#include "watch.h"

namespace tactum {
namespace {

/// The hand of a scene in which there is nothing to feel.
class StillHand final : public HandMotion {
 public:
  HandState at(double) const noexcept override { return {}; }
  double duration_s() const noexcept override { return 0.0; }
};

/// The part alone, fixed, with nothing in the hand.
Scene scene_of(const Part& part) {
  Body body;
  body.name = part.name;
  body.part = std::make_shared<const Part>(part);
  body.joint.kind = JointKind::kFixed;
  Scene scene;
  scene.name = part.name;
  scene.description = "a part to be looked at";
  scene.world.bodies.push_back(std::move(body));
  scene.device = "premium-1.5-6dof";
  scene.grip = "medium";
  scene.hand = std::make_shared<StillHand>();
  return scene;
}

}  // namespace

void view_part(const Part& part, int port) {
  Result<std::unique_ptr<Viewer>> viewer = Viewer::open(scene_of(part), {}, port);
  if (!viewer) fail(viewer.error());
  watch_for_interrupts();
  open_page(stdout, (*viewer)->server().address());
  run_viewed(**viewer, 0);
}

}  // namespace tactum
