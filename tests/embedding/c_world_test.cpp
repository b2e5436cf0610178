/// Worlds and several hands in the C interface: to the bit what the library gives a program in C++, and its
/// sentences.
#include <gtest/gtest.h>

#include <cstddef>
#include <thread>

#include "support/allocation_guard.h"
#include "support/effort.h"
#include "tactum/drivers/registry.h"
#include "tactum/embedding/part_query.h"
#include "tactum/embedding/tactum_c.h"
#include "tactum/haptics/materials.h"
#include "tactum/haptics/simulation.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum::c_world_test {

using tactum::testing::kSanitized;

namespace {

constexpr int kFrames = kSanitized ? 200 : 800;

const std::vector<Vec3>& corners() {
  static const std::vector<Vec3> all = [] {
    std::vector<Vec3> made;
    for (int i = 0; i < 8; ++i)
      made.emplace_back((i & 1) != 0 ? 0.01 : -0.01, (i & 2) != 0 ? 0.01 : -0.01,
                        (i & 4) != 0 ? 0.01 : -0.01);
    return made;
  }();
  return all;
}
constexpr std::int32_t kTriangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                            {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

tactum_pose at(double x, double y, double z) { return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, y, z}}; }

/// A cube, a world, and a scene of it, in C.
struct InC {
  InC(const double* gravity_W = nullptr) {
    EXPECT_EQ(tactum_make_part(corners().front().data(), 8, kTriangles[0], 12, nullptr, &cube), TACTUM_OK)
        << tactum_last_error();
    EXPECT_EQ(tactum_make_world(gravity_W, &world), TACTUM_OK);
  }
  ~InC() {
    tactum_close_scene(scene);
    tactum_release_world(world);
    tactum_release_part(cube);
  }
  InC(const InC&) = delete;
  InC& operator=(const InC&) = delete;

  tactum_status add(const char* name, const tactum_pose& X_WP, tactum_body_options options = {}) {
    options.struct_size = sizeof options;
    options.name = name;
    return tactum_add_body(world, cube, &X_WP, &options, nullptr);
  }
  tactum_status open(const char* body, double rate_Hz = 0.0) {
    tactum_tool tool{};
    tool.struct_size = sizeof tool;
    tool.body = body;
    return tactum_open_world(world, sizeof tool, &tool, body == nullptr ? 0 : 1, rate_Hz, &scene);
  }

  tactum_part* cube = nullptr;
  tactum_world* world = nullptr;
  tactum_simulation* scene = nullptr;
};

/// The same world by World::add and what follows it.
struct InCpp {
  InCpp() {
    TriangleMesh mesh;
    mesh.vertices = corners();
    for (const auto& triangle : kTriangles) mesh.triangles.push_back({triangle[0], triangle[1], triangle[2]});
    const auto queried = QueriedPart::from_mesh(std::move(mesh));
    Part part = (*queried)->file().part;
    part.origin = (*queried)->file().origin;
    cube = std::make_shared<const Part>(std::move(part));
  }
  std::unique_ptr<Simulation> open(int body, double rate_Hz) {
    const auto device = make_device("premium-1.5-6dof", {});
    FrameSettings settings = settings_for((*device)->info(), rate_Hz);
    settings.tool.body = body;
    for (const MaterialPair& pair : friction) EXPECT_TRUE(set_coefficient(world, pair, settings.friction));
    for (const MaterialPair& pair : restitution)
      EXPECT_TRUE(set_coefficient(world, pair, settings.impacts.restitution));
    return std::move(*Simulation::make(world, settings));
  }

  std::shared_ptr<const Part> cube;
  World world;
  std::vector<MaterialPair> friction, restitution;
};

