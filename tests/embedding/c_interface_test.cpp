/// The C interface: the frames of the library to the bit, its sentences, structs of other versions, threads.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <thread>

#include "support/allocation_guard.h"
#include "support/effort.h"
#include "tactum/embedding/tactum_c.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"
#include "tactum/version.h"

namespace tactum::c_interface_test {

using tactum::testing::kSanitized;

namespace {

/// Closes the scene at the end of a test.
struct OpenScene {
  explicit OpenScene(const char* name, const tactum_scene_options* options = nullptr) {
    EXPECT_EQ(tactum_open_scene(name, options, &scene), TACTUM_OK) << tactum_last_error();
  }
  ~OpenScene() { tactum_close_scene(scene); }
  OpenScene(const OpenScene&) = delete;
  OpenScene& operator=(const OpenScene&) = delete;
  tactum_simulation* scene = nullptr;
};

/// Leads the scene by its own hand for so many frames; the hash of all of them.
std::uint64_t led_by_its_hand(tactum_simulation* scene, int frames) {
  EXPECT_EQ(tactum_open_hand(scene), TACTUM_OK);
  tactum_frame frame{};
  frame.struct_size = sizeof frame;
  for (int i = 0; i < frames; ++i) {
    tactum_sample sample{};
    sample.struct_size = sizeof sample;
    if (tactum_read_hand(scene, &sample) != TACTUM_OK ||
        tactum_step_sample(scene, &sample, &frame) != TACTUM_OK ||
        tactum_write_hand(scene, &frame.F_D) != TACTUM_OK)
      ADD_FAILURE() << tactum_last_error();
  }
  tactum_close_hand(scene);
  return tactum_run_hash(scene);
}

std::uint64_t hash_of_session(const char* name, int frames) {
  auto session = Session::open(std::move(*open_scene(name)), SessionOptions{});
  EXPECT_TRUE((*session)->run_virtual(static_cast<std::uint64_t>(frames), nullptr));
  return (*session)->record().hash();
}

TEST(CInterface, StepsASceneToTheBitAsASessionRunsIt) {
  const int frames = kSanitized ? 500 : 4000;
  for (const char* name : {"gears", "block-on-plate", "peg-in-hole"}) {
    const OpenScene open(name);
    EXPECT_EQ(led_by_its_hand(open.scene, frames), hash_of_session(name, frames)) << name;
  }
}

TEST(CInterface, OptionsCountAsTheyDoInTheProgram) {
  tactum_scene_options options{};
  options.struct_size = sizeof options;
  options.response = "penalty";
  options.rate_Hz = 2000.0;
  options.settings = "[settings.coupling]\nstiffness_N_per_m = 321.0\n";
  const OpenScene open("gears", &options);
  EXPECT_EQ(tactum_frame_step(open.scene), 0.0005);
  const OpenScene plain("gears");
  EXPECT_NE(led_by_its_hand(open.scene, 300), led_by_its_hand(plain.scene, 300));
}

TEST(CInterface, ErrorsAreTheSentencesOfTheLibrary) {
  tactum_simulation* scene = nullptr;
  EXPECT_EQ(tactum_open_scene("gearz", nullptr, &scene), TACTUM_REFUSED);
  EXPECT_EQ(scene, nullptr);
  EXPECT_EQ(std::string(tactum_last_error()), describe_scene("gearz").error().message());
  EXPECT_EQ(tactum_open_scene(nullptr, nullptr, &scene), TACTUM_BAD_CALL);
  EXPECT_STREQ(tactum_last_error(), "tactum_open_scene: a pointer is null");
  EXPECT_EQ(tactum_open_scene_text("schema = 2", nullptr, nullptr, &scene), TACTUM_REFUSED);
  EXPECT_NE(std::string(tactum_last_error()).find("the scene's text:1:"), std::string::npos)
      << tactum_last_error();
  tactum_part* part = nullptr;
  EXPECT_EQ(tactum_load_part("no-such-file.stl", nullptr, &part), TACTUM_REFUSED);
  EXPECT_NE(std::string(tactum_last_error()).find("no-such-file.stl"), std::string::npos);
  EXPECT_EQ(tactum_version(), TACTUM_VERSION);
  EXPECT_EQ(tactum_step_pose(nullptr, nullptr, nullptr), TACTUM_BAD_CALL);
  for (int status = TACTUM_OK; status <= TACTUM_INTERNAL; ++status)
    EXPECT_GT(std::strlen(tactum_status_text(static_cast<tactum_status>(status))), 3u);
}

TEST(CInterface, StructsOfOtherVersionsAreReadAndFilledAsFarAsBothKnowThem) {
  struct Newer {
    tactum_frame frame;
    double not_yet[4];
  } newer;
  std::memset(&newer, 0x55, sizeof newer);
  newer.frame.struct_size = sizeof newer;
  const OpenScene open("block-on-plate");
  const tactum_pose X_DH = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  ASSERT_EQ(tactum_step_pose(open.scene, &X_DH, &newer.frame), TACTUM_OK);
  EXPECT_EQ(newer.frame.struct_size, sizeof newer);
  EXPECT_EQ(newer.frame.index, 0u);
  for (const double number : newer.not_yet) EXPECT_EQ(number, 0.0);

  tactum_frame unset{};
  EXPECT_EQ(tactum_step_pose(open.scene, &X_DH, &unset), TACTUM_BAD_CALL);

  struct NewerOptions {
    tactum_scene_options options;
    double wish;
  } wishes{};
  wishes.options.struct_size = sizeof wishes;
  tactum_simulation* scene = nullptr;
  EXPECT_EQ(tactum_open_scene("block-on-plate", &wishes.options, &scene), TACTUM_OK);
  tactum_close_scene(scene);
  wishes.wish = 1.0;  // this library cannot do it, and must not pass it over
  EXPECT_EQ(tactum_open_scene("block-on-plate", &wishes.options, &scene), TACTUM_BAD_CALL);
}

TEST(CInterface, AStepAllocatesNothing) {
  const OpenScene open("gears");
  const tactum_pose X_DH = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  tactum_frame frame{};
  frame.struct_size = sizeof frame;
  const AllocationGuard guard;
  for (int i = 0; i < 100; ++i) tactum_step_pose(open.scene, &X_DH, &frame);
  EXPECT_EQ(guard.allocations(), 0u);
}

TEST(CInterface, APoseThatIsNoneSendsNoForce) {
  const OpenScene open("block-on-plate");
  tactum_pose X_DH{};  // zeros, as of a buffer that nobody filled
  tactum_frame frame{};
  frame.struct_size = sizeof frame;
  ASSERT_EQ(tactum_step_pose(open.scene, &X_DH, &frame), TACTUM_OK);
  EXPECT_NE(frame.safety, 0u);
  for (const double f : frame.F_D.f) EXPECT_EQ(f, 0.0);
}

/// Forces of the contacts add up to the wrench on the held part, and those that push have been kept.
TEST(CInterface, ContactsBalanceTheHeldPart) {
  const OpenScene open("block-on-plate");
  led_by_its_hand(open.scene, 2500);
  const tactum_simulation* scene = open.scene;
  std::size_t count = 0;
  std::vector<tactum_contact> contacts(64);
  ASSERT_EQ(tactum_contacts(open.scene, sizeof(tactum_contact), contacts.data(), contacts.size(), &count),
            TACTUM_OK);
  ASSERT_GT(count, 0u);
  ASSERT_LE(count, contacts.size());
  double pushed_N = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const tactum_contact& contact = contacts[i];
    EXPECT_LT(contact.body_a, tactum_body_count(scene));
    if (!(contact.normal_force_N > 0.0)) continue;
    EXPECT_NEAR(std::abs(contact.n_BA_W[2]), 1.0, 1e-9);
    EXPECT_LT(contact.residual_m, 1e-9);
    pushed_N += contact.normal_force_N;
  }
  EXPECT_GT(pushed_N, 0.1);
  tactum_pose still{};
  const tactum_pose at_rest = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  still = at_rest;
  tactum_frame frame{};
  frame.struct_size = sizeof frame;
  ASSERT_EQ(tactum_step_pose(open.scene, &still, &frame), TACTUM_OK);
  ASSERT_EQ(tactum_contacts(open.scene, sizeof(tactum_contact), contacts.data(), contacts.size(), &count),
            TACTUM_OK);
  double along_z_N = 0.0;
  for (std::size_t i = 0; i < std::min(count, contacts.size()); ++i) {
    const double on_grasped = contacts[i].body_a == frame.grasped_body ? 1.0 : -1.0;
    along_z_N += on_grasped * contacts[i].normal_force_N * contacts[i].n_BA_W[2];
  }
  EXPECT_NEAR(along_z_N, frame.F_W.f[2], 1e-9 + 1e-6 * std::abs(along_z_N));
}

/// A torque about a point and the force that makes it stay so in the axes of an engine, for the cross product
/// by components; poses go there and back.
TEST(CInterface, AxesOfEnginesKeepTheMechanics) {
  const Vec3 r(0.3, -0.2, 0.5), f(1.0, 2.0, -3.0);
  const Vec3 t = r.cross(f);
  const Quat q = Quat(0.5, 0.1, -0.7, 0.3).normalized();
  for (const tactum_axes axes : {TACTUM_AXES_W, TACTUM_AXES_UNITY, TACTUM_AXES_UNREAL}) {
    const tactum_wrench F = {{f.x(), f.y(), f.z()}, {t.x(), t.y(), t.z()}};
    Vec3 point, force, torque;
    tactum_point_to_engine(axes, r.data(), point.data());
    tactum_wrench_to_engine(axes, &F, force.data(), torque.data());
    EXPECT_LT((point.cross(force) - torque).norm(), 1e-12 * torque.norm());
    tactum_wrench back{};
    tactum_wrench_from_engine(axes, force.data(), torque.data(), &back);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(back.t[i], F.t[i], 1e-14);

    tactum_pose X{};
    const Mat3 R = q.toRotationMatrix();
    for (int i = 0; i < 9; ++i) X.R[i] = R(i / 3, i % 3);
    std::copy(r.data(), r.data() + 3, X.p);
    double position[3], turn[4];
    tactum_pose_to_engine(axes, &X, position, turn);
    // A point of the body goes the same way through the engine's pose as through ours.
    const Vec3 p_B(0.02, 0.07, -0.04);
    Vec3 in_engine, of_body;
    tactum_point_to_engine(axes, Vec3(R * p_B + r).data(), in_engine.data());
    tactum_point_to_engine(axes, p_B.data(), of_body.data());
    const Quat engine(turn[3], turn[0], turn[1], turn[2]);
    EXPECT_LT((engine * of_body + Vec3(position[0], position[1], position[2]) - in_engine).norm(), 1e-12);
    tactum_pose again{};
    tactum_pose_from_engine(axes, position, turn, &again);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(again.R[i], X.R[i], 1e-14);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(again.p[i], X.p[i], 1e-14);
  }
  Vec3 up;
  tactum_direction_to_engine(TACTUM_AXES_UNITY, Vec3(0, 0, 1).data(), up.data());
  EXPECT_EQ(up, Vec3(0, 1, 0));
  tactum_point_to_engine(TACTUM_AXES_UNREAL, Vec3(0.1, 0.2, 0.3).data(), up.data());
  EXPECT_LT((up - Vec3(10, -20, 30)).norm(), 1e-12);
}

TEST(CInterface, ScenesThatAreClosedLeaveNothing) {
  const int scenes = tactum::testing::full_run() ? 1000 : 100;
  for (int i = 0; i < scenes; ++i) {
    tactum_simulation* scene = nullptr;
    ASSERT_EQ(tactum_open_scene("block-on-plate", nullptr, &scene), TACTUM_OK);
    tactum_close_scene(scene);  // the sanitized run counts what is left
  }
}

TEST(CInterfaceThreads, TwoThreadsStepASceneEach) {
  constexpr int kFrames = 200;
  std::uint64_t hashes[2] = {1, 2};
  std::string sentences[2];
  std::vector<std::thread> threads;
  for (int i = 0; i < 2; ++i)
    threads.emplace_back([&, i] {
      tactum_simulation* scene = nullptr;
      EXPECT_EQ(tactum_open_scene(i == 0 ? "no-such" : "nor-this", nullptr, &scene), TACTUM_REFUSED);
      const OpenScene open("block-on-plate");
      hashes[i] = led_by_its_hand(open.scene, kFrames);
      sentences[i] = tactum_last_error();
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_NE(sentences[0].find("no-such"), std::string::npos) << "each thread has its own last error";
  EXPECT_NE(sentences[1].find("nor-this"), std::string::npos);
}

}  // namespace
}  // namespace tactum::c_interface_test
