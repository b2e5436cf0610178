/// tactum import, and URDF and MJCF in tactum feel.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/program.h"
#include "tactum/scene/scene_file.h"

namespace tactum::import_command_test {
namespace {

using testing::ProgramRun;
using testing::run_tactum;

const std::string kFiles = std::string(TACTUM_SOURCE_DIR) + "/tests/import/files/";

TEST(ImportCommand, WritesASceneThatReadsBackAndNamesItsMeshesFromThere) {
  const testing::ScratchFolder folder;
  const std::string scene = folder / "shapes.toml";
  const ProgramRun run =
      run_tactum("import " + kFiles + "shapes.urdf -o " + scene + " --json " + (folder / "n.json"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("The hand holds \"thing\", the first body that is free."), std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("2 bodies, of which 0 on joints, 1 free and 1 fixed"), std::string::npos) << run.out;
  const Result<Scene> read = read_scene_file(scene);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->world.bodies[1].mass_kg, 0.4);
  const nlohmann::json notes = nlohmann::json::parse(testing::content(folder / "n.json"));
  EXPECT_EQ(notes["bodies"], 2);
  EXPECT_EQ(notes["notes"].size(), 0u);
}

TEST(ImportCommand, TellsWhatIsLostAndRefusesWhatIsWrong) {
  const testing::ScratchFolder folder;
  const ProgramRun arm = run_tactum("import " + kFiles + "arm.urdf -o " + (folder / "arm.toml"));
  EXPECT_EQ(arm.exit_code, 0) << arm.err;
  EXPECT_NE(arm.err.find("arm.urdf:17: \"effort\" of <limit> is not honoured"), std::string::npos) << arm.err;
  testing::write(folder / "bad.urdf", "<robot>\n<link/></robot>");
  const ProgramRun bad = run_tactum("import " + (folder / "bad.urdf") + " -o " + (folder / "bad.toml"));
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.err.find("bad.urdf:2: a <link> without a name"), std::string::npos) << bad.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "bad.toml"));
  EXPECT_EQ(run_tactum("import " + kFiles + "arm.urdf -o " + (folder / "arm.yaml")).exit_code, 2);
}

TEST(FeelCommand, FeelsUrdfAndMjcfAsTheyAre) {
  const ProgramRun arm =
      run_tactum("feel " + kFiles + "arm.urdf --tool lower --virtual-clock --updates 20 --json -");
  ASSERT_EQ(arm.exit_code, 0) << arm.err;
  EXPECT_NE(arm.err.find("The hand holds \"lower\", as asked for."), std::string::npos) << arm.err;
  EXPECT_EQ(nlohmann::json::parse(arm.out)["penetrating_frames"], 0);
  const ProgramRun scene =
      run_tactum("feel " + kFiles + "primitives.xml --virtual-clock --updates 20 --referee --json -");
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  EXPECT_EQ(nlohmann::json::parse(scene.out)["penetrating_frames"], 0);
  const ProgramRun wrong = run_tactum("feel gears --tool driver --virtual-clock --updates 1");
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.err.find("--tool is for URDF and MJCF files"), std::string::npos) << wrong.err;
}

}  // namespace
}  // namespace tactum::import_command_test
