#include "tactum/base/cpu_dispatch.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace tactum {
namespace {

struct Table {
  int lanes;
};
constexpr Table kTwo{2};
constexpr Table kFour{4};

/// The processor's features as the kernel of the operating system reports them.
bool listed_in_cpuinfo(const std::string& wanted) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;)
      if (word == wanted) return true;
  }
  return false;
}

TEST(CpuDispatch, TheProcessorHasWhatTheSystemListsForIt) {
  if (!std::ifstream("/proc/cpuinfo")) GTEST_SKIP() << "this system has no /proc/cpuinfo to compare with";
  EXPECT_EQ(cpu_has_avx2(), listed_in_cpuinfo("avx2"));
}

TEST(CpuDispatch, TheWideBuildIsChosenExactlyWhereItCanRun) {
  constexpr CpuBuilds<Table> both{&kTwo, &kFour};
  EXPECT_EQ(both.usable_wide(), cpu_has_avx2() ? &kFour : nullptr);
  EXPECT_EQ(&both.best(), cpu_has_avx2() ? &kFour : &kTwo);
}

TEST(CpuDispatch, WithoutAWideBuildTheNarrowOneIsChosen) {
  constexpr CpuBuilds<Table> narrow_only{&kTwo, nullptr};
  EXPECT_EQ(narrow_only.usable_wide(), nullptr);
  EXPECT_EQ(&narrow_only.best(), &kTwo);
}

}  // namespace
}  // namespace tactum