/// Steps both down by 6 mm, aside and back, and compares every wrench and every body.
void expect_same_run(tactum_simulation* in_c, Simulation& in_cpp) {
  double largest_N = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    const double s = static_cast<double>(i) / kFrames;
    const tactum_pose X_DH = at(0.002 * s * (1.0 - s), 0.0, -0.006 * s);
    tactum_frame frame{};
    frame.struct_size = sizeof frame;
    ASSERT_EQ(tactum_step_pose(in_c, &X_DH, &frame), TACTUM_OK) << tactum_last_error();
    DeviceSample sample;
    sample.valid = true;
    sample.X_DH = {Mat3::Identity(), Vec3(X_DH.p[0], X_DH.p[1], X_DH.p[2])};
    FrameTick tick;  // the times of a loop: Simulation::step() has others, in the last bit
    tick.index = static_cast<std::uint64_t>(i);
    sample.time_s = tick.now_s = static_cast<double>(i) / (1.0 / in_cpp.settings().dt_s);
    tick.period_s = in_cpp.settings().dt_s;
    const Wrench F_D = in_cpp.run(sample, tick);
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(frame.F_D.f[k], F_D.f[k]) << i;
      ASSERT_EQ(frame.F_D.t[k], F_D.t[k]) << i;
    }
    largest_N = std::max(largest_N, F_D.f.norm());
  }
  EXPECT_GT(largest_N, 0.01) << "nothing was felt";
  ASSERT_EQ(tactum_body_count(in_c), static_cast<int>(in_cpp.world().bodies.size()));
  for (int b = 0; b < tactum_body_count(in_c); ++b) {
    tactum_body body{};
    body.struct_size = sizeof body;
    ASSERT_EQ(tactum_get_body(in_c, b, &body), TACTUM_OK);
    const auto i = static_cast<std::size_t>(b);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(body.X_WB.p[k], in_cpp.bodies().X_WB[i].p[k]);
      EXPECT_EQ(body.V_WB.w[k], in_cpp.bodies().V_WB[i].w[k]);
    }
    EXPECT_EQ(body.mass_kg, in_cpp.world().bodies[i].mass_kg);
  }
}

/// A joint of the one beside the cube that is led, as both have it.
struct JointCase {
  const char* name;
  tactum_joint in_c;
  Joint in_cpp;
};

std::vector<JointCase> joint_cases() {
  tactum_joint fixed{}, hinge{}, slider{}, ball{};
  fixed.kind = TACTUM_JOINT_FIXED;
  hinge.kind = TACTUM_JOINT_HINGE;
  hinge.axis_W[1] = 2.0;  // of any length
  hinge.anchor_W[0] = 0.008;
  hinge.damping = 0.002;
  slider.kind = TACTUM_JOINT_SLIDER;  // along z, which an axis of zeros means
  slider.stiffness = 300.0;
  slider.friction = 0.2;
  slider.rest = 0.0005;
  slider.has_limits = 1;
  slider.lower = -0.002;
  slider.upper = 0.001;
  ball.kind = TACTUM_JOINT_BALL;
  ball.anchor_W[2] = -0.01;
  ball.damping = 0.01;
  return {
      {"fixed", fixed, {.kind = JointKind::kFixed}},
      {"hinge",
       hinge,
       {.kind = JointKind::kHinge, .axis_W = Vec3(0, 2, 0), .anchor_W = Vec3(0.008, 0, 0), .damping = 0.002}},
      {"slider",
       slider,
       {.kind = JointKind::kSlider,
        .friction = 0.2,
        .stiffness = 300.0,
        .rest = 0.0005,
        .lower = -0.002,
        .upper = 0.001}},
      {"ball", ball, {.kind = JointKind::kBall, .anchor_W = Vec3(0, 0, -0.01), .damping = 0.01}},
      {"free", {}, {}}};
}

TEST(CWorld, IsTheWorldOfCppToTheBitWithEveryJoint) {
  for (JointCase& one : joint_cases()) {
    SCOPED_TRACE(one.name);
    const double gravity_W[3] = {0.0, 0.0, std::string(one.name) == "free" ? 0.0 : -1.0};
    InC in_c(gravity_W);
    one.in_c.struct_size = sizeof one.in_c;
    tactum_body_options below{}, above{};
    below.joint = &one.in_c;
    below.material = "steel";
    below.density_kg_per_m3 = 7800.0;
    above.material = "wood";
    above.mass_kg = 0.02;
    ASSERT_EQ(in_c.add("below", at(0, 0, 0), below), TACTUM_OK) << tactum_last_error();
    ASSERT_EQ(in_c.add("above", at(0.003, 0, 0.021), above), TACTUM_OK) << tactum_last_error();
    ASSERT_EQ(tactum_set_friction(in_c.world, "wood", "steel", 0.3), TACTUM_OK);
    ASSERT_EQ(tactum_set_restitution(in_c.world, "steel", "wood", 0.5), TACTUM_OK);
    ASSERT_EQ(in_c.open("above", 2000.0), TACTUM_OK) << tactum_last_error();

    InCpp in_cpp;
    in_cpp.world.gravity_W = Vec3(0, 0, gravity_W[2]);
    ASSERT_TRUE(in_cpp.world.add({.name = "below",
                                  .part = in_cpp.cube,
                                  .density_kg_per_m3 = 7800.0,
                                  .joint = one.in_cpp,
                                  .material = "steel"}));
    ASSERT_TRUE(in_cpp.world.add({.name = "above",
                                  .part = in_cpp.cube,
                                  .mass_kg = 0.02,
                                  .X_WP = {Mat3::Identity(), Vec3(0.003, 0, 0.021)},
                                  .material = "wood"}));
    in_cpp.friction = {{"wood", "steel", 0.3}};
    in_cpp.restitution = {{"steel", "wood", 0.5}};
    expect_same_run(in_c.scene, *in_cpp.open(1, 2000.0));
  }
}

