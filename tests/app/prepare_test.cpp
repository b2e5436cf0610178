#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "app/program.h"
#include "mesh/gltf_sample.h"

namespace tactum::prepare_test {
namespace {

using testing::ProgramRun;
using testing::run_tactum;
using testing::ScratchFolder;
using Json = nlohmann::json;

const char* const kCube =
    "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 10\nv 10 0 10\nv 10 10 10\nv 0 10 10\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 1 5 8 4\n";

/// A folder with the cube and a cache of its own.
struct Workshop {
  ScratchFolder folder;
  std::string cube = folder / "cube.obj";
  std::string part = folder / "cube.tactum";
  Workshop() { testing::write(cube, kCube); }
  ProgramRun prepare(const std::string& more = "") const {
    return run_tactum("prepare " + cube + " -o " + part + " --cache " + (folder / "cache") + " " + more);
  }
};

TEST(PrepareCommand, WritesAPartAndTellsWhatItIs) {
  const Workshop shop;
  const ProgramRun run = shop.prepare();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("millimetres"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("verified"), std::string::npos);
  EXPECT_EQ(run.out.find("prepared before"), std::string::npos);
  EXPECT_EQ(run.err, "");  // the bar is for terminals
  const ProgramRun inspected = run_tactum("inspect --json - " + shop.part);
  ASSERT_EQ(inspected.exit_code, 0) << inspected.err;
  const Json json = Json::parse(inspected.out);
  EXPECT_NEAR(json[0]["report"]["mass"]["volume_m3"].get<double>(), 1e-6, 1e-15);
  EXPECT_EQ(json[0]["report"]["mesh"]["convex_edges"], 12);
  EXPECT_EQ(json[0]["report"]["mesh"]["reflex_edges"], 0);
}

TEST(PrepareCommand, ASecondTimeComesFromTheCacheUnlessSomethingChanged) {
  const Workshop shop;
  ASSERT_EQ(shop.prepare().exit_code, 0);
  const std::string first = testing::content(shop.part);
  const ProgramRun again = shop.prepare();
  EXPECT_NE(again.out.find("prepared before"), std::string::npos);
  EXPECT_EQ(testing::content(shop.part), first);
  EXPECT_EQ(shop.prepare("--no-cache").out.find("prepared before"), std::string::npos);
  EXPECT_EQ(testing::content(shop.part), first);
  EXPECT_EQ(shop.prepare("--units mm").out.find("prepared before"), std::string::npos);
  testing::write(shop.cube, std::string(kCube) + "# another byte\n");
  EXPECT_EQ(shop.prepare().out.find("prepared before"), std::string::npos);
}

/// A cube of 1.6 file units has a diagonal of 2.8: too large for a part in metres, small in millimetres.
TEST(PrepareCommand, AUnitThatIsNotCertainIsToldFirst) {
  const Workshop shop;
  std::string small = kCube;
  for (std::size_t at = small.find("10"); at != std::string::npos; at = small.find("10", at))
    small.replace(at, 2, "1.6");
  testing::write(shop.cube, small);
  for (int i = 0; i < 2; ++i) {  // computed, and from the cache
    const ProgramRun run = shop.prepare();
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const std::string first = run.out.substr(0, run.out.find('\n'));
    EXPECT_NE(first.find("inches"), std::string::npos) << run.out;
    EXPECT_NE(first.find("tactum prepare " + shop.cube + " -o " + shop.part + " --units mm"),
              std::string::npos)
        << run.out;
  }
  const ProgramRun json = shop.prepare("--json -");
  EXPECT_EQ(Json::parse(json.out)["report"]["unit"]["certain"], false);
  EXPECT_NE(json.err.find("--units mm"), std::string::npos) << json.err;
  const ProgramRun asked = shop.prepare("--units mm");
  EXPECT_EQ(asked.out.find("GUESS"), std::string::npos) << asked.out;
}

TEST(PrepareCommand, AScaleIsMetresPerUnit) {
  const Workshop shop;
  ASSERT_EQ(shop.prepare().exit_code, 0);
  const ProgramRun run =
      shop.prepare("--scale 0.0254 --json -");  // not the part of the same mesh in millimetres
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_NEAR(json["report"]["mass"]["volume_m3"].get<double>(), std::pow(0.254, 3), 1e-12);
  EXPECT_EQ(json["report"]["unit"]["metres_per_unit"], 0.0254);
  EXPECT_EQ(shop.prepare("--scale 0.0254 --units mm").exit_code, 2);
  for (const char* wrong : {"0", "-1", "many"})
    EXPECT_EQ(shop.prepare(std::string("--scale ") + wrong).exit_code, 2);
}

TEST(PrepareCommand, GltfIsInMetresUnlessAnotherUnitIsAskedFor) {
  const Workshop shop;
  const std::string gltf = shop.folder / "cube.gltf";  // a unit cube, made 3 m wide by its node
  testing::write(gltf, testing::gltf_cube(R"("scale":[3,3,3])"));
  const std::string command = "prepare " + gltf + " --no-cache -o " + shop.part;
  const ProgramRun metres = run_tactum(command);
  ASSERT_EQ(metres.exit_code, 0) << metres.err;
  EXPECT_NE(metres.out.find("metres: glTF is in metres by its standard."), std::string::npos) << metres.out;
  EXPECT_NE(metres.out.find("volume 27 m^3"), std::string::npos) << metres.out;
  const ProgramRun inspected = run_tactum("inspect " + gltf);
  EXPECT_NE(inspected.out.find("unit: metres: glTF is in metres by its standard."), std::string::npos)
      << inspected.out;
  EXPECT_NE(run_tactum(command + " --units cm").out.find("volume 2.7e-05 m^3"), std::string::npos);
  const std::string mixed = "prepare " + gltf + " " + shop.cube + " --no-cache -o " + shop.part;
  EXPECT_NE(run_tactum(mixed).err.find("different units"), std::string::npos);
}

TEST(InspectCommand, SaysHowLargeTheMeshIsInItsLikelyUnit) {
  const Workshop shop;
  const std::string guessed = run_tactum("inspect " + shop.cube).out;
  EXPECT_NE(
      guessed.find("in millimetres it is 0.01 x 0.01 x 0.01 m large, its volume 1e-06 m^3 (--scale 0.001)"),
      std::string::npos)
      << guessed;
  const std::string in_millimetres = run_tactum("inspect --scale 0.001 " + shop.cube).out;
  EXPECT_EQ(in_millimetres.find("The lines above take"), std::string::npos) << in_millimetres;
  const std::string in_inches = run_tactum("inspect --scale 0.0254 " + shop.cube).out;
  EXPECT_NE(in_inches.find("as units of 0.0254 m; in millimetres it is 0.01 x"), std::string::npos)
      << in_inches;
}

TEST(PrepareCommand, RefusesInOneLineOnStderr) {
  const ScratchFolder folder;
  std::string stl(1000, '\0');
  const std::uint32_t ten_million = 10'000'000;
  std::memcpy(stl.data() + 80, &ten_million, sizeof ten_million);
  testing::write(folder / "huge.stl", stl);
  const ProgramRun run =
      run_tactum("prepare " + (folder / "huge.stl") + " -o " + (folder / "huge.tactum") + " --no-cache");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("huge.stl"), std::string::npos) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "huge.tactum"));
}

