#include "bench/referee.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "bench/measure.h"
#include "oracles/exhaustive.h"

namespace tactum::bench::referee_test {
namespace {

Recording two_boxes(double gap_m) {
  const Shape& box = shape("box");
  Recording recording;
  recording.poses.push_back({Mat3::Identity(), {0.06 + gap_m, 0.0, 0.0}});
  PairDistance answer;
  answer.distance = gap_m;
  answer.normal = -Vec3::UnitX();
  answer.p_a = {0.03, 0.0, 0.0};
  answer.p_b = {0.03 + gap_m, 0.0, 0.0};
  for (std::size_t f = 0; f < box.polytope.faces.size(); ++f) {
    const Vec3& n = box.polytope.faces[f].normal;
    if (n.x() > 0.5) answer.a = {FeatureKind::kFace, static_cast<int>(f)};
    if (n.x() < -0.5) answer.b = {FeatureKind::kFace, static_cast<int>(f)};
  }
  answer.stop = Stop::kCertified;
  recording.answers.push_back(answer);
  return recording;
}

TEST(Referee, ProvesARightAnswerAndMeasuresWrongOnes) {
  const Truth truth = truths(shape("box"), shape("box"), two_boxes(0.001))[0];
  EXPECT_TRUE(truth.proved);
  EXPECT_NEAR(truth.low, 0.001, 1e-15);
  EXPECT_NEAR(truth.high, 0.001, 1e-15);
  EXPECT_EQ(truth.error_of(0.001), 0.0);
  EXPECT_NEAR(truth.error_of(0.0011), 1e-4, 1e-12);
  EXPECT_NEAR(truth.error_of(-0.001), 2e-3, 1e-12);
}

TEST(Referee, IsNotTakenInByAWrongAnswer) {
  // A point off its face, a normal that is none of the features': the bounds no longer meet, and the
  // long-double search of the small pair gives the truth.
  for (const int fault : {0, 1, 2}) {
    Recording recording = two_boxes(0.001);
    PairDistance& answer = recording.answers[0];
    if (fault == 0) answer.p_a.y() = 0.05;
    if (fault == 1) answer.normal = Vec3(-1.0, 0.1, 0.0).normalized();
    if (fault == 2) answer.a.index = answer.b.index;
    const Truth truth = truths(shape("box"), shape("box"), recording)[0];
    EXPECT_TRUE(truth.proved);
    EXPECT_NEAR(truth.low, 0.001, 1e-15) << fault;
    EXPECT_NEAR(truth.high, 0.001, 1e-15) << fault;
  }
  // Of a large pair the same fault leaves the distance unproved, with bounds that still hold.
  const Shape& sphere = shape("sphere162");
  Recording recording = record(sphere, sphere, regimes()[0], 20, 3);
  const Truth right = truths(sphere, sphere, recording).back();
  recording.answers.back().p_a += Vec3(0.0, 0.0, 1e-4);
  const Truth doubted = truths(sphere, sphere, recording).back();
  EXPECT_TRUE(right.proved);
  EXPECT_FALSE(doubted.proved);
  EXPECT_LE(doubted.low, right.low);
  EXPECT_GE(doubted.high, right.high);
}

TEST(Referee, DepthsOfSmallPairsAreTheSmallestOverAllAxes) {
  Recording recording = two_boxes(-0.002);
  recording.answers[0].normal = Vec3::UnitY();  // separates them, but 80 mm long
  const Truth truth = truths(shape("box"), shape("box"), recording)[0];
  EXPECT_TRUE(truth.proved);
  EXPECT_NEAR(truth.low, -0.002, 1e-15);
  EXPECT_NEAR(truth.error_of(-0.08), 0.078, 1e-12);
}

TEST(Motion, StaysInItsRegimeAtHandSpeed) {
  const Shape& a = shape("box");
  const Shape& b = shape("sphere42");
  for (const Regime& regime : regimes()) {
    const Recording recording = record(a, b, regime, 300, 5);
    ASSERT_EQ(recording.poses.size(), 300u);
    for (std::size_t i = 0; i < recording.poses.size(); ++i) {
      if (i % 50 != 0) continue;
      const double gap =
          static_cast<double>(oracle::signed_distance(a.polytope, b.polytope, recording.poses[i]));
      EXPECT_GE(gap, regime.least_m) << regime.name << ", frame " << i;
      EXPECT_LE(gap, regime.most_m) << regime.name << ", frame " << i;
    }
    if (regime.cold) continue;
    for (std::size_t i = 1; i < recording.poses.size(); ++i) {
      const Pose& before = recording.poses[i - 1];
      const Pose& now = recording.poses[i];
      const double turned = Eigen::AngleAxisd(before.R.transpose() * now.R).angle();
      EXPECT_GT(turned, 0.9e-3);
      EXPECT_LT(turned, 3.1e-3);
      // Motion off the surface is undone to keep the gap.
      EXPECT_LT((now.p - before.p).norm(), 2e-3) << regime.name << ", frame " << i;
    }
  }
}

TEST(Motion, IsTheSameWheneverItIsRecorded) {
  const Recording one = record(shape("box"), shape("plate"), regimes()[1], 100, 9);
  const Recording two = record(shape("box"), shape("plate"), regimes()[1], 100, 9);
  for (std::size_t i = 0; i < one.poses.size(); ++i) {
    EXPECT_EQ(one.poses[i].R, two.poses[i].R);
    EXPECT_EQ(one.poses[i].p, two.poses[i].p);
  }
}

/// Gives the answer that it was given.
class Parrot final : public Engine {
 public:
  explicit Parrot(Answer answer) : answer_(answer) {}
  bool hold(const Shape&, const Shape&) override { return true; }
  void forget() override {}
  void place(const Recording&, std::size_t) override {}
  void query() override {}
  Answer answer() const override { return answer_; }

