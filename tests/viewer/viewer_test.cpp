#include "viewer/server/viewer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "support/allocation_guard.h"
#include "support/effort.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"
#include "viewer/raw_page.h"
#include "viewer/server/page.h"

namespace tactum {
namespace {

using testing::RawPage;
using testing::word_at;
using Json = nlohmann::json;

std::unique_ptr<Viewer> open_viewer(const std::string& scene_name) {
  Result<Scene> scene = open_scene(scene_name);
  EXPECT_TRUE(scene);
  Result<std::unique_ptr<Viewer>> viewer = Viewer::open(std::move(*scene), {}, 0);
  EXPECT_TRUE(viewer) << viewer.error().message();
  return std::move(*viewer);
}

/// A page that looks, acknowledges, and steers nothing, on its own thread.
class Onlooker {
 public:
  Onlooker(int port, const std::string& token)
      : page_(port, token, "http://127.0.0.1:" + std::to_string(port)), thread_([this] { look(); }) {}
  ~Onlooker() {
    done_ = true;
    thread_.join();
  }
  std::uint64_t samples() const { return samples_; }

 private:
  void look() {
    while (!done_) {
      const RawPage::Message message = page_.next(50);
      if (message.kind == 8) return;
      if (message.kind != 2) continue;
      samples_ += word_at(message.payload, 3);
      page_.say("{\"do\":\"ack\",\"seq\":" + std::to_string(word_at(message.payload, 1)) + "}");
    }
  }
  RawPage page_;
  std::atomic<bool> done_{false};
  std::atomic<std::uint64_t> samples_{0};
  std::thread thread_;
};

class PassOn final : public LoopObserver {
 public:
  explicit PassOn(Viewer& viewer) : viewer_(viewer) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    viewer_.after_virtual_frame(record);
    return true;
  }

