// What is said of a scene that loads and yet makes no sense, and that nothing is said of those that do.

#include "tactum/scene/scene_remarks.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/effort.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"

namespace tactum::scene_remarks_test {
namespace {

namespace fs = std::filesystem;

const std::string kPlate =
    "[[body]]\nname = \"plate\"\npart = { box = { size_m = [0.16, 0.16, 0.01] } }\npos_m = [0, 0, -0.005]\n"
    "joint = { kind = \"fixed\" }\n";
const std::string kTool = "[tool]\nbody = \"block\"\n";

std::string block(const std::string& size, const std::string& at, const std::string& more = "") {
  return "[[body]]\nname = \"block\"\npart = { box = { size_m = " + size + " } }\npos_m = " + at + "\n" +
         more;
}

std::vector<SceneRemark> remarks_of(const std::string& text, const std::vector<std::string>& folders = {}) {
  const Result<SceneDescription> description =
      parse_description("schema = 1\n" + text, "test", "test.toml", folders);
  EXPECT_TRUE(description) << (description ? "" : description.error().message());
  if (!description) return {};
  const Result<Scene> scene = build_scene(*description);
  EXPECT_TRUE(scene) << (scene ? "" : scene.error().message());
  return scene ? remarks_on(*description, *scene) : std::vector<SceneRemark>{};
}

/// The facts, or the warnings, one a line.
std::string texts(const std::vector<SceneRemark>& remarks, bool warning) {
  std::string text;
  for (const SceneRemark& remark : remarks)
    if (remark.warning == warning) text += remark.text + "\n";
  return text;
}
std::string warnings_of(const std::string& text) { return texts(remarks_of(text), true); }

void expect_warning(const std::string& scene, const std::string& said) {
  const std::string warnings = warnings_of(scene);
  EXPECT_NE(warnings.find(said), std::string::npos) << warnings << "  lacks: " << said << "\n" << scene;
}

TEST(SceneRemarks, ASoundSceneHasItsSizesAndNoWarning) {
  const std::vector<SceneRemark> remarks =
      remarks_of(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.015]") + kTool);
  EXPECT_EQ(texts(remarks, true), "");
  EXPECT_EQ(texts(remarks, false),
            "the scene is 160 x 160 x 35 mm large; 2 bodies, 1 of them can move\n"
            "the held part \"block\" is 40 x 30 x 20 mm large and weighs 24 g\n"
            "the held part \"block\" is 5 mm from the nearest body, \"plate\"\n");
}

TEST(SceneRemarks, SizesInMillimetres) {
  expect_warning(kPlate + block("[40, 30, 20]", "[0, 0, 15]") + kTool,
                 "the held part \"block\" is 40 m long; are its sizes in millimetres?");
  expect_warning(
      "[[body]]\nname = \"plate\"\npart = { box = { size_m = [160, 160, 10] } }\njoint = { kind = \"fixed\" "
      "}\n" +
          block("[40, 30, 20]", "[0, 0, 15]") + kTool,
      "the body \"plate\" is 160 m long");
  expect_warning(kPlate + block("[4e-5, 3e-5, 2e-5]", "[0, 0, 0.015]") + kTool, "too small to be felt");
  // A workspace that is scaled up feels large parts as they are meant.
  const std::string house = "[workspace]\nscale = 100\n";
  const std::string large = warnings_of(kPlate + block("[40, 30, 20]", "[0, 0, 15]") + kTool + house);
  EXPECT_EQ(large.find("millimetres"), std::string::npos) << large;
}

TEST(SceneRemarks, OverlapsNameTheBodiesAndTheDepth) {
  expect_warning(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.002]") + kTool,
                 "\"plate\" and \"block\" overlap at the start: they are 8 mm inside each other");
  expect_warning(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.0099]") + kTool, "100 um inside");
  // Neither is held.
  expect_warning(
      kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.05]") +
          "[[body]]\nname = \"ball\"\npart = { ball = { radius_m = 0.01 } }\npos_m = [0.05, 0, 0.007]\n" +
          kTool,
      "\"plate\" and \"ball\" overlap at the start: they are 3");
}