TEST(PrepareCommand, SeveralMeshesArePiecesOfOnePart) {
  const Workshop shop;
  std::string beside = kCube;
  for (std::size_t at = beside.find("v 0"); at != std::string::npos; at = beside.find("v 0", at + 1))
    beside.replace(at, 3, "v 20");  // mirrored about the wall x = 10; hulls do not mind
  testing::write(shop.folder / "beside.obj", beside);
  const ProgramRun run = run_tactum("prepare " + shop.cube + " " + (shop.folder / "beside.obj") +
                                    " --no-cache --json - -o " + shop.part);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["report"]["pieces"]["way"], "given");
  EXPECT_EQ(json["report"]["pieces"]["count"], 2);
}

TEST(PrepareCommand, ClearanceAndDistanceTakePreparedParts) {
  const Workshop shop;
  ASSERT_EQ(shop.prepare().exit_code, 0);
  testing::write(shop.folder / "motion.csv",
                 "frame,time_s,a_px,a_py,a_pz,a_m00,a_m01,a_m02,a_m10,a_m11,a_m12,a_m20,a_m21,a_m22,"
                 "b_px,b_py,b_pz,b_m00,b_m01,b_m02,b_m10,b_m11,b_m12,b_m20,b_m21,b_m22\n"
                 "0,0,0,0,0,1,0,0,0,1,0,0,0,1,0.0125,0,0,1,0,0,0,1,0,0,0,1\n");
  const ProgramRun clearance =
      run_tactum("clearance " + shop.part + " " + shop.part + " " + (shop.folder / "motion.csv"));
  ASSERT_EQ(clearance.exit_code, 0) << clearance.err;
  EXPECT_NE(clearance.out.find("\n0,0,0.0025"), std::string::npos) << clearance.out;

  const Json side = {{"part", "cube.tactum"}};
  Json moved = side;
  moved["pose"] = {1, 0, 0, 0.0125, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  testing::write(shop.folder / "cases.json", Json({{"cases", {{{"a", side}, {"b", moved}}}}}).dump());
  const ProgramRun distance = run_tactum("distance " + (shop.folder / "cases.json"));
  ASSERT_EQ(distance.exit_code, 0) << distance.err;
  const Json answer = Json::parse(distance.out)["results"][0];
  EXPECT_NEAR(answer["signed_distance"].get<double>(), 0.0025, 1e-12);
  EXPECT_NEAR(answer["p_a"][0].get<double>(), 0.01, 1e-12);  // in the frame of the mesh, as for vertices
}

TEST(PrepareCommand, ADamagedPartIsRefusedWithItsReason) {
  const Workshop shop;
  ASSERT_EQ(shop.prepare().exit_code, 0);
  std::string bytes = testing::content(shop.part);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] + 1);
  testing::write(shop.part, bytes);
  const ProgramRun run = run_tactum("inspect " + shop.part);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("bytes were changed"), std::string::npos) << run.err;
}

/// A copy of the program stands where no other program is.
TEST(PrepareCommand, StepWithoutItsProgramSaysHowToGetIt) {
  const testing::ScratchFolder folder;
  const std::filesystem::path programs =
      std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
  std::filesystem::copy_file(programs / "tactum", folder / "tactum");
  testing::write(folder / "part.step", "ISO-10303-21;");
  const std::string command =
      "cd " + (folder / "") + " && PATH= ./tactum prepare part.step -o part.tactum 2>err";
  EXPECT_NE(std::system(command.c_str()), 0);
  const std::string said = testing::content(folder / "err");
  EXPECT_NE(said.find("STEP files need the program tactum-step"), std::string::npos) << said;
  EXPECT_NE(said.find("libocct-data-exchange-dev"), std::string::npos) << said;
}

}  // namespace
}  // namespace tactum::prepare_test
