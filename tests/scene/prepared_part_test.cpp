#include <gtest/gtest.h>

#include "app/program.h"
#include "support/sample_meshes.h"
#include "tactum/mesh/prepare_part.h"
#include "tactum/scene/scene_file.h"

namespace tactum::prepared_part_test {
namespace {

using testing::ScratchFolder;

std::string scene_with(const std::string& part) {
  return "schema = 1\n[[body]]\nname = \"ball\"\npart = " + part +
         "\npos_m = [0.1, 0.2, 0.3]\nrpy_deg = [0, 0, 90]\ndensity_kg_per_m3 = 2700\n[tool]\nbody = "
         "\"ball\"\n";
}

/// A dented ball of five centimetres whose centre of mass is not its origin, as OBJ and as part.
struct Files {
  ScratchFolder folder;
  Files() {
    TriangleMesh mesh = testing::icosphere(2);
    mesh.vertices[40] *= 0.7;
    std::string obj;
    for (const Vec3& v : mesh.vertices)
      obj += "v " + std::to_string(50 * v.x() + 7) + " " + std::to_string(50 * v.y()) + " " +
             std::to_string(50 * v.z()) + "\n";
    for (const Triangle& t : mesh.triangles)
      obj += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
             std::to_string(t[2] + 1) + "\n";
    testing::write(folder / "ball.obj", obj);
    const Result<PartFile> part =
        prepare_part(*import_mesh(folder / "ball.obj"), {.name = "ball", .unit = "mm"});
    EXPECT_TRUE(save_part(folder / "ball.tactum", *part));
  }
  Result<Scene> scene(const std::string& part) const {
    return parse_scene(scene_with(part), "test", "test.toml", {folder / ""});
  }
};

TEST(PreparedPart, LoadsAsTheMeshItWasMadeOf) {
  const Files files;
  const Result<Scene> from_mesh = files.scene(R"({ mesh = "ball.obj", scale = 0.001 })");
  const Result<Scene> from_part = files.scene(R"({ mesh = "ball.tactum" })");
  ASSERT_TRUE(from_mesh) << from_mesh.error().message();
  ASSERT_TRUE(from_part) << from_part.error().message();
  const Body& mesh = from_mesh->world.bodies[0];
  const Body& part = from_part->world.bodies[0];
  EXPECT_NEAR(part.mass_kg, mesh.mass_kg, 1e-12 * mesh.mass_kg);
  EXPECT_LT((part.inertia_B - mesh.inertia_B).norm(), 1e-12 * mesh.inertia_B.norm());
  EXPECT_LT((part.X_WB.p - mesh.X_WB.p).norm(), 1e-15);
  EXPECT_LT((p_BP_of(part) - p_BP_of(mesh)).norm(), 1e-15);
  ASSERT_EQ(part.part->surface.vertices.size(), mesh.part->surface.vertices.size());
  for (std::size_t v = 0; v < part.part->surface.vertices.size(); ++v)
    EXPECT_LT((part.part->surface.vertices[v] - mesh.part->surface.vertices[v]).norm(), 1e-15);
  EXPECT_EQ(part.part->pieces.size(), mesh.part->pieces.size());
}

TEST(PreparedPart, KeysForMeshesAndDamagedFilesAreErrorsWithTheirPlace) {
  const Files files;
  const Result<Scene> scaled = files.scene(R"({ mesh = "ball.tactum", scale = 0.001 })");
  ASSERT_FALSE(scaled);
  EXPECT_NE(scaled.error().message().find("\"scale\" is for meshes only: found a prepared part"),
            std::string::npos)
      << scaled.error().message();
  std::string bytes = testing::content(files.folder / "ball.tactum");
  bytes.pop_back();
  testing::write(files.folder / "ball.tactum", bytes);
  const Result<Scene> cut = files.scene(R"({ mesh = "ball.tactum" })");
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().message().find("it was cut short or grew"), std::string::npos)
      << cut.error().message();
}

}  // namespace
}  // namespace tactum::prepared_part_test
