/// A body whose mass, centre of mass and inertia are stated, and what that allows.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/program.h"
#include "tactum/scene/scene_file.h"

namespace tactum::inertial_test {
namespace {

Result<Scene> scene_of(const std::string& body, const std::vector<std::string>& folders = {}) {
  return parse_scene("schema = 1\n[[body]]\nname = \"a\"\n" + body, "test", "test.toml", folders);
}

constexpr const char* kInertial =
    "inertial = { mass_kg = 2, center_m = [0.01, 0.02, 0.03], inertia_kg_m2 = [0.02, 0.03, 0.04], "
    "products_kg_m2 = [0.001, 0.002, -0.003] }\n";

void expect_stated(const Result<Scene>& scene) {
  ASSERT_TRUE(scene) << scene.error().message();
  const Body& body = scene->world.bodies[0];
  EXPECT_EQ(body.mass_kg, 2.0);
  Mat3 inertia;
  inertia << 0.02, 0.001, 0.002, 0.001, 0.03, -0.003, 0.002, -0.003, 0.04;
  EXPECT_EQ(body.inertia_B, inertia);
  EXPECT_EQ(body.part->origin, Vec3(0.01, 0.02, 0.03));
  EXPECT_LT((body.X_WB.p - Vec3(1.01, 0.02, 0.03)).norm(), 1e-15);
  double radius = 0.0;
  for (const Vec3& vertex : body.part->surface.vertices) radius = std::max(radius, vertex.norm());
  EXPECT_EQ(body.part->radius, radius);
  EXPECT_TRUE(body.part->notes.remarks.empty());
}

TEST(Inertial, IsThatOfTheBodyWhateverItsShape) {
  for (const char* part : {"{ box = { size_m = [0.1, 0.2, 0.3] } }", "{ ball = { radius_m = 0.1 } }",
                           "{ cylinder = { radius_m = 0.1, height_m = 0.2 } }", "{ mesh = \"ell.obj\" }",
                           "{ mesh = \"ell.obj\", pieces = \"surface\" }", "{ mesh = \"open.obj\" }",
                           "{ capsule = { radius_m = 0.1, height_m = 0.2 } }"}) {
    SCOPED_TRACE(part);
    const testing::ScratchFolder folder;
    std::filesystem::copy_file(fmt::format("{}/tests/import/files/ell.obj", TACTUM_SOURCE_DIR),
                               folder / "ell.obj");
    testing::write(folder / "open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
    const Result<Scene> scene =
        scene_of(fmt::format("pos_m = [1, 0, 0]\n{}part = {}\n", kInertial, part), {folder / ""});
    if (std::string(part).find("open") == std::string::npos) {
      expect_stated(scene);
    } else {
      ASSERT_TRUE(scene) << scene.error().message();
      EXPECT_EQ(scene->world.bodies[0].mass_kg, 2.0);
    }
  }
}

TEST(Inertial, TheSurfaceStaysWhereItWas) {
  const std::string part = "part = { ball = { radius_m = 0.1 } }\npos_m = [1, 0, 0]\n";
  const Result<Scene> plain = scene_of(part), stated = scene_of(part + kInertial);
  ASSERT_TRUE(plain && stated);
  const Body& a = plain->world.bodies[0];
  const Body& b = stated->world.bodies[0];
  EXPECT_EQ(a.part->surface.vertices.size(), b.part->surface.vertices.size());
  for (const Vec3& vertex : b.part->surface.vertices)
    EXPECT_NEAR((b.X_WB * vertex - Vec3(1, 0, 0)).norm(), 0.1, 1e-15);
  EXPECT_LT((a.X_WB * a.part->groups.rounds[0].center - b.X_WB * b.part->groups.rounds[0].center).norm(),
            1e-15);
}

TEST(Inertial, NonsenseIsRefused) {
  const auto error_of = [](const std::string& inertial) {
    const Result<Scene> scene = scene_of("part = { ball = { radius_m = 0.1 } }\n" + inertial);
    return scene ? "no error" : scene.error().message();
  };
  EXPECT_NE(
      error_of("inertial = { mass_kg = 1, inertia_kg_m2 = [1, 1, 3] }").find("no body has this inertia"),
      std::string::npos);
  EXPECT_NE(error_of("inertial = { mass_kg = 1, inertia_kg_m2 = [1, 1, 1], products_kg_m2 = [2, 0, 0] }")
                .find("no body has this inertia"),
            std::string::npos);
  EXPECT_NE(error_of("inertial = { mass_kg = 0, inertia_kg_m2 = [1, 1, 1] }").find("out of range"),
            std::string::npos);
  EXPECT_NE(error_of("mass_kg = 1\ninertial = { mass_kg = 1, inertia_kg_m2 = [1, 1, 1] }").find("two masses"),
            std::string::npos);
  EXPECT_NE(error_of("inertial = { inertia_kg_m2 = [1, 1, 1] }").find("mass_kg"), std::string::npos);
}

constexpr const char* kOverlapping =
    "[[body.component]]\npart = { box = { size_m = [0.1, 0.1, 0.1] } }\n"
    "[[body.component]]\npart = { ball = { radius_m = 0.06 } }\n";

TEST(Inertial, ComponentsMayOverlapWhereNothingWeighsTwice) {
  EXPECT_FALSE(scene_of(kOverlapping));
  const Result<Scene> stated = scene_of(std::string(kInertial) + kOverlapping);
  ASSERT_TRUE(stated) << stated.error().message();
  EXPECT_EQ(stated->world.bodies[0].part->pieces.size(), 2u);
  EXPECT_TRUE(scene_of(std::string("joint = { kind = \"fixed\" }\n") + kOverlapping));
}

TEST(Inertial, AComponentThatIsASurfaceMakesTheBodyOne) {
  const std::vector<std::string> folders{fmt::format("{}/tests/import/files", TACTUM_SOURCE_DIR)};
  const std::string components =
      "[[body.component]]\npart = { mesh = \"ell.obj\", pieces = \"surface\" }\n"
      "[[body.component]]\npart = { box = { size_m = [0.1, 0.1, 0.1] } }\npos_m = [-2, 0, 0]\n";
  const Result<Scene> plain = scene_of(components, folders);
  ASSERT_FALSE(plain);
  EXPECT_NE(plain.error().message().find("or the key inertial"), std::string::npos);
  const Result<Scene> stated = scene_of(kInertial + components, folders);
  ASSERT_TRUE(stated) << stated.error().message();
  const Part& part = *stated->world.bodies[0].part;
  EXPECT_TRUE(part.is_surface());
  EXPECT_NEAR(mass_properties(part.surface, 1.0)->volume, 0.375 * (1.0 * 0.5 - 0.5 * 0.25) + 0.001, 1e-12);
}

TEST(Capsule, IsOnTheTrueOneAndNearlyFillsIt) {
  const Result<Scene> scene =
      scene_of("part = { capsule = { radius_m = 0.1, height_m = 0.3, sides = 64 } }\n");
  ASSERT_TRUE(scene) << scene.error().message();
  const Part& part = *scene->world.bodies[0].part;
  for (const Vec3& v : part.surface.vertices) {
    const double along = std::max(0.0, std::abs(v.z()) - 0.15);
    EXPECT_NEAR(std::hypot(v.x(), v.y(), along), 0.1, 1e-15);
  }
  const double volume = kPi * 0.01 * (0.3 + 4.0 / 3.0 * 0.1);
  EXPECT_LT(part.mass.volume, volume);
  EXPECT_GT(part.mass.volume, 0.99 * volume);
  EXPECT_NE(scene_of("part = { capsule = { radius_m = 0.1, height_m = 0.3, sides = 30 } }\n")
                .error()
                .message()
                .find("a multiple of 4"),
            std::string::npos);
}

TEST(MeshScale, EachAxisByItsOwnAndMirrored) {
  const std::vector<std::string> folders{fmt::format("{}/tests/import/files", TACTUM_SOURCE_DIR)};
  const Result<Scene> scene =
      scene_of("part = { mesh = \"ell.obj\", scale_xyz = [0.1, -0.2, 0.4] }\n", folders);
  ASSERT_TRUE(scene) << scene.error().message();
  const Part& part = *scene->world.bodies[0].part;
  EXPECT_NEAR(part.mass.volume, 0.008 * 0.375 * 0.375, 1e-15);
  EXPECT_LT(part.origin.y(), 0.0);
  EXPECT_TRUE(
      part.notes.remarks.empty());  // a mesh that was turned outside in would have been mended, and told
  const auto refused = [&](const char* keys, const char* why) {
    const Result<Scene> bad = scene_of(fmt::format("part = {{ mesh = \"ell.obj\", {} }}\n", keys), folders);
    ASSERT_FALSE(bad);
    EXPECT_NE(bad.error().message().find(why), std::string::npos) << bad.error().message();
  };
  refused("scale_xyz = [1, 0, 1]", "a scale of zero");
  refused("scale = 1, scale_xyz = [1, 1, 1]", "two scales");
}

}  // namespace
}  // namespace tactum::inertial_test
