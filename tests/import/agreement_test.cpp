/// The same files, read by MuJoCo and by us: masses, centres of mass, inertias, joints and the poses of
/// shapes.

#ifdef TACTUM_TEST_MUJOCO
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "app/program.h"
#include "import/mujoco_reading.h"
#include "import/random_robot.h"
#include "tactum/import/import_scene.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"

namespace tactum::import_test {
namespace {

const std::filesystem::path kSamples = "/usr/share/mujoco/model";

constexpr double kSame = 1e-9;  // of lengths up to some metres, masses of some kilograms, and unit axes
/// MuJoCo 2.2 ends the search for principal axes when a turn has a cosine within 1e-12 of 1, so that the axes
/// of an inertia with products, of one that it fuses and of one of several geoms are off by up to 1.4e-6.
constexpr double kSameAxes = 3e-6;
/// It keeps the corners of meshes in single precision.
constexpr double kSameMesh = 1e-6;

/// How near masses, centres and inertias are to be.
struct Nearness {
  double mass = kSame, inertia = kSame, moments = kSame;
};
/// Axes that are a little off do not change the moments, but those of what is fused with them once more.
constexpr Nearness kExact{}, kWithProducts{kSame, kSameAxes, kSame}, kFused{kSame, kSameAxes, kSameAxes},
    kOfMeshes{kSameMesh, kSameMesh, kSameMesh};

/// The imported scene, as its file reads back.
struct Imported {
  SceneDescription description;
  Scene scene;
};

Result<Imported> imported(const std::string& path) {
  const Result<ImportedScene> read = import_scene(path);
  if (!read) return read.error();
  Result<SceneDescription> description = parse_description(read->toml, "test", "test.toml", {});
  if (!description) return description.error();
  Result<Scene> scene = build_scene(*description);
  if (!scene) return scene.error();
  return Imported{std::move(*description), std::move(*scene)};
}

void expect_same_joint(const Joint& ours, const Joint& theirs) {
  ASSERT_EQ(ours.kind, theirs.kind);
  if (ours.kind == JointKind::kFree) return;
  if (ours.kind != JointKind::kSlider) {
    EXPECT_LT((ours.anchor_W - theirs.anchor_W).norm(), kSame);
  }
  if (ours.kind != JointKind::kBall) {
    EXPECT_LT((ours.axis_W - theirs.axis_W).norm(), kSame);
  }
  EXPECT_NEAR(ours.damping, theirs.damping, kSame);
  EXPECT_NEAR(ours.friction, theirs.friction, kSame);
  EXPECT_NEAR(ours.stiffness, theirs.stiffness, kSame);
  if (ours.stiffness > 0.0) {
    EXPECT_NEAR(ours.rest, theirs.rest, kSame);
  }
  EXPECT_EQ(ours.limited(), theirs.limited());
  if (!theirs.limited()) return;
  EXPECT_NEAR(ours.upper, theirs.upper, kSame);
  if (ours.kind != JointKind::kBall) {
    EXPECT_NEAR(ours.lower, theirs.lower, kSame);
  }
}

Vec3 moments(const Mat3& inertia) { return Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvalues(); }

bool is_at(const Body& ours, const ReadBody& theirs, const Nearness& near) {
  return ours.moves() && (ours.X_WB.p - theirs.center_W).norm() < near.mass &&
         std::abs(ours.mass_kg - theirs.mass_kg) < near.mass * (1.0 + theirs.mass_kg);
}

void expect_same_body(const World& world, const ReadBody& theirs, const Nearness& near) {
  SCOPED_TRACE(theirs.name);
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& ours = world.bodies[i];
    // One without a name is found by its place; it has a name of ours here.
    if (ours.name != theirs.name && !(theirs.name.empty() && is_at(ours, theirs, near))) continue;
    EXPECT_NEAR(ours.mass_kg, theirs.mass_kg, near.mass * (1.0 + theirs.mass_kg));
    EXPECT_LT((ours.X_WB.p - theirs.center_W).norm(), near.mass);
    const Mat3 inertia_W = ours.X_WB.R * ours.inertia_B * ours.X_WB.R.transpose();
    const double size = theirs.inertia_W.norm();
    EXPECT_LT((inertia_W - theirs.inertia_W).norm(), near.inertia * size) << inertia_W;
    if (theirs.alone) {
      EXPECT_LT((moments(inertia_W) - moments(theirs.inertia_W)).norm(), near.moments * size);
    }
    expect_same_joint(world.joint_of(static_cast<int>(i)), theirs.joint);
    return;
  }
  ADD_FAILURE() << "no such body";
}

/// Where the scene's shapes are in the world; of meshes nothing, since MuJoCo has frames of its own for them.
std::vector<Pose> poses_of_shapes(const Imported& imported, std::size_t& meshes) {
  std::vector<Pose> poses;
  const auto add = [&](const PartDescription& part, const Pose& X) {
    if (std::holds_alternative<MeshPart>(part))
      ++meshes;
    else
      poses.push_back(X);
  };
  for (const BodyDescription& body : imported.description.bodies) {
    if (body.part) add(*body.part, body.X_OP);
    for (const ComponentDescription& component : body.components)
      add(*component.part, body.X_OP * component.X_OC);
  }
  return poses;
}

void expect_same_shapes(const Imported& imported, const Reading& theirs) {
  std::size_t meshes = 0, their_meshes = 0;
  const std::vector<Pose> ours = poses_of_shapes(imported, meshes);
  for (const ReadGeom& geom : theirs.geoms) {
    their_meshes += geom.mesh ? 1 : 0;
    if (geom.mesh) continue;
    const auto same = [&](const Pose& X) {
      return (X.p - geom.X_WG.p).norm() < kSame && (X.R - geom.X_WG.R).norm() < kSame;
    };
    // A plane is the upper side of a plate, whose middle is under it.
    const auto under = [&](const Pose& X) {
      const Vec3 off = geom.X_WG.R.transpose() * (X.p - geom.X_WG.p);
      return off.head<2>().norm() < kSame && off.z() < 0.0 && (X.R - geom.X_WG.R).norm() < kSame;
    };
    EXPECT_TRUE(std::any_of(ours.begin(), ours.end(), same) || std::any_of(ours.begin(), ours.end(), under))
        << geom.X_WG.p.transpose();
  }
  EXPECT_EQ(meshes, their_meshes);
  EXPECT_EQ(ours.size() + meshes, theirs.geoms.size());
}

void expect_agreement(const std::string& path, const Nearness& near) {
  SCOPED_TRACE(path);
  const Reading theirs = read_by_mujoco(path);
  ASSERT_EQ(theirs.error, "");
  const Result<Imported> ours = imported(path);
  ASSERT_TRUE(ours) << ours.error().message();
  std::size_t moving = 0;
  for (const Body& body : ours->scene.world.bodies) moving += body.moves() ? 1 : 0;
  EXPECT_EQ(moving, theirs.bodies.size());
  for (const ReadBody& body : theirs.bodies) expect_same_body(ours->scene.world, body, near);
  expect_same_shapes(*ours, theirs);
  EXPECT_EQ(ours->scene.world.gravity_W, theirs.gravity_W);
}

TEST(ImportAgrees, FilesOfEveryConstruct) {
  struct File {
    const char* name;
    Nearness near;
  };
  for (const File& file :
       {File{"primitives.xml", kWithProducts}, File{"orientations.xml", kExact}, File{"defaults.xml", kExact},
        File{"joints.xml", kExact}, File{"meshes.xml", kOfMeshes}, File{"masses.xml", kWithProducts},
        File{"include.xml", kExact}, File{"arm.urdf", kWithProducts}, File{"shapes.urdf", kWithProducts},
        File{"tree.urdf", kExact}})
    expect_agreement(fmt::format("{}/tests/import/files/{}", TACTUM_SOURCE_DIR, file.name), file.near);
}

/// The models that come with MuJoCo's own programs (libmujoco-samples of Debian): humanoids, an arm, a
/// slider-crank, and a hundred things that fall. Composites are left out here, so that their
/// files are not compared. Of a body with several joints the first is compared, which is the one that it has
/// here.
TEST(ImportAgrees, ModelsThatOthersHaveMade) {
  struct File {
    const char* name;
    Nearness near;
  };
  if (!std::filesystem::is_directory(kSamples)) GTEST_SKIP() << "libmujoco-samples is not installed";
  for (const File& file :
       {File{"humanoid/humanoid.xml", kWithProducts}, File{"humanoid/22_humanoids.xml", kWithProducts},
        File{"hammock/humanoid_body.xml", kWithProducts},
        File{"humanoid100/humanoid_body.xml", kWithProducts}, File{"tendon_arm/arm26.xml", kWithProducts},
        File{"slider_crank/slider_crank.xml", kWithProducts},
        File{"humanoid100/humanoid100.xml", kWithProducts}})
    expect_agreement(kSamples / file.name, file.near);
}

/// The volume inside the triangles of an OBJ file whose faces are triangles, "f v/t/n v/t/n v/t/n".
double volume_of_obj(const std::filesystem::path& path) {
  std::vector<Vec3> corners;
  double volume = 0.0;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind, rest;
    words >> kind;
    if (kind == "v") {
      Vec3& corner = corners.emplace_back();
      words >> corner.x() >> corner.y() >> corner.z();
    } else if (kind == "f") {
      std::array<std::size_t, 3> face{};
      for (std::size_t& index : face) {
        words >> index;
        words >> rest;
      }
      volume += corners.at(face[0] - 1).dot(corners.at(face[1] - 1).cross(corners.at(face[2] - 1))) / 6.0;
    }
  }
  return volume;
}

