#include "tactum/base/assert.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>

namespace tactum {
namespace {

void print_text(void* context) noexcept { std::fprintf(stderr, "%s\n", static_cast<const char*>(context)); }

/// Fails in turn: a hook that asserts itself must not be called for ever.
void fail_again(void*) noexcept {
  std::fputs("hook called\n", stderr);
  TACTUM_DEMAND(1 + 1 == 3);
}

class AssertDeathTest : public ::testing::Test {
 protected:
  AssertDeathTest() { testing::FLAGS_gtest_death_test_style = "threadsafe"; }
};

TEST_F(AssertDeathTest, ATrueConditionDoesNothing) {
  int evaluated = 0;
  TACTUM_DEMAND(++evaluated == 1);
  EXPECT_EQ(evaluated, 1);
}

TEST_F(AssertDeathTest, AFalseOneTellsItselfAndThePlace) {
  EXPECT_DEATH(TACTUM_DEMAND(2 + 2 == 5), "assertion failed: 2 \\+ 2 == 5 \\(.*assert_test.cpp:[0-9]+\\)");
}

TEST_F(AssertDeathTest, TheHookComesBeforeTheMessage) {
  static char text[] = "the hand is free";
  EXPECT_DEATH(
      {
        set_zero_wrench_hook(print_text, text);
        TACTUM_DEMAND(false);
      },
      "the hand is free\n(.|\n)*assertion failed");
}

TEST_F(AssertDeathTest, ARemovedHookIsNotCalled) {
  static char text[] = "the hand is free";
  EXPECT_EXIT(
      {
        set_zero_wrench_hook(print_text, text);
        set_zero_wrench_hook(nullptr, nullptr);
        TACTUM_DEMAND(false);
      },
      testing::KilledBySignal(SIGABRT), "^tactum: assertion failed");
}

TEST_F(AssertDeathTest, AHookThatFailsItselfIsCalledOnce) {
  EXPECT_DEATH(
      {
        set_zero_wrench_hook(fail_again, nullptr);
        TACTUM_DEMAND(false);
      },
      "^hook called\ntactum: assertion failed: 1 \\+ 1 == 3");
}

}  // namespace
}  // namespace tactum
