/// The scenes with force fields: the basis of their goals, and that safety holds for any field.

#include <gtest/gtest.h>

#include <vector>

#include "support/effort.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum::force_fields_test {
namespace {

/// Runs the scene as long as its motion.
std::unique_ptr<Session> run(Scene scene) {
  const auto frames = static_cast<std::uint64_t>(frames_of_motion(scene));
  Result<std::unique_ptr<Session>> session = Session::open(std::move(scene), {});
  EXPECT_TRUE(session);
  EXPECT_TRUE((*session)->run_virtual(frames, nullptr));
  return std::move(*session);
}

Scene opened(const char* name) {
  Result<Scene> scene = open_scene(name);
  EXPECT_TRUE(scene) << scene.error().message();
  return std::move(*scene);
}

TEST(ForceFields, OnlyTheFieldBringsThePartsTogether) {
  for (const char* name : testing::sampled(std::vector{"dipole-field", "vortex-field"}, 2))
    for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
      for (const bool on : {true, false}) {
        SCOPED_TRACE(name);
        Scene scene = opened(name);
        scene.settings.response = response;
        if (!on) scene.world.fields.clear();
        const std::unique_ptr<Session> session = run(std::move(scene));
        EXPECT_EQ(session->goals().met(0), on) << session->goals().describe(session->scene().world, 0);
        EXPECT_TRUE(session->goals().met(1)) << session->goals().describe(session->scene().world, 1);
        EXPECT_EQ(session->record().non_finite_frames, 0u);
      }
}

TEST(ForceFields, NoFieldHoweverStrongPassesTheLimitsOfTheDevice) {
  for (const double scale : {1e3, -1e3, 1e12}) {
    Scene scene = opened("vortex-field");
    ForceField& field = scene.world.fields[0];
    field.scale = scale;
    field.largest_force_N = field.largest_torque_Nm = std::numeric_limits<double>::infinity();
    const std::unique_ptr<Session> session = run(std::move(scene));
    EXPECT_EQ(session->record().non_finite_frames, 0u);
    const double rounding = 1.0 + 1e-12;
    EXPECT_LE(session->record().max_force_N, rounding * session->device().max_force_N);
    EXPECT_LE(session->record().max_torque_Nm, rounding * session->device().max_torque_Nm);
    EXPECT_EQ(session->record().penetrating_frames, 0u);
  }
}

}  // namespace
}  // namespace tactum::force_fields_test