TEST(CWorld, JoinsBodiesToEachOtherAsCppDoes) {
  for (const int contact : {0, 1}) {
    InC in_c;
    tactum_body_options base{}, moving{};
    tactum_joint fixed{}, hinge{};
    fixed.struct_size = hinge.struct_size = sizeof fixed;
    fixed.kind = TACTUM_JOINT_FIXED;
    hinge.kind = TACTUM_JOINT_HINGE;
    hinge.axis_W[0] = 1.0;
    hinge.anchor_W[1] = 0.02;
    base.joint = &fixed;
    moving.V_WB.w[2] = 0.1;
    ASSERT_EQ(in_c.add("base", at(0, 0, -0.024), base), TACTUM_OK);
    ASSERT_EQ(in_c.add("arm", at(0, 0, 0)), TACTUM_OK);
    ASSERT_EQ(in_c.add("lid", at(0, 0.03, 0), moving), TACTUM_OK);
    ASSERT_EQ(tactum_join_bodies(in_c.world, "lid", "arm", &hinge, contact), TACTUM_OK)
        << tactum_last_error();
    ASSERT_EQ(in_c.open("arm"), TACTUM_OK) << tactum_last_error();
    EXPECT_EQ(tactum_frame_step(in_c.scene), 0.001);

    InCpp in_cpp;
    const auto add = [&](const char* name, const Vec3& p, const Vec3& w, JointKind kind) {
      ASSERT_TRUE(in_cpp.world.add({.name = name,
                                    .part = in_cpp.cube,
                                    .X_WP = {Mat3::Identity(), p},
                                    .V_WB = {Vec3::Zero(), w},
                                    .joint = {.kind = kind}}));
    };
    add("base", Vec3(0, 0, -0.024), Vec3::Zero(), JointKind::kFixed);
    add("arm", Vec3::Zero(), Vec3::Zero(), JointKind::kFree);
    add("lid", Vec3(0, 0.03, 0), Vec3(0, 0, 0.1), JointKind::kFree);
    ASSERT_TRUE(in_cpp.world.join(
        2, 1, {.kind = JointKind::kHinge, .axis_W = Vec3::UnitX(), .anchor_W = Vec3(0, 0.02, 0)},
        contact != 0));
    const auto simulation = in_cpp.open(1, 1000.0);
    expect_same_run(in_c.scene, *simulation);
  }
}

TEST(CWorld, RefusesWithTheSentencesOfTheLibrary) {
  InC in_c;
  ASSERT_EQ(in_c.add("cube", at(0, 0, 0)), TACTUM_OK);
  const auto said = [](const char* part) {
    return std::string(tactum_last_error()).find(part) != std::string::npos;
  };
  EXPECT_EQ(in_c.add("cube", at(0, 0, 1)), TACTUM_REFUSED);
  InCpp in_cpp;
  ASSERT_TRUE(in_cpp.world.add({.name = "cube", .part = in_cpp.cube}));
  EXPECT_EQ(std::string(tactum_last_error()),
            in_cpp.world.add({.name = "cube", .part = in_cpp.cube}).error().message());
  tactum_body_options heavy{};
  heavy.mass_kg = -1.0;
  EXPECT_EQ(in_c.add("heavy", at(0, 0, 1), heavy), TACTUM_REFUSED);
  EXPECT_TRUE(said("heavy")) << tactum_last_error();
  const tactum_pose none{};
  EXPECT_EQ(in_c.add("nowhere", none), TACTUM_REFUSED);
  EXPECT_TRUE(said("X_WP")) << tactum_last_error();
  tactum_joint screw{};
  screw.struct_size = sizeof screw;
  screw.kind = 7;
  EXPECT_EQ(tactum_join_bodies(in_c.world, "cube", "lid", &screw, 0), TACTUM_BAD_CALL);
  screw.kind = TACTUM_JOINT_BALL;
  EXPECT_EQ(tactum_join_bodies(in_c.world, "cube", "lid", &screw, 0), TACTUM_REFUSED);
  EXPECT_TRUE(said("there is no such body: found lid")) << tactum_last_error();
  EXPECT_EQ(in_c.open("lid"), TACTUM_REFUSED);
  EXPECT_TRUE(said("there is no such body: found lid")) << tactum_last_error();
  EXPECT_EQ(in_c.open("cube", -3.0), TACTUM_REFUSED);
  EXPECT_EQ(in_c.scene, nullptr);
  ASSERT_EQ(tactum_set_friction(in_c.world, "ice", "steel", 0.1), TACTUM_OK);
  EXPECT_EQ(in_c.open("cube"), TACTUM_REFUSED);
  EXPECT_TRUE(said("ice")) << tactum_last_error();
  EXPECT_EQ(tactum_make_world(nullptr, nullptr), TACTUM_BAD_CALL);
  EXPECT_EQ(
      tactum_open_world(in_c.world, 4, reinterpret_cast<const tactum_tool*>(&screw), 1, 0.0, &in_c.scene),
      TACTUM_BAD_CALL);
}

