#include "tactum/scene/item_errors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

/// Words of other formats (URDF, SDF, MJCF, Blender) and of everyday speech, with ours.
struct Synonym {
  std::string_view word, ours;
};
constexpr Synonym kSynonyms[] = {
    // Joints.
    {"revolute", "hinge"},
    {"continuous", "hinge"},
    {"rotational", "hinge"},
    {"rotary", "hinge"},
    {"pivot", "hinge"},
    {"prismatic", "slider"},
    {"linear", "slider"},
    {"translational", "slider"},
    {"sliding", "slider"},
    {"spherical", "ball"},
    {"sphere", "ball"},
    {"floating", "free"},
    {"dynamic", "free"},
    {"static", "fixed"},
    {"rigid", "fixed"},
    {"weld", "fixed"},
    {"kinematic", "fixed"},
    // Shapes.
    {"cube", "box"},
    {"cuboid", "box"},
    {"block", "box"},
    {"plane", "box"},
    {"plate", "box"},
    {"pill", "capsule"},
    {"cone", "cylinder"},
    {"disc", "cylinder"},
    {"tube", "cylinder"},
    {"polygon", "prism"},
    {"file", "mesh"},
    {"filename", "mesh"},
    {"path", "mesh"},
    {"stl", "mesh"},
    {"obj", "mesh"},
    {"url", "mesh"},
    {"cog", "gear"},
    {"pin", "peg"},
    {"hole", "hole_block"},
    {"screw", "bolt"},
    {"allen_key", "hex_key"},
    // Grasps.
    {"com", "centre"},
    {"middle", "centre"},
    {"edge", "rim"},
    // Keys.
    {"link", "body"},
    {"object", "body"},
    {"geom", "part"},
    {"geometry", "part"},
    {"shape", "part"},
    {"collision", "part"},
    {"visual", "part"},
    {"type", "kind"},
    {"position", "pos_m"},
    {"translation", "pos_m"},
    {"location", "pos_m"},
    {"origin", "pos_m"},
    {"xyz", "pos_m"},
    {"euler", "rpy_deg"},
    {"orientation", "rpy_deg"},
    {"rotation", "rpy_deg"},
    {"quaternion", "quat_wxyz"},
    {"weight", "mass_kg"},
    {"inertia", "inertial"},
    {"length", "height_m"},
    {"dimensions", "size_m"},
    {"extents", "size_m"},
    {"range", "limits_deg"},
    {"range", "limits_m"},
    {"anchor", "anchor_m"},
    {"mu", "coefficient"},
    {"gripper", "tool"},
    {"handle", "tool"},
    {"timestep", "dt_s"},
    {"time_step", "dt_s"},
};

}  // namespace

std::string shown(Range range) {
  if (std::isinf(range.high) && std::isinf(range.low)) return "a finite number";
  if (std::isinf(range.high))
    return fmt::format("{} {}", range.above_low ? "more than" : "at least", range.low);
  return fmt::format("{} to {}", range.low, range.high);
}

bool within(double number, Range range) {
  return std::isfinite(number) && number <= range.high &&
         (range.above_low ? number > range.low : number >= range.low);
}

std::string one_of(const std::vector<std::string>& words) {
  if (words.empty()) return "nothing";
  return fmt::format("{}\"{}\"", words.size() == 1 ? "" : "one of ", fmt::join(words, "\", \""));
}

std::string meant_word(std::string_view word, const std::vector<std::string>& known) {
  std::string lower(word);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Synonym& synonym : kSynonyms)
    if (synonym.word == lower && std::find(known.begin(), known.end(), synonym.ours) != known.end())
      return std::string(synonym.ours);
  return nearest_word(lower, known);
}

std::string one_of_meant(std::string_view word, const std::vector<std::string>& known) {
  const std::string meant = meant_word(word, known);
  if (meant.empty() || known.size() == 1) return one_of(known);
  return fmt::format("\"{}\" (of \"{}\")", meant, fmt::join(known, "\", \""));
}

std::string item_path(const std::string& table, std::string_view key) {
  return table.empty() ? std::string(key) : fmt::format("{}.{}", table, key);
}

std::string item_path(const std::string& table, std::string_view key, std::size_t index) {
  return fmt::format("{}[{}]", item_path(table, key), index);
}

std::string file_section(std::string_view path) {
  std::string title = "[";
  for (std::size_t at = 0; at < path.size(); ++at) {
    if (path[at] != '[') {
      title += path[at];
      continue;
    }
    std::size_t index = 0;
    while (path[++at] != ']') index = 10 * index + static_cast<std::size_t>(path[at] - '0');
    title += fmt::format(" {}", index + 1);
  }
  return title + "]";
}

}  // namespace tactum::inline v0_1