TEST(SceneRemarks, WhatTouchesOrIsJointedDoesNotOverlap) {
  for (const char* height : {"0.01", "0.010001", "0.009999"})
    EXPECT_EQ(
        warnings_of(kPlate + block("[0.04, 0.03, 0.02]", std::string("[0, 0, ") + height + "]") + kTool), "");
  EXPECT_EQ(warnings_of("[[body]]\nname = \"base\"\npart = { box = { size_m = [0.1, 0.1, 0.05] } }\n" +
                        block("[0.04, 0.03, 0.02]", "[0, 0, 0.002]",
                              "joint = { kind = \"hinge\", axis = [0, 0, 1], parent = \"base\" }\n") +
                        kTool),
            "");
  // Two that never move may be built into each other.
  EXPECT_EQ(warnings_of(kPlate +
                        "[[body]]\nname = \"post\"\npart = { box = { size_m = [0.01, 0.01, 0.03] } }\n"
                        "joint = { kind = \"fixed\" }\n" +
                        block("[0.04, 0.03, 0.02]", "[0, 0, 0.05]") + kTool),
            "");
}

/// A box as an OBJ file of twelve triangles, `size` units wide.
std::string box_file(double size) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += "v " + std::to_string((i & 1) * size) + " " + std::to_string((i >> 1 & 1) * size) + " " +
            std::to_string((i >> 2 & 1) * size) + "\n";
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

class MeshRemarks : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "tactum-remarks-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    std::ofstream(fs::path(folder_) / "mm.obj") << box_file(60);
    std::ofstream(fs::path(folder_) / "m.obj") << box_file(0.02);
    std::ofstream(fs::path(folder_) / "inch.obj") << box_file(3);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string warnings(const std::string& part, const std::string& at) {
    return texts(remarks_of(kPlate + "[[body]]\nname = \"block\"\npart = { " + part + " }\npos_m = " + at +
                                "\n" + kTool,
                            {folder_}),
                 true);
  }
  std::string folder_;
};

TEST_F(MeshRemarks, AMeshInMillimetresHasTheScaleToWrite) {
  const std::string mm = warnings("mesh = \"mm.obj\"", "[0, 0, 0.1]");
  EXPECT_NE(mm.find("is 60 m long, since it has no `scale`; if it is in millimetres, write part = { mesh = "
                    "\"mm.obj\", scale = 0.001 } (test.toml:9:17)"),
            std::string::npos)
      << mm;
  EXPECT_EQ(mm.find("are its sizes in"), std::string::npos) << "said twice: " << mm;
  EXPECT_NE(warnings("mesh = \"inch.obj\"", "[0, 0, 0.1]").find("scale = 0.0254"), std::string::npos);
  EXPECT_NE(warnings("mesh = \"mm.obj\", scale = 1", "[0, 0, 0.1]").find("60 m long; are its sizes"),
            std::string::npos);
  EXPECT_EQ(warnings("mesh = \"mm.obj\", scale = 0.001", "[0, 0, 0.01]"), "");
  EXPECT_EQ(warnings("mesh = \"m.obj\"", "[0, 0, 0.01]"), "");
}

TEST_F(MeshRemarks, SurfacesOverlapAsPiecesDo) {
  const std::string surface = "mesh = \"m.obj\", pieces = \"surface\"";
  EXPECT_NE(warnings(surface, "[0, 0, -0.004]").find("they are 4 mm inside each other"), std::string::npos)
      << warnings(surface, "[0, 0, -0.004]");
  EXPECT_EQ(warnings(surface, "[0, 0, 0]"), "") << "it stands on the plate";
  // One wholly inside the other, where no triangles touch.
  const std::string inside = "mesh = \"m.obj\", scale = 0.2, pieces = \"surface\"";
  EXPECT_NE(warnings(inside, "[0, 0, -0.006]").find("overlap at the start"), std::string::npos);
}