/// The world may go while its scenes stay, and so may the part.
TEST(CWorld, AWorldMakesAnyNumberOfScenes) {
  tactum_simulation* scenes[2] = {};
  {
    InC in_c;
    ASSERT_EQ(in_c.add("cube", at(0, 0, 0)), TACTUM_OK);
    for (tactum_simulation*& scene : scenes) {
      ASSERT_EQ(in_c.open("cube"), TACTUM_OK);
      std::swap(scene, in_c.scene);
      ASSERT_EQ(in_c.add(nullptr, at(0, 0, 0.1 * tactum_body_count(scene))), TACTUM_OK);
    }
  }
  EXPECT_EQ(tactum_body_count(scenes[0]), 1);
  EXPECT_EQ(tactum_body_count(scenes[1]), 2);
  for (tactum_simulation* scene : scenes) {
    const tactum_pose X_DH = at(0, 0, 0);
    EXPECT_EQ(tactum_step_pose(scene, &X_DH, nullptr), TACTUM_OK);
    tactum_close_scene(scene);
  }
}

std::uint64_t led_by_its_hands(tactum_simulation* scene, int frames) {
  EXPECT_EQ(tactum_open_hand(scene), TACTUM_OK);
  std::vector<tactum_sample> samples(static_cast<std::size_t>(tactum_hand_count(scene)));
  std::vector<tactum_wrench> F_D(samples.size());
  for (int i = 0; i < frames; ++i) {
    for (std::size_t h = 0; h < samples.size(); ++h) {
      samples[h].struct_size = sizeof samples[h];
      EXPECT_EQ(tactum_read_hand_of(scene, static_cast<int>(h), &samples[h]), TACTUM_OK);
    }
    EXPECT_EQ(
        tactum_step_hands(scene, sizeof samples[0], samples.data(), samples.size(), F_D.data(), nullptr),
        TACTUM_OK)
        << tactum_last_error();
    for (std::size_t h = 0; h < samples.size(); ++h)
      EXPECT_EQ(tactum_write_hand_of(scene, static_cast<int>(h), &F_D[h]), TACTUM_OK);
  }
  tactum_close_hand(scene);
  return tactum_run_hash(scene);
}

TEST(CHands, AreThoseOfASessionToTheBit) {
  const int frames = kSanitized ? 300 : 1600;
  const char* other[] = {"touch"};
  for (const bool another_device : {false, true})
    for (const char* name : {"peg-two-hands", "gears"}) {
      const bool two = std::string(name) == "peg-two-hands";
      if (another_device && !two) continue;
      tactum_scene_options options{};
      options.struct_size = sizeof options;
      SessionOptions of_session;
      if (another_device) {
        options.other_devices = other;
        options.other_device_count = 1;
        of_session.other_devices = {"touch"};
      }
      tactum_simulation* scene = nullptr;
      ASSERT_EQ(tactum_open_scene(name, &options, &scene), TACTUM_OK) << tactum_last_error();
      EXPECT_EQ(tactum_hand_count(scene), two ? 2 : 1);
      auto session = Session::open(std::move(*open_scene(name)), of_session);
      EXPECT_TRUE((*session)->run_virtual(static_cast<std::uint64_t>(frames), nullptr));
      EXPECT_EQ(led_by_its_hands(scene, frames), (*session)->record().hash()) << name;
      tactum_close_scene(scene);
    }
}

