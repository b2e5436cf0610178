/// main() of every test program: starts in the source folder, then runs the tests.

#include <gtest/gtest.h>

#include <filesystem>

int main(int argc, char** argv) {
  std::filesystem::current_path(TACTUM_TESTS_START_IN);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