TEST(SceneRemarks, WhatDoesNotFit) {
  const auto peg_and_hole = [](const std::string& hole, const std::string& peg) {
    return "[[body]]\nname = \"hole\"\npart = { hole_block = { " + hole +
           " } }\njoint = { kind = \"fixed\" }\n" + "[[body]]\nname = \"peg\"\npart = { peg = { " + peg +
           " } }\npos_m = [0, 0, 0.06]\n[tool]\nbody = \"peg\"\n";
  };
  const std::string eight = "peg_width_m = 0.008, peg_depth_m = 0.008";
  const std::string peg = "width_m = 0.008, depth_m = 0.008, length_m = 0.03";
  EXPECT_EQ(warnings_of(peg_and_hole(eight + ", clearance_m = 0.0005", peg)), "");
  EXPECT_EQ(warnings_of(peg_and_hole(eight + ", clearance_m = 0", peg)), "");
  expect_warning(
      peg_and_hole(eight + ", clearance_m = -0.0005", peg),
      "the peg \"peg\" does not fit the hole of \"hole\": it is 500 um too large, a clearance of -500 um");
  expect_warning(
      peg_and_hole(eight + ", clearance_m = 0.0005", "width_m = 0.01, depth_m = 0.008, length_m = 0.03"),
      "it is 1.5 mm too large");
  expect_warning(peg_and_hole("sides = 32, peg_width_m = 0.01, fit = \"H7/p6\"",
                              "sides = 32, width_m = 0.01, fit = \"H7/p6\""),
                 "does not fit the hole");
  EXPECT_EQ(warnings_of(peg_and_hole("sides = 32, peg_width_m = 0.01, fit = \"H7/g6\"",
                                     "sides = 32, width_m = 0.01, fit = \"H7/g6\"")),
            "");
  // Other shapes than the hole's: only what no turn cures is told.
  const std::string round_hole = "sides = 64, peg_width_m = 0.01, clearance_m = 0.0005";
  EXPECT_EQ(warnings_of(peg_and_hole(round_hole, "width_m = 0.007, depth_m = 0.007, length_m = 0.03")), "");
  expect_warning(peg_and_hole(round_hole, "width_m = 0.008, depth_m = 0.008, length_m = 0.03"),
                 "it is 801 um too large");  // over its corners 11.31, in 10.5 mm and a little
  EXPECT_EQ(warnings_of(peg_and_hole(eight + ", clearance_m = 0.0005", "sides = 64, width_m = 0.0082")), "");
  expect_warning(peg_and_hole(eight + ", clearance_m = 0.0005", "sides = 64, width_m = 0.009"), "too large");
  EXPECT_EQ(warnings_of(peg_and_hole(eight + ", clearance_m = 0", "sides = 4, width_m = 0.011")), "")
      << "a square of 7.8 mm, given by its corners";
  EXPECT_EQ(warnings_of(peg_and_hole("peg_width_m = 0.01, peg_depth_m = 0.01, clearance_m = 0",
                                     "width_m = 0.0125, depth_m = 0.001, length_m = 0.03")),
            "")
      << "a blade that goes in across the corners";
  const std::string key =
      "[[body]]\nname = \"socket\"\npart = { socket = { across_flats_m = 0.005, clearance_m = -0.0002 } }\n"
      "joint = { kind = \"fixed\" }\n"
      "[[body]]\nname = \"key\"\npart = { hex_key = { across_flats_m = 0.005 } }\npos_m = [0, 0, 0.05]\n"
      "[tool]\nbody = \"key\"\n";
  expect_warning(key, "the key \"key\" does not fit the socket of \"socket\": it is 200 um too large");
}

TEST(SceneRemarks, NothingHeldOrNothingToPick) {
  expect_warning(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.015]"),
                 "nothing is held: the scene has no [tool], so nothing is felt");
  expect_warning(kPlate + "[tool]\npicks = true\n", "nothing to pick");
  expect_warning(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.015]") +
                     "[tool]\npicks = true\n[workspace]\npos_m = [0, 0, 5]\n",
                 "nothing is within reach of the hand");
  EXPECT_EQ(warnings_of(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.015]") + "[tool]\npicks = true\n"),
            "");
  expect_warning(block("[0.04, 0.03, 0.02]", "[0, 0, 0.015]") + kTool, "there is nothing to touch");
}