TEST(CHands, EachHasItsReportAndStepsAllocateNothing) {
  tactum_simulation* scene = nullptr;
  tactum_scene_options older{};  // as a program has it that was compiled before there were several devices
  older.struct_size = offsetof(tactum_scene_options, other_devices);
  ASSERT_EQ(tactum_open_scene("peg-two-hands", &older, &scene), TACTUM_OK) << tactum_last_error();
  const tactum_pose X_DH = at(0, 0, 0);
  EXPECT_EQ(tactum_step_pose(scene, &X_DH, nullptr), TACTUM_BAD_CALL);
  EXPECT_STREQ(tactum_last_error(),
               "tactum_step_pose: the scene has several hands, which tactum_step_hands takes");
  tactum_sample samples[2] = {};
  for (tactum_sample& sample : samples) {
    sample.struct_size = sizeof sample;
    sample.X_DH = X_DH;
  }
  EXPECT_EQ(tactum_step_hands(scene, sizeof samples[0], samples, 1, nullptr, nullptr), TACTUM_BAD_CALL);
  tactum_frame frame{};
  frame.struct_size = sizeof frame;
  tactum_wrench F_D[2];
  {
    const AllocationGuard guard;
    for (int i = 0; i < 50; ++i) {
      samples[0].X_DH.p[2] = -2e-4 * i;  // the peg is led down on the block
      ASSERT_EQ(tactum_step_hands(scene, sizeof samples[0], samples, 2, F_D, &frame), TACTUM_OK);
    }
    EXPECT_EQ(guard.allocations(), 0u);
  }
  tactum_hand hands[2] = {};
  for (int h = 0; h < 2; ++h) {
    hands[h].struct_size = sizeof hands[h];
    ASSERT_EQ(tactum_get_hand(scene, h, &hands[h]), TACTUM_OK);
    EXPECT_EQ(hands[h].F_D.f[2], F_D[h].f[2]);
  }
  EXPECT_GT(F_D[0].f[2], 0.1);
  EXPECT_LT(F_D[1].f[2], -0.1) << "what one hand feels the other gives";
  EXPECT_EQ(hands[0].X_WH.p[2], frame.X_WH.p[2]);
  EXPECT_NE(hands[0].grasped_body, hands[1].grasped_body);
  EXPECT_EQ(tactum_get_hand(scene, 2, &hands[0]), TACTUM_BAD_CALL);
  tactum_close_scene(scene);
}

TEST(CWorldThreads, TwoThreadsMakeAWorldEachOfOnePart) {
  tactum_part* cube = nullptr;
  ASSERT_EQ(tactum_make_part(corners().front().data(), 8, kTriangles[0], 12, nullptr, &cube), TACTUM_OK);
  std::uint64_t hashes[2] = {1, 2};
  std::vector<std::thread> threads;
  for (std::uint64_t& hash : hashes)
    threads.emplace_back([&hash, cube] {
      tactum_world* world = nullptr;
      tactum_simulation* scene = nullptr;
      tactum_joint fixed{};
      fixed.struct_size = sizeof fixed;
      fixed.kind = TACTUM_JOINT_FIXED;
      tactum_body_options below{}, above{};
      below.struct_size = above.struct_size = sizeof below;
      below.joint = &fixed;
      above.name = "above";
      tactum_tool tool{};
      tool.struct_size = sizeof tool;
      tool.body = "above";
      const tactum_pose low = at(0, 0, 0), high = at(0, 0, 0.021);
      EXPECT_EQ(tactum_make_world(nullptr, &world), TACTUM_OK);
      EXPECT_EQ(tactum_add_body(world, cube, &low, &below, nullptr), TACTUM_OK) << tactum_last_error();
      EXPECT_EQ(tactum_add_body(world, cube, &high, &above, nullptr), TACTUM_OK) << tactum_last_error();
      ASSERT_EQ(tactum_open_world(world, sizeof tool, &tool, 1, 0.0, &scene), TACTUM_OK)
          << tactum_last_error();
      for (int i = 0; i < 200; ++i) {
        const tactum_pose X_DH = at(0, 0, -2e-5 * i);
        EXPECT_EQ(tactum_step_pose(scene, &X_DH, nullptr), TACTUM_OK);
      }
      hash = tactum_run_hash(scene);
      tactum_close_scene(scene);
      tactum_release_world(world);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(hashes[0], hashes[1]);
  tactum_release_part(cube);
}

}  // namespace
}  // namespace tactum::c_world_test
