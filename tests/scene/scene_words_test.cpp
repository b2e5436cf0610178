// What is said of a scene file where something else was meant: words of other formats, slips of TOML.

#include <gtest/gtest.h>

#include "tactum/scene/scene_file.h"

namespace tactum::scene_words_test {
namespace {

// Lines 5 to 9 are the block's.
std::string scene_with(const std::string& block, const std::string& rest = "") {
  return "schema = 1\n[[body]]\nname = \"plate\"\npart = { box = { size_m = [1, 1, 0.1] } }\n" + block +
         "\n[tool]\nbody = \"block\"\n" + rest;
}

std::string block(const std::string& lines, const std::string& part = "{ box = { size_m = [1, 1, 1] } }") {
  return "[[body]]\nname = \"block\"\npos_m = [0, 0, 2]\npart = " + part + "\n" + lines;
}

std::string error_of(const std::string& text) {
  const Result<Scene> scene = parse_scene(text, "test", "test.toml", {});
  return scene ? "no error" : scene.error().message();
}

void expect(const std::string& text, const std::string& place, const std::string& said) {
  const std::string error = error_of(text);
  EXPECT_EQ(error.substr(0, place.size() + 2), place + ": ") << error << "\n" << text;
  EXPECT_NE(error.find(said), std::string::npos) << error << "\n  lacks: " << said << "\n" << text;
}

TEST(SceneWords, JointKindsOfOtherFormatsNameOurs) {
  struct Case {
    const char *word, *ours;
  };
  for (const Case& c : {Case{"revolute", "hinge"},
                        {"continuous", "hinge"},
                        {"Hinge", "hinge"},
                        {"hinged", "hinge"},
                        {"prismatic", "slider"},
                        {"sliding", "slider"},
                        {"spherical", "ball"},
                        {"sphere", "ball"},
                        {"static", "fixed"},
                        {"weld", "fixed"},
                        {"floating", "free"}})
    expect(scene_with(block(std::string("joint = { kind = \"") + c.word + "\", axis = [0, 0, 1] }")),
           "test.toml:9:18", std::string("expected \"") + c.ours + "\" (of \"free\"");
}

TEST(SceneWords, ShapesGraspsAndKeysNameOurs) {
  expect(scene_with(block("", "{ pill = { radius_m = 1 } }")), "test.toml:8:10", "expected \"capsule\"");
  expect(scene_with(block("", "{ cuboid = { size_m = [1, 1, 1] } }")), "test.toml:8:10", "expected \"box\"");
  expect(scene_with(block("", "{ cylindre = { radius_m = 1 } }")), "test.toml:8:10", "expected \"cylinder\"");
  expect(scene_with(block("", "{ filename = \"a.stl\" }")), "test.toml:8:10", "expected \"mesh\"");
  expect(scene_with(block(""), "grasp = \"center\"\n"), "test.toml:12:9", "expected \"centre\" (of");
  expect(scene_with(block("geometry = 1")), "test.toml:9:1", "expected \"part\"");
  expect(scene_with(block("xyz = [0, 0, 0]")), "test.toml:9:1", "expected \"pos_m\"");
  expect(scene_with(block("joint = { type = \"hinge\" }")), "test.toml:9:11", "expected \"kind\"");
  expect(scene_with(block(""), "[hand]\ngrip = \"fimr\"\n"), "test.toml:13:8", "'firm'");
}

TEST(SceneWords, DevicesHaveOneSpelling) {
  for (const char* name : {"touch", "simulated:touch"}) {
    const Result<Scene> scene = parse_scene(
        "device = \"" + std::string(name) + "\"\n" + scene_with(block("")), "test", "test.toml", {});
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_EQ(scene->device, "touch");
  }
  expect("device = \"simulated:tuch\"\n" + scene_with(block("")), "test.toml:1:10", "'touch'");
}

TEST(SceneWords, ATextWithoutItsQuote) {
  const std::string part = "part = { box = { size_m = [1, 1, 1] } }\n";
  expect("schema = 1\n[[body]]\nname = \"block\n" + part, "test.toml:3:14",
         "no closing quote: found \"block");
  expect("schema = 1\n[[body]]\nname = 'block\n" + part, "test.toml:3:14", "no closing quote: found 'block");
  expect("schema = 1\n[[body]]\nname = block\"\n" + part, "test.toml:3:8", "no opening quote");
  expect("schema = 1\n[[body]]\nname = block\n" + part, "test.toml:3:8", "stands in quotes: found block");
  expect("schema = 1\n[[body]]\nname = \u201cblock\u201d\n" + part, "test.toml:3:8", "typographic quotes");
  expect("schema = 1\n[[body]]\nname = \"a\"\npart = { mesh = \"a.stl }\n", "test.toml:4:25",
         "no closing quote: found \"a.stl }");
}

TEST(SceneWords, HeadingsWithTheWrongBrackets) {
  const std::string body = "name = \"a\"\npart = { box = { size_m = [1, 1, 1] } }\n";
  const std::string two = "expected [[body]] with two brackets, for each body";
  expect("schema = 1\n[[body]]\n" + body + "[body]\n" + body, "test.toml:5:1", two);
  expect("schema = 1\n[body]\n" + body + "[body]\n" + body, "test.toml:5:1", two);
  expect("schema = 1\n[body]\n" + body, "test.toml:2:1", "[[body]] with two brackets");
  expect("schema = 1\n[[body]\n" + body, "test.toml:2:8", "expected [[body]]");
  expect("schema = 1\n[[body]]\n" + body + "[hand.step]\nhold_s = 1\n", "test.toml:5:1",
         "[[hand.step]] with two brackets");
  expect("schema = 1\n[[body]]\n" + body + "[[coupling]]\nstiffness_N_per_m = 400\n", "test.toml:5:1",
         "a table, [coupling] with one bracket");
  expect("schema = 1\n[[body]]\n" + body + "[tool]\nbody = \"a\"\n[tool]\ngrasp = \"centre\"\n",
         "test.toml:7:1", "[tool] is there twice");
}

TEST(SceneWords, OtherFormatsAreNamed) {
  expect("{\n  \"schema\": 1\n}\n", "test.toml:1:1", "this is JSON");
  expect("\n\n  {\"schema\": 1}\n", "test.toml:3:3", "this is JSON");
  expect("---\nschema: 1\n", "test.toml:1:4", "this is YAML");
  expect("<robot name=\"a\">\n", "test.toml:1:1", "this is XML");
  expect("schema: 1\nbody:\n  - name: a\n", "test.toml:1:7",
         "as YAML and JSON have it: found \"schema:\", expected schema =");
  expect("schema = 1\n\"name\": 2\n", "test.toml:2:7", "expected name = ...");
  expect(std::string("\xff\xfe") + "s", "test.toml:1:1", "no plain text");
}

TEST(SceneWords, ListsCommasAndNumbers) {
  const auto with = [](const std::string& line) {
    return "schema = 1\n[[body]]\n" + line + "\nname = \"a\"\n";
  };
  expect(with("pos_m = [0 0 1]"), "test.toml:3:12", "a comma is missing");
  expect(with("pos_m = [0, 0, 1"), "test.toml:4:1", "a [ has no closing ]: found pos_m = [0, 0, 1");
  expect(with("part = { box = { size_m = [1, 1, 1] }"), "test.toml:3:38", "a { has no closing }");
  expect(with("pos_m = 0, 0, 1"), "test.toml:3:10", "expected [0, 0, 1]");
  expect(with("mass_kg = 1,"), "test.toml:3:12", "a comma at the end of a line");
  expect(with("joint = { kind = \"fixed\", }"), "test.toml:3:27", "a comma before }");
  expect(with("mass_kg = 5 kg"), "test.toml:3:13", "units stand in the names of keys");
  expect(with("mass_kg = .5"), "test.toml:3:11", "digits on both sides of its point");
  expect(with("mass_kg ="), "test.toml:3:10", "a key has no value");
  expect(with("mass_kg 5"), "test.toml:3:9", "a key without =");
  expect(with("// a comment"), "test.toml:3:1", "a comment begins with #");
  expect(with("joint = { kind = \"hinge\", axis = [0, 0, 1] }}"), "test.toml:3:45", "bracket too many");
  expect(with("x = True"), "test.toml:3:5", "expected true");
  expect("schema = 1\nschema = 1\n", "test.toml:2:10", "\"schema\" is there twice");
}

TEST(SceneWords, TabsAreSpaces) {
  EXPECT_EQ(
      error_of(
          "schema\t=\t1\r\n[[body]]\n\tname = \"a\"\t# a tab\n\tpart = { box = { size_m = [1,\t1, 1] } }\n"),
      "no error");
}

TEST(SceneWords, ANewerSchemaIsToldBeforeItsKeys) {
  for (const char* number : {"2", "17"})
    expect(std::string("schema = ") + number + "\nbodies = 1\n", "test.toml:1:10",
           std::string("schema ") + number + " is newer than this program (1)");
  expect("bodies = 1\nschema = 1\n", "test.toml:1:1", "expected \"body\"");
}

TEST(SceneWords, OnMustNameABodyBefore) {
  const auto body = [](const std::string& name, const std::string& on) {
    return "[[body]]\nname = \"" + name + "\"\npart = { box = { size_m = [1, 1, 1] } }\n" +
           (on.empty() ? "" : "on = \"" + on + "\"\n");
  };
  const std::string rule = "`on` must name a body before this one: found ";
  expect("schema = 1\n" + body("a", "a"), "test.toml:5:6", rule + "\"a\", the body itself");
  expect("schema = 1\n" + body("a", "b") + body("b", "a"), "test.toml:5:6",
         rule + "a circle, \"a\" on \"b\" on \"a\"");
  expect("schema = 1\n" + body("a", "b") + body("b", "c") + body("c", "a"), "test.toml:5:6",
         rule + "a circle, \"a\" on \"b\" on \"c\" on \"a\"");
  expect("schema = 1\n" + body("a", "b") + body("b", ""), "test.toml:5:6",
         rule + "\"b\", which comes behind it");
  expect("schema = 1\n" + body("a", "b") + body("b", "b"), "test.toml:5:6",
         rule + "\"b\", which comes behind it");
  expect("schema = 1\n" + body("ab", "") + body("b", "ac"), "test.toml:8:6", "expected \"ab\"");
  const std::string key =
      "schema = 1\n[[body]]\nname = \"a\"\n[[body.component]]\nname = \"bow\"\non = \"bow\"\n"
      "part = { box = { size_m = [1, 1, 1] } }\n";
  expect(key, "test.toml:6:6", "`on` must name a component before this one");
}

}  // namespace
}  // namespace tactum::scene_words_test
