/// docs/scene-format.md is written by hand; here it is compared with the keys that the reader knows.

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "app/program.h"
#include "tactum/scene/item_visitor.h"

namespace tactum::scene_format_test {
namespace {

/// Takes every key of every table, and every word that a key may have.
class EveryKey final : public ItemVisitor {
 public:
  using ItemVisitor::angle;
  using ItemVisitor::number;
  using ItemVisitor::table;
  using ItemVisitor::vector;

  std::set<std::string> keys, words;

  void number(const char* key, double&, Range, Need) override { keys.insert(key); }
  void angle(const char* key, double&, Range, Need) override { keys.insert(key); }
  void integer(const char* key, int&, int, int, Need) override { keys.insert(key); }
  void flag(const char* key, bool&) override { keys.insert(key); }
  void text(const char* key, std::string&, Need) override { keys.insert(key); }
  void vector(const char* key, Vec3&, Need) override { keys.insert(key); }
  void interval(const char* key, Interval&, double) override { keys.insert(key); }
  void rotation(Mat3&) override { keys.insert({"quat_wxyz", "rpy_deg"}); }
  void setting(const SettingInfo&, FrameSettings&, SafetySettings&) override {}  // a page of their own
  int word(const char* key, int index, const WordList& choices, Need) override {
    keys.insert(key);
    words.insert(choices.begin(), choices.end());
    return index;
  }
  bool present(const char*, bool) override { return true; }
  void table(const char* key, const KeyList&, const Visit& visit) override {
    keys.insert(key);
    visit(*this);
  }
  bool several(const char*, bool) override { return false; }
  std::size_t size(const char* key, std::size_t) override {
    keys.insert(key);
    return 1;
  }
  void element(const char*, std::size_t, const KeyList&, const Visit& visit) override { visit(*this); }
  int marked(const std::vector<KeyList>&, const WordList&, int index, const Error&) override { return index; }
  bool visits_all() const override { return true; }
  void only(const Alternatives&, int) override {}
  void fail(const char*, std::string, std::string, std::string) override {}
  std::string section() const override { return {}; }
};

TEST(SceneFormat, ThePageNamesEveryKeyAndWord) {
  const std::string page = testing::content("docs/scene-format.md");
  EveryKey every;
  SceneDescription scene;
  visit_items(every, scene);
  EXPECT_GT(every.keys.size(), 100u);
  for (const std::string& key : every.keys)
    EXPECT_TRUE(std::regex_search(page, std::regex("\\b" + key + "\\b"))) << key;
  for (const std::string& word : every.words)
    EXPECT_NE(page.find('"' + word + '"'), std::string::npos) << word;
}

}  // namespace
}  // namespace tactum::scene_format_test