/// A mug: a mesh that is seen and weighs, and boxes that are felt. MuJoCo 2.2 sums the tetrahedra of a mesh
/// without their signs, which is another mass than that of this one; without the mesh's mass all else agrees.
TEST(ImportAgrees, AMugWhoseMeshIsSeenOnly) {
  if (!std::filesystem::is_directory(kSamples)) GTEST_SKIP() << "libmujoco-samples is not installed";
  const testing::ScratchFolder folder;
  const std::filesystem::path mug = kSamples / "mug";
  for (const char* name : {"mug.obj", "mug.png"}) std::filesystem::copy(mug / name, folder / name);
  std::ifstream file(mug / "mug.xml");
  std::string model((std::istreambuf_iterator<char>(file)), {});
  const std::string seen_only = R"(contype="0")";
  ASSERT_NE(model.find(seen_only), std::string::npos);
  model.insert(model.find(seen_only), R"(mass="0" )");
  testing::write(folder / "mug.xml", model);
  expect_agreement(folder / "mug.xml", kWithProducts);

  const auto mass_of = [](const std::string& path) {
    const Result<Imported> read = imported(path);
    return read ? read->scene.world.bodies.at(read->scene.world.bodies.size() - 1).mass_kg : 0.0;
  };
  const double volume_m3 = 1e-6 * volume_of_obj(mug / "mug.obj");  // the model scales it by 0.01
  EXPECT_GT(volume_m3, 0.0);
  EXPECT_NEAR(mass_of(mug / "mug.xml") - mass_of(folder / "mug.xml"), 1000.0 * volume_m3, 1e-9);
}

/// Odd seeds have no inertia whose axes are to be found, so that the referee is exact as well.
void expect_agreement_of_random_robots(const char* name, std::string (*make)(std::uint64_t),
                                       const Nearness& even) {
  const testing::ScratchFolder folder;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    testing::write(folder / name, make(seed));
    expect_agreement(folder / name, seed % 2 == 1 ? kExact : even);
    if (::testing::Test::HasFailure()) {
      FAIL() << "seed " << seed << "\n" << make(seed);
    }
  }
}

TEST(ImportAgrees, RandomMjcf) {
  expect_agreement_of_random_robots("random.xml", random_mjcf, kWithProducts);
}
TEST(ImportAgrees, RandomUrdf) { expect_agreement_of_random_robots("random.urdf", random_urdf, kFused); }

}  // namespace
}  // namespace tactum::import_test
#endif