TEST(SceneRemarks, NothingWithinReach) {
  expect_warning(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.5]") + kTool,
                 "nothing is within reach of the held part: the nearest body, \"plate\", is 490 mm away");
  expect_warning(kPlate + block("[0.04, 0.03, 0.02]", "[0.35, 0.35, 0]") + kTool, "nothing is within reach");
  expect_warning("device = \"touch\"\n" + kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.11]") + kTool,
                 "device touch moves it by 75 mm at most");
  EXPECT_EQ(warnings_of(kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.11]") + kTool), "");
}

TEST(SceneRemarks, MassesAndSprings) {
  const auto heavy = [](const std::string& mass, const std::string& first = "") {
    return first + kPlate + block("[0.04, 0.03, 0.02]", "[0, 0, 0.015]", mass + "\n") + kTool;
  };
  expect_warning(heavy("mass_kg = 1e9"), "the densest metal has 22 600");
  expect_warning(kPlate + block("[0.4, 0.4, 0.4]", "[0, 0, 0.3]", "mass_kg = 500\n") + kTool,
                 "hardly moves it");
  expect_warning(heavy("mass_kg = 1e-9"), "lighter than air");
  expect_warning(heavy("density_kg_per_m3 = 1e6"), "the densest metal");
  expect_warning(heavy("density_kg_per_m3 = 0.001"), "lighter than air");
  expect_warning("gravity_m_per_s2 = [0, 0, -9.81]\n" + kPlate +
                     block("[0.1, 0.1, 0.1]", "[0, 0, 0.06]", "density_kg_per_m3 = 7800\n") + kTool,
                 "the device premium-1.5-6dof exerts 8.5 N at most");
  expect_warning(heavy("joint = { kind = \"slider\", axis = [0, 0, 1], stiffness_N_per_m = 1e9 }"),
                 "stiffer than any spring");
  for (const char* usual :
       {"mass_kg = 0.024", "mass_kg = 0.3", "density_kg_per_m3 = 19300", "density_kg_per_m3 = 20"})
    EXPECT_EQ(warnings_of(heavy(usual)), "") << usual;
}

TEST(SceneRemarks, ACouplingBeyondItsBoundIsRefusedWithTheReason) {
  const Result<Scene> scene =
      parse_scene("schema = 1\n" + kPlate + "[coupling]\nstiffness_N_per_m = 1e9\n", "t", "t.toml", {});
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message().find("expected 1 to 50000: beyond that no hand-held device is stable"),
            std::string::npos)
      << scene.error().message();
}

TEST(SceneRemarks, NoShippedSceneHasAWarning) {
  std::vector<std::string> folders = data_folders();
  const fs::path beside = fs::path(TACTUM_SOURCE_DIR) / "../shared/data";
  if (folders.empty() && fs::is_directory(beside)) folders.push_back(beside.string());
  for (const SceneEntry& entry : testing::sampled(list_scenes(), 4)) {
    Result<SceneDescription> description = describe_scene(entry.name);
    ASSERT_TRUE(description) << entry.name;
    description->source.folders = folders;
    if (!missing_files(*description).empty()) continue;
    const Result<Scene> scene = build_scene(*description);
    ASSERT_TRUE(scene) << scene.error().message();
    const std::vector<SceneRemark> remarks = remarks_on(*description, *scene);
    EXPECT_EQ(texts(remarks, true), "") << entry.name;
    EXPECT_FALSE(texts(remarks, false).empty()) << entry.name;
  }
}

TEST(MissingFiles, AreNamed) {
  const Result<SceneDescription> scene = parse_description(
      "schema = 1\n[[body]]\nname = \"a\"\npart = { mesh = \"no/such.stl\" }\n", "test", "test.toml", {"."});
  ASSERT_TRUE(scene);
  EXPECT_EQ(missing_files(*scene), std::vector<std::string>{"no/such.stl"});
}

}  // namespace
}  // namespace tactum::scene_remarks_test
