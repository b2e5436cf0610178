#include <gtest/gtest.h>

#include <cmath>

#include "tactum/math/screw.h"
#include "tactum/parts/bolt_and_nut.h"
#include "tactum/parts/gear.h"
#include "tactum/scene/scene_file.h"
#include "tactum/surface/surface_distance.h"

namespace tactum::made_shape_test {
namespace {

Result<Scene> with_part(const std::string& part) {
  return parse_scene("schema = 1\n[[body]]\nname = \"b\"\npart = " + part + "\n", "test", "test.toml", {});
}

std::string error_of(const std::string& part) {
  const Result<Scene> scene = with_part(part);
  return scene ? "no error" : scene.error().message();
}

void expect_error(const std::string& part, const std::string& text) {
  EXPECT_NE(error_of(part).find(text), std::string::npos) << part << "\n  says: " << error_of(part);
}

Vec3 extent(const std::string& part) {
  const Result<Scene> scene = with_part(part);
  EXPECT_TRUE(scene) << part << ": " << (scene ? "" : scene.error().message());
  if (!scene) return Vec3::Zero();
  return 2.0 * bounds(scene->world.bodies[0].part->surface.vertices).half();
}

TEST(MadeShapes, EveryShapeOfThePageIsRead) {
  for (const char* part :
       {"{ gear = { teeth = 20, profile_shift = 0.1 } }", "{ gear = { as = \"surface\", flank_facets = 3 } }",
        "{ peg = { sides = 64, width_m = 0.025, fit = \"H7/g6\" } }",
        "{ hole_block = { sides = 64, fit = \"H7/g6\", fit_position = \"max_clearance\" } }",
        "{ bolt = { size = \"M8\", class = \"fine\", length_m = 0.02, facets_per_turn = 32 } }",
        "{ nut = { size = \"M8\", clearance_m = 0.00005, facets_per_turn = 32 } }",
        "{ hex_key = { across_flats_m = 0.008, long_m = 0.1, short_m = 0.036 } }",
        "{ socket = { across_flats_m = 0.008, diameter_m = 0.016, fit = \"D9/h9\" } }",
        "{ slotted_plate = { slots = 2, end_facets = 8 } }"}) {
    EXPECT_EQ(error_of(part), "no error") << part;
  }
}

TEST(MadeShapes, FitsSetTheSizesOfPegAndHole) {
  // 25 H7 is +21/0 um, 25 g6 is -7/-20 um, 14 H7 +18/0, 14 g6 -6/-17.
  const auto peg = [](const std::string& more) {
    return extent("{ peg = { width_m = 0.025, depth_m = 0.014, fit = \"H7/g6\"" + more + " } }");
  };
  EXPECT_NEAR(peg("").x(), 0.025 - 13.5e-6, 1e-12);
  EXPECT_NEAR(peg("").y(), 0.014 - 11.5e-6, 1e-12);
  EXPECT_NEAR(peg(", fit_position = \"min_clearance\"").x(), 0.025 - 7e-6, 1e-12);
  EXPECT_NEAR(peg(", fit_position = \"max_clearance\"").x(), 0.025 - 20e-6, 1e-12);
  EXPECT_NEAR(peg(", fit_position = \"max_clearance\"").y(), 0.014 - 17e-6, 1e-12);
  const auto block = [](const std::string& more) {  // outside: the hole and two walls
    return extent(
        "{ hole_block = { peg_width_m = 0.025, peg_depth_m = 0.014, wall_m = 0.01, fit = \"H7/g6\"" + more +
        " } }");
  };
  EXPECT_NEAR(block("").x(), 0.045 + 10.5e-6, 1e-12);
  EXPECT_NEAR(block("").y(), 0.034 + 9e-6, 1e-12);
  EXPECT_NEAR(block(", fit_position = \"min_clearance\"").x(), 0.045, 1e-12);
  EXPECT_NEAR(block(", fit_position = \"max_clearance\"").x(), 0.045 + 21e-6, 1e-12);
  // A hole smaller than nominal, and a round peg: its corners lie on the circle.
  EXPECT_NEAR(extent("{ hole_block = { peg_width_m = 0.025, peg_depth_m = 0.025, wall_m = 0.01, "
                     "fit = \"P7/h6\" } }")
                  .x(),
              0.045 - 24.5e-6, 1e-12);
  EXPECT_NEAR(
      extent("{ peg = { sides = 4, width_m = 0.025, fit = \"H7/h6\", fit_position = \"min_clearance\" } }")
              .x() *
          std::sqrt(2.0),
      0.025, 1e-12);
  EXPECT_NEAR(extent("{ hex_key = { across_flats_m = 0.008, fit = \"H9/h9\" } }").y(), 0.008 - 18e-6, 1e-12);
}

TEST(MadeShapes, BoltNutAndSurfaceGearAreMeshesInTheirOwnFrame) {
  const Result<Scene> scene = with_part("{ nut = { size = \"M10\", facets_per_turn = 32 } }");
  ASSERT_TRUE(scene);
  const Part& part = *scene->world.bodies[0].part;
  ScrewShape shape;
  shape.size = "M10";
  shape.facets_per_turn = 32;
  EXPECT_EQ(part.surface.triangles.size(), nut_mesh(shape)->triangles.size());
  EXPECT_TRUE(part.is_surface());
  EXPECT_TRUE(scene->remarks.empty());
  EXPECT_NEAR(part_pose(scene->world.bodies[0], scene->world.bodies[0].X_WB).p.norm(), 0.0, 1e-15);
  const Result<Scene> gear = with_part("{ gear = { as = \"surface\" } }");
  ASSERT_TRUE(gear);
  EXPECT_EQ(gear->world.bodies[0].part->surface.triangles.size(), gear_surface(Gear{})->triangles.size());
}

TEST(MadeShapes, ANutOnItsBoltIsFreeAtItsPoseInTheScene) {
  // Raised by two and a quarter pitches of 1.5 mm and turned by as many turns.
  const Result<Scene> scene = parse_scene(R"(schema = 1
[[body]]
name = "bolt"
part = { bolt = { size = "M10", length_m = 0.02, facets_per_turn = 32 } }
joint = { kind = "fixed" }
[[body]]
name = "nut"
part = { nut = { size = "M10", facets_per_turn = 32 } }
pos_m = [0, 0, 0.003375]
rpy_deg = [0, 0, 90]
)",
                                          "test", "test.toml", {});
  ASSERT_TRUE(scene) << scene.error().message();
  const Body& bolt = scene->world.bodies[0];
  const Body& nut = scene->world.bodies[1];
  const Surface of_bolt(bolt.part->surface);
  const Surface of_nut(nut.part->surface);
  SurfacePairCache cache;
  const double distance = surface_distance(of_bolt, of_nut, bolt.X_WB.inverse() * nut.X_WB, cache).distance;
  const double clearance = thread_fit("M10", "medium")->flank_clearance_m();
  EXPECT_GT(distance, 0.995 * clearance);
  EXPECT_LT(distance, clearance + 5e-3 * (1.0 - std::cos(kPi / 32)));
}

TEST(MadeShapes, ErrorsTellTheKey) {
  expect_error("{ peg = { fit = \"H7/q6\" } }", "test.toml:4:24");
  expect_error("{ peg = { fit = \"H7/q6\" } }", "expected a shaft of d e f g h js k m n p r s");
  expect_error("{ peg = { width_m = 0.6, fit = \"H7/g6\" } }", "found 600 mm, expected 1 to 500 mm");
  expect_error("{ peg = { width_m = 0.02, depth_m = 0.0005, fit = \"H7/g6\" } }", "found 0.5 mm");
  expect_error("{ peg = { fit = \"H7\" } }", "a hole and a shaft, such as H7/g6");
  expect_error("{ peg = { fit_position = \"mid\" } }", "a place within no fit in [body 1.part.peg]");
  expect_error("{ peg = { fit = \"H7/g6\", fit_position = \"middle\" } }", "fit_position");
  expect_error("{ hole_block = { fit = \"H7/g6\", clearance_m = 0.001 } }",
               "two clearances in [body 1.part.hole_block]");
  expect_error("{ socket = { fit = \"H7/g6\", clearance_m = 0.001 } }", "two clearances");
  expect_error("{ gear = { as = \"mesh\" } }", "surface");
  expect_error("{ gear = { profile_shift = 2 } }", "profile_shift");
  expect_error("{ bolt = { size = \"M17\" } }", "found \"M17\", expected one of M3 M4");
  expect_error("{ bolt = { length_m = 0.001 } }", "3 to 100 pitches");
  expect_error("{ bolt = { class = \"loose\" } }", "fine, medium or coarse");
  expect_error("{ bolt = { class = \"fine\", clearance_m = 0.0001 } }",
               "two clearances in [body 1.part.bolt]");
  expect_error("{ nut = { facets_per_turn = 40 } }", "a multiple of 16");
  expect_error("{ nut = { length_m = 0.02 } }", "unknown key");
  expect_error("{ nut = { clearance_m = 0.001 } }", "an eighth of the pitch");
  expect_error("{ hex_key = { short_m = 0.001 } }", "short arm");
  expect_error("{ socket = { diameter_m = 0.001 } }", "more than the hole's");
  expect_error("{ slotted_plate = { end_facets = 3 } }", "an even number");
  expect_error("{ slotted_plate = { slots = 100 } }", "slots");
  expect_error("{ }", "one of mesh, gear, peg, hole_block, bolt, nut, hex_key, socket, slotted_plate, box");
}

}  // namespace
}  // namespace tactum::made_shape_test
