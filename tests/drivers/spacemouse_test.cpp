#include "tactum/drivers/spacemouse.h"

#include <gtest/gtest.h>

#include <fstream>

#include "standins/standin_spacenavd.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/math/screw.h"

namespace tactum::spacemouse_test {

/// A daemon with a SpaceMouse that is open on it.
struct Led {
  explicit Led(int protocol) : daemon(protocol) {
    Result<std::unique_ptr<Device>> made = SpaceMouse::connect(daemon.path());
    EXPECT_TRUE(made) << made.error().message();
    if (!made) return;
    mouse = std::move(*made);
    EXPECT_TRUE(mouse->open());
    EXPECT_TRUE(comes_true([this] { return daemon.has_client(); }));
  }
  /// Reads, at the same instant, until `seen` holds; so the pose does not move on meanwhile.
  template <class Seen>
  bool reads_until(Seen seen) {
    return comes_true([&] { return mouse->read(now_s, sample) && seen(sample); });
  }
  bool pushed(double v) {
    return reads_until([v](const DeviceSample& now) { return std::abs(now.V_DH.v.norm() - v) < 1e-12; });
  }

  standin::Spacenavd daemon;
  std::unique_ptr<Device> mouse;
  DeviceSample sample;
  double now_s = 0.0;
};

TEST(SpaceMouse, SpeaksBothVersionsOfTheProtocol) {
  for (const int protocol : {0, 1}) {
    Led led(protocol);
    ASSERT_TRUE(led.mouse);
    led.daemon.send_motion(500, 0, 0, 0, 0, 0);
    EXPECT_TRUE(led.pushed(SpaceMouse::kFullSpeed_m_per_s)) << "version " << protocol;
    EXPECT_EQ(led.daemon.sensitivity(), protocol == 0 ? 1.0f : 0.0f);
    EXPECT_EQ(led.daemon.event_mask(), protocol == 0 ? 0 : 3);
  }
}

TEST(SpaceMouse, EachAxisLeadsWhereTheHandPushes) {
  Led led(1);
  ASSERT_TRUE(led.mouse);
  const double v = SpaceMouse::kFullSpeed_m_per_s, w = SpaceMouse::kFullTurn_rad_per_s;
  // x right is +y of D, y up is +z, z away from the user is -x.
  const struct {
    std::array<int, 6> counts;
    Twist V;
  } cases[] = {
      {{500, 0, 0, 0, 0, 0}, {{0, v, 0}, {0, 0, 0}}},  {{0, 500, 0, 0, 0, 0}, {{0, 0, v}, {0, 0, 0}}},
      {{0, 0, 500, 0, 0, 0}, {{-v, 0, 0}, {0, 0, 0}}}, {{0, 0, 0, 500, 0, 0}, {{0, 0, 0}, {0, w, 0}}},
      {{0, 0, 0, 0, 500, 0}, {{0, 0, 0}, {0, 0, w}}},  {{0, 0, 0, 0, 0, 500}, {{0, 0, 0}, {-w, 0, 0}}}};
  for (const auto& c : cases) {
    led.daemon.send_motion(c.counts[0], c.counts[1], c.counts[2], c.counts[3], c.counts[4], c.counts[5]);
    EXPECT_TRUE(led.reads_until([&c](const DeviceSample& now) {
      return (now.V_DH.v - c.V.v).norm() + (now.V_DH.w - c.V.w).norm() < 1e-12;
    })) << led.sample.V_DH.v.transpose();
  }
}

TEST(SpaceMouse, ACapHeldStillGoesOnLeadingAndOneAtRestStops) {
  Led led(1);
  ASSERT_TRUE(led.mouse);
  ASSERT_TRUE(led.pushed(0.0));
  led.daemon.send_motion(250, 0, 0, 0, 0, 500);
  ASSERT_TRUE(led.pushed(0.05));
  for (int i = 1; i <= 1000; ++i) ASSERT_TRUE(led.mouse->read(led.now_s = i * 0.001, led.sample));
  EXPECT_NEAR(led.sample.X_DH.p.y(), 0.05, 1e-9) << "a second at 0.05 m/s";
  EXPECT_NEAR((log_rotation(led.sample.X_DH.R) - Vec3(-SpaceMouse::kFullTurn_rad_per_s, 0, 0)).norm(), 0.0,
              1e-9);
  led.daemon.send_motion(0, 0, 0, 0, 0, 0);
  ASSERT_TRUE(led.pushed(0.0));
  const Pose rest = led.sample.X_DH;
  ASSERT_TRUE(led.mouse->read(led.now_s + 0.01, led.sample));
  EXPECT_EQ(led.sample.X_DH.p, rest.p);
}

TEST(SpaceMouse, StaysWithinItsReachAndIsNotThrownByAPause) {
  Led led(1);
  ASSERT_TRUE(led.mouse);
  led.daemon.send_motion(0, 500, 0, 0, 0, 0);
  ASSERT_TRUE(led.pushed(SpaceMouse::kFullSpeed_m_per_s));
  ASSERT_TRUE(led.mouse->read(led.now_s = 10.0, led.sample));
  EXPECT_LE(led.sample.X_DH.p.norm(), SpaceMouse::kFullSpeed_m_per_s * SpaceMouse::kLongestStep_s + 1e-12);
  for (int i = 1; i <= 2000; ++i) ASSERT_TRUE(led.mouse->read(led.now_s = 10.0 + i * 0.001, led.sample));
  EXPECT_NEAR(led.sample.X_DH.p.z(), SpaceMouse::kRange_m, 1e-12);
  EXPECT_NEAR(led.sample.V_DH.v.norm(), 0.0, 1e-9) << "it stands at the edge";
}

TEST(SpaceMouse, MessagesInPiecesAndUnknownOnesAreTaken) {
  Led led(1);
  ASSERT_TRUE(led.mouse);
  const std::array<std::int32_t, 8> motion{0, 0, 0, -500, 0, 0, 0, 16};
  led.daemon.send(motion.data(), 10);
  ASSERT_TRUE(led.mouse->read(0.0, led.sample));
  EXPECT_EQ(led.sample.V_DH.v.norm(), 0.0) << "not before it is whole";
  led.daemon.send(reinterpret_cast<const char*>(motion.data()) + 10, sizeof motion - 10);
  ASSERT_TRUE(led.pushed(SpaceMouse::kFullSpeed_m_per_s));
  led.daemon.send_message({3, 0, 1});          // a device was plugged in
  led.daemon.send_message({0x2000, 1, 2, 3});  // an answer that nobody waits for
  led.daemon.send_button(40, true);            // more buttons than a sample has
  led.daemon.send_button(2, true);
  EXPECT_TRUE(led.reads_until([](const DeviceSample& now) { return now.buttons == 4; }));
  EXPECT_NEAR(led.sample.V_DH.v.x(), SpaceMouse::kFullSpeed_m_per_s, 1e-12);
}

TEST(SpaceMouse, CountsBeyondTheFullDeflectionAreTheFullOne) {
  Led led(1);
  ASSERT_TRUE(led.mouse);
  led.daemon.send_motion(2'000'000'000, -2'000'000'000, 0, 0, 0, 0);
  EXPECT_TRUE(led.pushed(SpaceMouse::kFullSpeed_m_per_s * std::sqrt(2.0)));
}

TEST(SpaceMouse, GarbageEndsTheConnectionAndThePoseStays) {
  Led led(1);
  ASSERT_TRUE(led.mouse);
  led.daemon.send_motion(500, 0, 0, 0, 0, 0);
  ASSERT_TRUE(led.pushed(SpaceMouse::kFullSpeed_m_per_s));
  ASSERT_TRUE(led.mouse->read(0.01, led.sample));
  const Pose before = led.sample.X_DH;
  led.daemon.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", 36);
  ASSERT_TRUE(comes_true([&led] { return !led.mouse->read(0.02, led.sample); }));
  EXPECT_EQ(led.sample.X_DH.p, before.p);
  EXPECT_FALSE(led.mouse->write({}));
  EXPECT_NE(led.mouse->trouble().find("SPNAV_SOCKET"), std::string::npos) << led.mouse->trouble();
}

TEST(SpaceMouse, AnAnswerBehindTheFirstMotionIsNoGarbage) {
  // A daemon of version 1 may send a motion when it is greeted: here one of version 0 does, and answers.
  Led led(0);
  ASSERT_TRUE(led.mouse);
  led.daemon.send_motion(500, 0, 0, 0, 0, 0);
  const std::int32_t answer = 0x7faa5501;
  led.daemon.send(&answer, sizeof answer);
  led.daemon.send_button(0, true);
  ASSERT_TRUE(led.reads_until([](const DeviceSample& now) { return now.buttons == 1; }));
  EXPECT_NEAR(led.sample.V_DH.v.y(), SpaceMouse::kFullSpeed_m_per_s, 1e-12);
}

TEST(SpaceMouse, ASocketThatIsNoneIsToldWithItsCure) {
  EXPECT_FALSE(SpaceMouse::connect(std::string(200, 'x'))) << "longer than a socket's name can be";
  const std::string file = testing::TempDir() + "tactum_no_socket";
  std::ofstream(file) << "a file";
  const Result<std::unique_ptr<Device>> mouse = SpaceMouse::connect(file);
  std::filesystem::remove(file);
  ASSERT_FALSE(mouse);
  EXPECT_NE(mouse.error().message().find("spacenavd running"), std::string::npos) << mouse.error().message();
}

}  // namespace tactum::spacemouse_test