 private:
  Viewer& viewer_;
};

/// The hash of a run on the virtual clock with so many pages looking; and how many samples they saw.
std::uint64_t hash_with_pages(int pages, std::uint64_t frames, std::uint64_t& seen) {
  const std::unique_ptr<Viewer> viewer = open_viewer("gears");
  const Server& server = viewer->server();
  std::vector<std::unique_ptr<Onlooker>> onlookers;
  for (int i = 0; i < pages; ++i)
    onlookers.push_back(std::make_unique<Onlooker>(server.port(), server.token()));
  while (server.status().pages < pages) std::this_thread::yield();
  PassOn watch(*viewer);
  EXPECT_TRUE(viewer->session().run_virtual(frames, &watch));
  const std::uint64_t expected = static_cast<std::uint64_t>(pages) * (frames / 16 * 16);
  const auto all_seen = [&] {
    seen = 0;
    for (const auto& onlooker : onlookers) seen += onlooker->samples();
    return seen + server.status().samples_lost >= expected;
  };
  for (int i = 0; i < 1000 && !all_seen(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(all_seen()) << seen << " of " << expected;
  return viewer->session().record().hash();
}

constexpr std::uint64_t kFrames = testing::effort(4000, 1000);

// tools/viewer_work.py runs these two by name and counts the instructions of the loop's work.
TEST(ViewerRun, WithoutPages) {
  std::uint64_t seen = 0;
  EXPECT_NE(hash_with_pages(0, kFrames, seen), 0u);
}
TEST(ViewerRun, WithFourPages) {
  std::uint64_t seen = 0;
  EXPECT_NE(hash_with_pages(4, kFrames, seen), 0u);
}

TEST(ViewerRun, TheFramesAreTheSameWithAndWithoutPages) {
  std::uint64_t seen = 0;
  const std::uint64_t alone = hash_with_pages(0, kFrames, seen);
  EXPECT_EQ(hash_with_pages(4, kFrames, seen), alone);
  EXPECT_GT(seen, 0u);
  // ... and as in a session without a viewer.
  Result<Scene> scene = open_scene("gears");
  ASSERT_TRUE(scene);
  Result<std::unique_ptr<Session>> bare =
      Session::open(std::move(*scene), {.device = "pointer:premium-1.5-6dof", .grip = "", .rate_Hz = 0.0});
  ASSERT_TRUE(bare);
  ASSERT_TRUE((*bare)->run_virtual(kFrames, nullptr));
  EXPECT_EQ((*bare)->record().hash(), alone);
}

/// Polls until the condition holds; false after a long while.
bool polled_until(Viewer& viewer, const std::function<bool()>& condition) {
  for (int i = 0; i < 4000; ++i) {
    if (condition()) return true;
    viewer.poll(std::chrono::milliseconds(5));
  }
  return false;
}

/// Reads messages of one type until one pleases.
Json message_when(Viewer& viewer, RawPage& page, const std::string& type,
                  const std::function<bool(const Json&)>& pleases) {
  for (int i = 0; i < 4000; ++i) {
    viewer.poll(std::chrono::milliseconds(1));
    const RawPage::Message message = page.next(1);
    if (message.kind == 2)
      page.say("{\"do\":\"ack\",\"seq\":" + std::to_string(word_at(message.payload, 1)) + "}");
    if (message.kind != 1) continue;
    Json json = Json::parse(message.payload, nullptr, false);
    if (json.value("type", "") == type && pleases(json)) return json;
  }
  return {};
}

/// Opens a page on a viewer that runs.
RawPage page_of(const Viewer& viewer) {
  const Server& server = viewer.server();
  return RawPage(server.port(), server.token(), "http://127.0.0.1:" + std::to_string(server.port()));
}

TEST(ViewerThread, AStopReachesTheLoopThoughTheOwnerIsBusy) {
  const std::unique_ptr<Viewer> viewer = open_viewer("block-on-plate");
  ASSERT_TRUE(viewer->start());
  RawPage page = page_of(*viewer);
  ASSERT_TRUE(page.accepted());
  page.say("{\"do\":\"stop\"}");
  bool stopped = false;
  for (int i = 0; i < 4000 && !stopped; ++i) {  // no request is taken meanwhile
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    stopped = (viewer->session().poll().safety & safety_flag::kStopped) != 0;
  }
  EXPECT_TRUE(stopped);
  viewer->stop();
}

/// Contacts and poses beside the numbers of another frame would explain a force by what did not cause it. The
/// owner is busy for so long that the numbers of many frames are lost.
TEST(ViewerThread, EveryPictureComesWithTheNumbersOfItsFrame) {
  Result<Scene> scene = open_scene("block-on-plate");
  ASSERT_TRUE(scene);
  Result<std::unique_ptr<Viewer>> opened =
      Viewer::open(std::move(*scene), {.device = "", .grip = "", .rate_Hz = 10000.0}, 0);
  ASSERT_TRUE(opened) << opened.error().message();
  Viewer& viewer = **opened;
  RawPage page = page_of(viewer);
  ASSERT_TRUE(page.accepted());
  ASSERT_TRUE(viewer.start());
  while (viewer.session().poll().frame < FrameFeed::kSamples + 2000)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::set<std::uint32_t> frames;
  int pictures = 0;
  std::uint32_t newest = 0;
  const auto look = [&](const RawPage::Message& message) {
    const std::uint32_t rows = word_at(message.payload, 3), numbers = word_at(message.payload, 4);
    const std::size_t picture = word_at(message.payload, 6);
    for (std::uint32_t row = 0; row < rows; ++row)
      frames.insert(word_at(message.payload, 8 + picture / 4 + row * (numbers + 1)));
    page.say("{\"do\":\"ack\",\"seq\":" + std::to_string(word_at(message.payload, 1)) + "}");
    if (picture == 0) return;
    newest = word_at(message.payload, 8);
    EXPECT_TRUE(frames.contains(newest)) << newest;
    ++pictures;
  };
  for (int i = 0; i < 4000 && (pictures < 40 || newest < FrameFeed::kSamples + 2000); ++i) {
    viewer.poll(std::chrono::milliseconds(1));
    if (const RawPage::Message message = page.next(1); message.kind == 2) look(message);
  }
  EXPECT_GE(pictures, 40);
  EXPECT_GE(newest, FrameFeed::kSamples + 2000);  // pictures go on when there is room again
  viewer.stop();
}

/// A coupling that the device chooses is that of the device that is in use, also when it is taken back.
TEST(ViewerThread, SettingsGoBackToWhatTheSceneAndTheDeviceHave) {
  const std::unique_ptr<Viewer> viewer =
      open_viewer("gears-involute");  // it leaves the coupling to the device
  ASSERT_TRUE(viewer->start());
  RawPage page = page_of(*viewer);
  ASSERT_TRUE(page.accepted());
  const auto value_of = [](const Json& message, const std::string& key, const char* which) {
    for (const Json& setting : message["settings"])
      if (setting["section"] == "coupling" && setting["key"] == key) return setting[which].get<double>();
    return 0.0;
  };
  const auto usual = [&](const Json& message) { return value_of(message, "stiffness_N_per_m", "usual"); };
  const auto now = [&](const Json& message) { return value_of(message, "stiffness_N_per_m", "value"); };
  const auto any = [](const Json&) { return true; };
  const Json run = message_when(*viewer, page, "run", any);
  ASSERT_TRUE(run.is_object());
  EXPECT_EQ(run["coupling_by_device"], true);
  EXPECT_EQ(run["toml"], "");
  EXPECT_EQ(now(run), usual(run));
  page.say("{\"do\":\"set\",\"key\":\"coupling.stiffness_N_per_m\",\"value\":432}");
  const Json set =
      message_when(*viewer, page, "settings", [&](const Json& json) { return now(json) == 432.0; });
  ASSERT_TRUE(set.is_object());
  EXPECT_EQ(set["coupling_by_device"], false);
  EXPECT_NE(set["toml"].get<std::string>().find("coupling.damping_Ns_per_m"), std::string::npos)
      << "all of it";
  page.say("{\"do\":\"device\",\"name\":\"pointer:virtuose-6d\"}");
  const Json other = message_when(*viewer, page, "run", [](const Json& json) { return json["run"] == 2; });
  ASSERT_TRUE(other.is_object());
  EXPECT_EQ(now(other), 432.0);
  EXPECT_NE(usual(other), usual(run));
  page.say("{\"do\":\"unset\",\"key\":\"coupling.stiffness_N_per_m\"}");
  const Json back =
      message_when(*viewer, page, "settings", [&](const Json& json) { return now(json) == usual(other); });
  ASSERT_TRUE(back.is_object());
  viewer->stop();
}

TEST(ViewerThread, StopsResumesSetsAndSwitchesAsAsked) {
  const std::unique_ptr<Viewer> viewer = open_viewer("block-on-plate");
  ASSERT_TRUE(viewer->start());
  const Server& server = viewer->server();
  RawPage page(server.port(), server.token(), "http://127.0.0.1:" + std::to_string(server.port()));
  ASSERT_TRUE(page.accepted());
  const auto any = [](const Json&) { return true; };
  const Json run = message_when(*viewer, page, "run", any);
  ASSERT_TRUE(run.is_object());
  EXPECT_EQ(run["scene"], "block-on-plate");
  EXPECT_EQ(run["stages"].size(), wrench_stages().size());
  EXPECT_EQ(run["channels"].size(), channels().size() + kStageCount + 2);
  EXPECT_EQ(run["settings"].size(), setting_table().size());

  page.say("{\"do\":\"set\",\"key\":\"coupling.stiffness_N_per_m\",\"value\":432}");
  const Json settings = message_when(*viewer, page, "settings", any);
  ASSERT_TRUE(settings.is_object());
  EXPECT_NE(settings["toml"].get<std::string>().find("stiffness_N_per_m = 432"), std::string::npos);
  page.say("{\"do\":\"set\",\"key\":\"coupling.stiffness_N_per_m\",\"value\":1e9}");
  EXPECT_TRUE(message_when(*viewer, page, "notice", any).is_object());

  page.say("{\"do\":\"stop\"}");
  EXPECT_TRUE(polled_until(*viewer, [&] { return (viewer->status().safety & safety_flag::kStopped) != 0; }));
  EXPECT_EQ(viewer->status().force_N, 0.0);
  page.say("{\"do\":\"scene\",\"name\":\"peg-in-hole\"}");
  const Json next = message_when(*viewer, page, "run", [](const Json& json) { return json["run"] == 2; });
  ASSERT_TRUE(next.is_object());
  EXPECT_EQ(next["scene"], "peg-in-hole");
  // A stop outlives the scene it was said in.
  EXPECT_TRUE(polled_until(*viewer, [&] { return (viewer->status().safety & safety_flag::kStopped) != 0; }));
  page.say("{\"do\":\"resume\"}");
  EXPECT_TRUE(polled_until(*viewer, [&] { return (viewer->status().safety & safety_flag::kStopping) == 0; }));
  page.say("{\"do\":\"scene\",\"name\":\"/etc/passwd\"}");
  const Json notice = message_when(*viewer, page, "notice", any);
  EXPECT_NE(notice.value("sentence", "").find("no scene"), std::string::npos);
  page.say("{\"do\":\"device\",\"name\":\"replay:/etc/passwd\"}");
  EXPECT_TRUE(message_when(*viewer, page, "notice", any).is_object());
  viewer->stop();
}

TEST(FrameFeed, TakingAFrameAllocatesNothingAndLosesTheNewestWhenFull) {
  Result<Scene> scene = open_scene("gears");
  ASSERT_TRUE(scene);
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  ASSERT_TRUE(session);
  FrameFeed feed((*session)->scene().world, 1000.0);
  (*session)->show_to(&feed);
  ASSERT_TRUE((*session)->run_virtual(FrameFeed::kSamples + 100, nullptr));
  EXPECT_EQ(feed.dropped(), 100u);
  const AllocationGuard guard;
  feed.take({(*session)->last_report(), (*session)->state(), (*session)->scene().settings}, nullptr);
  EXPECT_EQ(guard.allocations(), 0u);
  FrameSample sample;
  std::uint64_t expected = 0;
  while (feed.pop(sample)) {
    ASSERT_EQ(sample.index, expected++);
  }
  EXPECT_EQ(expected, FrameFeed::kSamples);
  ASSERT_TRUE(feed.look());
  EXPECT_LT(feed.picture().index, FrameFeed::kSamples);  // none of a frame whose numbers were lost
  EXPECT_EQ(feed.picture().X_WB.size(), 2u);
  EXPECT_LE(sample_size(), FrameSample::kRoom);
}

TEST(FrameFeed, APictureHasWhatEveryHandFeels) {
  Result<Scene> scene = open_scene("peg-two-hands");
  ASSERT_TRUE(scene);
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  ASSERT_TRUE(session);
  FrameFeed feed((*session)->scene().world, (*session)->rate_Hz(), (*session)->hands());
  class Watch final : public LoopObserver {
   public:
    Watch(FrameFeed& feed, const Session& session) : feed_(feed), session_(session) {}
    bool after_frame(const FrameRecord&) noexcept override {
      FrameSample sample;
      while (feed_.pop(sample)) {
      }
      if (!feed_.look() || feed_.picture().index != session_.last_report().index) return true;
      const HandPicture& hand = feed_.picture().other_hands.at(0);
      const HandReport& report = session_.state().other_reports[0];
      holds_block =
          holds_block && session_.scene().world.bodies.at(std::size_t(hand.grasped_body)).name == "block";
      const Vec3 sent_W = session_.state().other_hands[0].hand.X_WD.R * report.shown.f;
      worst = std::max({worst, (hand.shown_W.f - sent_W).norm(), (hand.X_WH.p - report.X_WH.p).norm(),
                        (hand.X_WH_proxy.p - report.X_WH_proxy.p).norm()});
      largest = std::max(largest, sent_W.norm());
      return true;
    }
    bool holds_block = true;
    double worst = 0.0, largest = 0.0;

   private:
    FrameFeed& feed_;
    const Session& session_;
  } watch(feed, **session);
  (*session)->show_to(&feed);
  ASSERT_TRUE((*session)->run_virtual(4000, &watch));
  EXPECT_TRUE(watch.holds_block);
  EXPECT_LT(watch.worst, 1e-12);
  EXPECT_GT(watch.largest, 0.1);
}

/// In nut-bolt there are more contacts than a picture has room for, and most of them do not push.
class PictureForces : public ::testing::TestWithParam<std::pair<const char*, std::uint64_t>> {};

TEST_P(PictureForces, AddUpToTheContactStage) {
  const auto [name, frames] = GetParam();
  Result<Scene> scene = open_scene(name);
  ASSERT_TRUE(scene);
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  ASSERT_TRUE(session);
  FrameFeed feed((*session)->scene().world, 1000.0);
  class Watch final : public LoopObserver {
   public:
    Watch(FrameFeed& feed, const Session& session) : feed_(feed), session_(session) {}
    bool after_frame(const FrameRecord&) noexcept override {
      FrameSample sample;
      while (feed_.pop(sample)) {
      }
      if (!feed_.look() || feed_.picture().index != session_.last_report().index) return true;
      const int grasped = session_.scene().settings.tool.body;
      left_out = std::max(left_out, feed_.picture().contacts_left_out);
      Vec3 sum = Vec3::Zero();
      for (const ShownContact& contact : feed_.picture().contacts) {
        if (contact.body_a == grasped) sum += contact.force_N * contact.n_W;
        if (contact.body_b == grasped) sum -= contact.force_N * contact.n_W;
      }
      const Vec3 reported(sample.values[0], sample.values[1], sample.values[2]);
      worst = std::max(worst, (sum - reported).norm());
      largest = std::max(largest, reported.norm());
      return true;
    }
    double worst = 0.0, largest = 0.0;
    int left_out = 0;

   private:
    FrameFeed& feed_;
    const Session& session_;
  } watch(feed, **session);
  (*session)->show_to(&feed);
  ASSERT_TRUE((*session)->run_virtual(frames, &watch));
  EXPECT_GT(watch.largest, 0.05);
  EXPECT_LT(watch.worst, 1e-5 * watch.largest);  // single precision
  EXPECT_EQ(watch.left_out > 0, std::string(name) == "nut-bolt");
}
INSTANTIATE_TEST_SUITE_P(FrameFeed, PictureForces,
                         ::testing::Values(std::pair("block-on-plate", std::uint64_t{4000}),
                                           std::pair("nut-bolt", std::uint64_t{1200})));

TEST(FrameFeed, APictureTellsWhichContactsStickAndHowMuchOfTheirConeIsUsed) {
  Result<Scene> scene = open_scene("block-on-plate");
  ASSERT_TRUE(scene);
  scene->settings.response = ResponseModel::kConstraint;
  const std::size_t bodies = scene->world.bodies.size();
  scene->settings.friction = {std::vector<double>(bodies * bodies, 0.3), static_cast<int>(bodies)};
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  ASSERT_TRUE(session);
  FrameFeed feed((*session)->scene().world, 1000.0);
  class Watch final : public LoopObserver {
   public:
    Watch(FrameFeed& feed, const Session& session) : feed_(feed), session_(session) {}
    bool after_frame(const FrameRecord&) noexcept override {
      if (!feed_.look() || feed_.picture().index != session_.last_report().index) return true;
      double most = 0.0;
      bool slips = false;
      for (const ShownContact& contact : feed_.picture().contacts) {
        if (!(contact.force_N > 0.0)) continue;
        ++by_grip[static_cast<std::size_t>(contact.grip)];
        most = std::max(most, contact.cone_used);
        slips |= contact.grip == Grip::kSlips;
      }
      const FrictionReport& reported = session_.last_report().friction;
      disagree += most != reported.cone_used || slips != (reported.slipping > 0) ? 1 : 0;
      return true;
    }
    std::array<int, 3> by_grip{};
    int disagree = 0;

   private:
    FrameFeed& feed_;
    const Session& session_;
  } watch(feed, **session);
  (*session)->show_to(&feed);
  ASSERT_TRUE((*session)->run_virtual(6000, &watch));
  EXPECT_EQ(watch.by_grip[static_cast<std::size_t>(Grip::kNone)], 0) << "everything here rubs";
  EXPECT_GT(watch.by_grip[static_cast<std::size_t>(Grip::kSticks)], 50);
  EXPECT_GT(watch.by_grip[static_cast<std::size_t>(Grip::kSlips)], 50);
  EXPECT_EQ(watch.disagree, 0);
}

TEST(Page, IsThereAndSmall) {
  std::size_t bytes = 0;
  for (const PageFile& file : page_files()) bytes += file.gzip.size();
  std::printf("the page is %zu bytes, compressed\n", bytes);
  EXPECT_GT(bytes, 1000u);
  EXPECT_LE(bytes, 250'000u);
  EXPECT_EQ(page_files().front().path, "index.html");
}

}  // namespace
}  // namespace tactum
