/// The list of the report's fields, and everything made from it.
#include "tactum/haptics/report_fields.h"
#include "tactum/haptics/frame_hash.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "support/generated_page.h"
#include "tactum/telemetry/channels.h"
#include "tactum/telemetry/run_record.h"

namespace tactum {
namespace {

std::uint64_t hash_of(const FrameReport& report) {
  FrameHash hash;
  add_to(hash, report);
  return hash.value();
}

void change(bool& value) { value = !value; }
void change(double& value) { value += 0.5; }
void change(int& value) { ++value; }
void change(std::uint32_t& value) { ++value; }
void change(std::uint64_t& value) { ++value; }
void change(Vec3& v, int i) { v[i] += 0.5; }

/// Every number of the value, changed in turn, changes the hash.
template <class Value>
void expect_every_number_counts(Value& value, const FrameReport& report, const char* name) {
  const std::uint64_t before = hash_of(report);
  const Value kept = value;
  const auto expect_changed = [&] {
    EXPECT_NE(hash_of(report), before) << name;
    value = kept;
  };
  if constexpr (std::is_same_v<Value, Pose>) {
    for (int i = 0; i < 3; ++i) {
      change(value.p, i);
      expect_changed();
      for (int k = 0; k < 3; ++k) {
        value.R(i, k) += 0.5;
        expect_changed();
      }
    }
  } else if constexpr (std::is_same_v<Value, Wrench>) {
    for (int i = 0; i < 3; ++i) {
      change(value.f, i);
      expect_changed();
      change(value.t, i);
      expect_changed();
    }
  } else {
    change(value);
    expect_changed();
  }
  EXPECT_EQ(hash_of(report), before);
}

TEST(ReportFields, EveryNumberIsInTheHash) {
  FrameReport report;
  for_each_report_field([&](auto field) {
    using Field = decltype(field);
    const auto& value = Field::of(report);
    expect_every_number_counts(const_cast<std::remove_cvref_t<decltype(value)>&>(value), report,
                               Field::kInfo.name);
  });
}

TEST(ReportFields, ZerosOfEitherSignAreOneInTheHash) {
  FrameReport report;
  const std::uint64_t before = hash_of(report);
  report.min_distance_m = -0.0;
  report.work.dropped_error = -0.0;
  report.shown.f.x() = -0.0;
  EXPECT_EQ(hash_of(report), before);
}

TEST(ReportFields, NoNumberIsListedTwice) {
  const FrameReport report;
  std::set<const void*> places;
  std::set<std::string> names, last_parts, channel_keys;
  for_each_report_field([&](auto field) {
    using Field = decltype(field);
    const std::string name = Field::kInfo.name;
    EXPECT_TRUE(places.insert(&Field::of(report)).second) << name;
    EXPECT_TRUE(names.insert(name).second) << name;
    if (Field::kInfo.in_run != InRun::kNothing) {  // keys of the JSON summary
      EXPECT_TRUE(last_parts.insert(name.substr(name.rfind('.') + 1)).second) << name;
    }
  });
  for (const Channel& channel : channels())
    EXPECT_TRUE(channel_keys.insert(channel.key).second) << channel.key;
}

TEST(RunRecord, SumsUpWhatTheListSays) {
  FrameReport report;
  const WorldState world;
  RunRecord record;
  for (const int count : {3, 5, 2}) {
    report.work.exact_tests = count;
    report.validation_tests = 10 * count;
    report.work.longest_unchecked = 100 * count;
    report.friction.cone_used = 0.1 * count;
    record.add(report, world);
  }
  EXPECT_EQ(record.sum("work.exact_tests"), 10u);
  EXPECT_EQ(record.largest("work.exact_tests"), 5.0);
  EXPECT_EQ(record.sum("validation_tests"), 100u);
  EXPECT_EQ(record.largest("work.longest_unchecked"), 500.0);
  EXPECT_EQ(record.sum("work.longest_unchecked"), 0u);
  EXPECT_EQ(record.largest("friction.cone_used"), 0.5);
  EXPECT_EQ(record.max_tests, 55);
}

const char* in_run(InRun kept) {
  switch (kept) {
    case InRun::kNothing:
      return "";
    case InRun::kLargest:
      return "largest";
    case InRun::kSum:
      return "sum, largest";
  }
  return "";
}

TEST(ReportFields, ThePageIsMadeFromTheList) {
  std::string page =
      "# Fields of the frame report\n\n"
      "Made from `src/tactum/haptics/report_fields.h` by a test, not by hand. Every field is in the hash of "
      "a\n"
      "frame. A run keeps the sum over its frames, or the largest value of a frame, where the fourth column "
      "says\n"
      "so; the JSON summary has them by the last part of the name, the largest value with `max_` before it. "
      "What\n"
      "has a key in the last column is a channel of the viewer's charts and exports.\n\n"
      "| field | unit | meaning | in a run | channel |\n|---|---|---|---|---|\n";
  for_each_report_field([&](auto field) {
    const FieldInfo& info = decltype(field)::kInfo;
    const std::string key =
        info.channel.key == nullptr ? std::string() : "`" + std::string(info.channel.key) + "`";
    page += "| `" + std::string(info.name) + "` | " + info.unit + " | " + info.meaning + " | " +
            in_run(info.in_run) + " | " + key + " |\n";
  });
  testing::expect_page("docs/report-fields.md", page);
}

}  // namespace
}  // namespace tactum
