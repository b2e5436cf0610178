#include "tactum/base/newest.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace tactum {
namespace {

struct Two {
  long a = 0, b = 0;
};
const auto kPlain = [](Two&) {};

TEST(Newest, NothingUntilPublishedThenTheNewestOnce) {
  Newest<Two> newest(kPlain);
  EXPECT_FALSE(newest.take());
  newest.writable() = {1, 1};
  newest.publish();
  newest.writable() = {2, 2};
  newest.publish();
  ASSERT_TRUE(newest.take());
  EXPECT_EQ(newest.readable().a, 2);
  EXPECT_FALSE(newest.take());
  newest.writable() = {3, 3};
  EXPECT_EQ(newest.readable().a, 2);  // not yet published
  newest.publish();
  ASSERT_TRUE(newest.take());
  EXPECT_EQ(newest.readable().b, 3);
}

TEST(NewestThread, TheReaderNeverSeesHalfAValueNorAnOlderOne) {
  Newest<Two> newest(kPlain);
  constexpr long kLast = 200'000;
  std::thread writer([&newest] {
    for (long i = 1; i <= kLast; ++i) {
      newest.writable() = {i, -i};
      newest.publish();
    }
  });
  long last = 0;
  while (last < kLast) {
    if (!newest.take()) continue;
    ASSERT_EQ(newest.readable().a, -newest.readable().b);
    ASSERT_GT(newest.readable().a, last);
    last = newest.readable().a;
  }
  writer.join();
}

}  // namespace
}  // namespace tactum