 private:
  Answer answer_;
};

TEST(Readings, TellBetweenTheClocksSteps) {
  constexpr double kStep = 10.0;
  constexpr double kCost = 33.4;
  Readings readings(kStep);
  for (int i = 0; i < 1000; ++i) {
    const double begin = 7.37 * i;
    const double late = i % 3 == 0 ? 40.0 + i : 0.0;  // disturbed
    readings.add(kStep * (std::floor((begin + kCost + late) / kStep) - std::floor(begin / kStep)));
  }
  EXPECT_NEAR(readings.ns(), kCost, 0.2);
}

TEST(Readings, OfAFineClockAreTheFastest) {
  Readings readings(0.4);
  for (const double ns : {41.0, 35.2, 38.0, 30.4, 33.3}) readings.add(ns);
  EXPECT_DOUBLE_EQ(readings.ns(), 30.4);
}

TEST(Meter, CountsWhatIsMissedAndHowFarOffTheRestIs) {
  const Recording recording = two_boxes(0.001);
  const std::vector<Truth> truth = truths(shape("box"), shape("box"), recording);
  Meter meter(1, [] { return true; });
  const auto row = [&](Answer answer) {
    Parrot parrot(answer);
    return meter.measure(parrot, recording, truth, false, 0.01);
  };
  EXPECT_TRUE(row({true, 0.001, 3}).accurate());
  EXPECT_EQ(row({true, 0.001, 3}).steps_max, 3);
  EXPECT_NEAR(row({true, 0.00105, 0}).max_error_m, 5e-5, 1e-12);
  EXPECT_FALSE(row({true, 0.00105, 0}).accurate());
  EXPECT_EQ(row({false, 0.001, 0}).missed, 1);
  EXPECT_EQ(row({true, -0.001, 0}).missed, 1);  // contact where there is none
  EXPECT_EQ(row({true, std::nan(""), 0}).missed, 1);
}

/// Counts how often each pose is queried.
class Counter final : public Engine {
 public:
  bool hold(const Shape&, const Shape&) override { return true; }
  void forget() override {}
  void place(const Recording& recording, std::size_t pose) override {
    asked.resize(recording.poses.size());
    pose_ = pose;
  }
  void query() override { ++asked[pose_]; }
  Answer answer() const override { return {true, 0.001, 0}; }
  std::vector<int> asked;

 private:
  std::size_t pose_ = 0;
};

TEST(Meter, ReplaysUntilEveryPoseHasHadACoreOfItsOwn) {
  constexpr int kReplays = 3;
  constexpr int kBesides = 1 + kReplays;  // for the answer, and in batches
  Recording recording = two_boxes(0.001);
  recording.poses.resize(70, recording.poses.front());
  const std::vector<Truth> truth(recording.poses.size(), Truth{0.001, 0.001, true});
  const auto asked = [&](const std::function<bool()>& core_is_ours, Row& row) {
    Meter meter(kReplays, core_is_ours);
    Counter counter;
    row = meter.measure(counter, recording, truth, false, 10.0);
    EXPECT_TRUE(std::isfinite(row.max_ns));
    // The first is also the start from nothing of every replay.
    EXPECT_EQ(std::count(counter.asked.begin() + 1, counter.asked.end(), counter.asked[1]), 69);
    return counter.asked[1];
  };
  Row row;
  EXPECT_EQ(asked([] { return true; }, row), kReplays + kBesides);
  EXPECT_EQ(row.shared_core, 0.0);
  EXPECT_EQ(asked([] { return false; }, row), Meter::kPatience * kReplays + kBesides);
  EXPECT_EQ(row.shared_core, 1.0);
  int looks = 0;
  const int now_and_then = asked([&] { return ++looks % 5 != 0; }, row);
  EXPECT_GT(now_and_then, kReplays + kBesides);
  EXPECT_LT(now_and_then, Meter::kPatience * kReplays / 2);
  EXPECT_EQ(row.shared_core, 0.0);
}

}  // namespace
}  // namespace tactum::bench::referee_test
