/// Bodies of several parts, and bodies placed on others.

#include <gtest/gtest.h>

#include "tactum/scene/scene_file.h"

namespace tactum::components_test {
namespace {

Result<Scene> parsed(const std::string& text) {
  return parse_scene("schema = 1\n" + text, "test", "test.toml", {});
}

void expect_error(const std::string& text, const std::vector<std::string>& words) {
  const Result<Scene> scene = parsed(text);
  const std::string message = scene ? "no error" : scene.error().message();
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << "wanted: " << word << "\nfound: " << message;
}

constexpr const char* kHammer = R"([[body]]
name = "hammer"
pos_m = [0.1, 0, 0]
density_kg_per_m3 = 1000
[[body.component]]
name = "handle"
part = { box = { size_m = [0.02, 0.02, 0.2] } }
[[body.component]]
name = "head"
on = "handle"
part = { box = { size_m = [0.1, 0.04, 0.04] } }
pos_m = [0, 0, 0.12]
[[body.component]]
on = "head"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [0.06, 0, 0]
rpy_deg = [90, 0, 0]
)";

TEST(Components, MakeOneBodyOfSeveralShapes) {
  const Result<Scene> scene = parsed(kHammer);
  ASSERT_TRUE(scene) << scene.error().message();
  const Body& hammer = scene->world.bodies[0];
  EXPECT_EQ(hammer.part->pieces.size(), 3u);
  // Boxes of 80, 160 and 8 cm^3, their middles on one another.
  EXPECT_NEAR(hammer.mass_kg, 0.248, 1e-12);
  const Vec3 center = (0.160 * Vec3(0, 0, 0.12) + 0.008 * Vec3(0.06, 0, 0.12)) / 0.248;
  EXPECT_LT((hammer.X_WB.p - Vec3(0.1, 0, 0) - center).norm(), 1e-12);
  // The inertia of the three about the common centre, along y.
  const auto about_y = [&](double mass, double x, double z, const Vec3& at) {
    const Vec3 off = at - center;
    return mass * (x * x + z * z) / 12.0 + mass * (off.x() * off.x() + off.z() * off.z());
  };
  const double wanted = about_y(0.08, 0.02, 0.2, Vec3::Zero()) + about_y(0.16, 0.1, 0.04, Vec3(0, 0, 0.12)) +
                        about_y(0.008, 0.02, 0.02, Vec3(0.06, 0, 0.12));
  EXPECT_NEAR(hammer.inertia_B(1, 1), wanted, 1e-12);
}

TEST(Components, HaveASeamlessSurfaceWhereTheyTouch) {
  const Result<Scene> scene = parsed(R"([[body]]
name = "bar"
[[body.component]]
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [-0.01, 0, 0]
[[body.component]]
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [0.01, 0, 0]
)");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_FALSE(scene->world.bodies[0].part->true_surface.single_piece());
}

TEST(Components, ThatOverlapAreRefusedWithHowFar) {
  expect_error(
      R"([[body]]
name = "bar"
[[body.component]]
name = "left"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
[[body.component]]
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [0.015, 0, 0]
)",
      {"two components of one body overlap", "\"left\" and component 2 are 0.005 m inside each other"});
}

TEST(Components, ErrorsNameWhatIsWrong) {
  expect_error(
      "[[body]]\nname = \"b\"\npart = { box = { size_m = [1, 1, 1] } }\n[[body.component]]\n"
      "part = { box = { size_m = [1, 1, 1] } }\n",
      {"two ways to make", "part and component"});
  expect_error(
      "[[body]]\nname = \"b\"\n[[body.component]]\nname = \"shank\"\n"
      "part = { box = { size_m = [1, 1, 1] } }\n[[body.component]]\non = \"shanc\"\n"
      "part = { box = { size_m = [1, 1, 1] } }\n",
      {"no earlier component of this name", "\"shanc\"", "\"shank\"", "test.toml:8:"});
  expect_error("[[body]]\nname = \"b\"\n[[body.component]]\npos_m = [0, 0, 0]\n", {"missing key \"part\""});
  expect_error(
      "[[body]]\nname = \"b\"\n[[body.component]]\n"
      "part = { nut = { size = \"M8\", facets_per_turn = 32 } }\n",
      {"felt by its surface", "convex pieces"});
  expect_error(
      "[[body]]\nname = \"b\"\n[[body.component]]\nname = \"x\"\n"
      "part = { box = { size_m = [1, 1, 1] } }\n[[body.component]]\nname = \"x\"\n"
      "part = { box = { size_m = [1, 1, 1] } }\n",
      {"two components of one name"});
}

TEST(Bodies, StandOnOthers) {
  const Result<Scene> scene = parsed(R"([[body]]
name = "table"
part = { box = { size_m = [1, 1, 0.1] } }
pos_m = [1, 2, 3]
rpy_deg = [0, 0, 90]
[[body]]
name = "cup"
on = "table"
part = { prism = { sides = 16, radius_m = 0.03, height_m = 0.1 } }
pos_m = [0.2, 0, 0.1]
joint = { kind = "hinge", axis = [1, 0, 0] }
)");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_LT((scene->world.bodies[1].X_WB.p - Vec3(1, 2.2, 3.1)).norm(), 1e-12);
  EXPECT_LT((scene->world.bodies[1].joint.axis_W - Vec3(0, 1, 0)).norm(), 1e-12);
  expect_error("[[body]]\nname = \"a\"\non = \"b\"\npart = { box = { size_m = [1, 1, 1] } }\n",
               {"no body of this name", "\"b\""});
}

}  // namespace
}  // namespace tactum::components_test
