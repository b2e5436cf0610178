#include "tactum/devices/number_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace tactum::number_table_test {
namespace {

Result<NumberTable> table_of(const std::string& text, const std::vector<std::string>& names = {}) {
  const std::string path = ::testing::TempDir() + "tactum_" +
                           ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  std::ofstream(path, std::ios::binary) << text;
  Result<NumberTable> table = read_number_table(path, names);
  std::filesystem::remove(path);
  return table;
}

void expect_table(const std::string& text) {
  const Result<NumberTable> table = table_of(text);
  ASSERT_TRUE(table) << table.error().message();
  EXPECT_EQ(table->columns, (std::vector<std::string>{"t", "x", "y"})) << text;
  EXPECT_EQ(table->values, (std::vector<double>{0, 0.5, -250, 1, 2, 3})) << text;
}

void expect_refused(const std::string& text, const std::vector<std::string>& words) {
  const Result<NumberTable> table = table_of(text);
  ASSERT_FALSE(table) << text;
  for (const std::string& word : words)
    EXPECT_NE(table.error().message().find(word), std::string::npos) << word << "\n"
                                                                     << table.error().message();
  EXPECT_EQ(table.error().message().find("expected 0"), std::string::npos) << table.error().message();
}

TEST(NumberTable, EverySeparatorGivesTheSameTable) {
  expect_table("t,x,y\n0,0.5,-2.5e2\n1,2,3\n");
  expect_table("t;x;y\n0;0.5;-2.5e2\n1;2;3\n");
  expect_table("t;x;y\r\n0 ; 0.5 ; -2.5e2\r\n\r\n# a comment, with; both\r\n1;2;3");
  expect_table("t\tx\ty\n0\t0.5\t-2.5e2\n1\t2\t3\n");
  expect_table("t x  y\n0 0.5\t-2.5e2\n  1 2 3\n");
  expect_table("sep=;\r\nt;x;y\r\n0;0,5;-250\r\n1;2;3\r\n");
  expect_table("\"t\";\"x\";\"y\"\n0;0.5;\"-250\"\n1;2;3\n");
}

TEST(NumberTable, ADecimalCommaIsReadWhereNoCommaSeparates) {
  expect_table("t;x;y\n0;0,5;-2,5e2\n1;2,0;3,000\n");
  expect_table("t\tx\ty\n0\t0,5\t-250\n1\t2\t3\n");
  expect_table("t x y\n0 0,5 -250\n1 2 3\n");
}

TEST(NumberTable, ADecimalMarkThatIsNotClearIsRefusedWithTheSeparator) {
  expect_refused("t;x;y\n0;0,5;1\n1;0.5;3\n", {":3: column x", "decimal mark", "semicolons", "'0.5'"});
  expect_refused("t;x;y\n0;1.234,5;1\n", {":2: column x", "semicolons", "'1.234,5'"});
  expect_refused("t\tx\ty\n0\t1,234,567\t1\n", {":2: column x", "tabs", "'1,234,567'"});
}

TEST(NumberTable, MarksAndLineEndsOfEverySystem) {
  for (const std::string mark : {"", "\xEF\xBB\xBF"}) {
    expect_table(mark + "t,x,y\n0,0.5,-250\n1,2,3\n");
    expect_table(mark + "t,x,y\r\n0,0.5,-250\r\n1,2,3\r\n");
    expect_table(mark + "t;x;y\r0;0,5;-250\r1;2;3");
  }
  expect_refused(std::string("\xFF\xFEt\0,\0x\0\n\0", 10), {"UTF-16", "UTF-8"});
  expect_refused(std::string("t\0,\0x\0\n\0", 8), {"UTF-16"});
}

TEST(NumberTable, WrongColumnsAndMissingHeadersAreTold) {
  expect_refused("t,x,y\n0;1;2\n", {":2: wrong number of columns: found 1, expected 3 separated by commas"});
  expect_refused("t;x;y\n0,1,2\n",
                 {":2: wrong number of columns: found 1, expected 3 separated by semicolons"});
  expect_refused("t;x;y\n0;1\n", {":2: wrong number of columns: found 2, expected 3"});
  for (const char* text : {"0,1,2\n", "0;1;2\n", "0\t1\t2\n", "0 1 2\n", "0,5;1,5;2\n", "7\n"})
    expect_refused(text, {":1: the table has no header", "names of the columns"});
}

TEST(NumberTable, NumbersBetweenBlanksAreNamedByTheCaller) {
  for (const char* text : {"0 0.5 -250\n1 2 3\n", "0\t0.5\t-250\n1\t2\t3\n", "0 \t0.5 -250\n1 2 3"}) {
    const Result<NumberTable> table = table_of(text, {"t", "x", "y"});
    ASSERT_TRUE(table) << table.error().message();
    EXPECT_EQ(table->values, (std::vector<double>{0, 0.5, -250, 1, 2, 3}));
  }
}

}  // namespace
}  // namespace tactum::number_table_test
