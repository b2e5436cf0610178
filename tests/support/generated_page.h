#pragma once
/// Pages of the documents that are made from lists in the code, so that neither can change without the other.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

namespace tactum::testing {

/// The page is made by the code. With TACTUM_WRITE_PAGES=1 in the environment it is written anew.
inline void expect_page(const std::string& path, const std::string& text) {
  const std::string place = std::string(TACTUM_SOURCE_DIR) + "/" + path;
  if (std::getenv("TACTUM_WRITE_PAGES") != nullptr) {
    std::ofstream(place) << text;
    return;
  }
  std::ifstream file(place);
  const std::string found{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_EQ(found, text) << path << " is not what the code says; run this test with TACTUM_WRITE_PAGES=1";
}

}  // namespace tactum::testing
