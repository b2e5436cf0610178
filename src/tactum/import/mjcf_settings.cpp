#include "tactum/import/mjcf_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

namespace tactum::inline v0_1 {
namespace {

constexpr int kMostDeep = 500;      // elements in each other, as in one file
constexpr int kMostIncluded = 200;  // files, so that one that includes itself twice ends soon

/// One letter of an Euler sequence.
Mat3 turn(char letter, double angle_rad) {
  const int axis = std::tolower(static_cast<unsigned char>(letter)) - 'x';
  return Eigen::AngleAxisd(angle_rad, Vec3::Unit(axis)).toRotationMatrix();
}

/// Small letters turn about the axes as they have turned, capital ones about those that stand.
Mat3 euler_rotation(const std::vector<double>& angles, const MjcfCompiler& compiler) {
  Mat3 R = Mat3::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    const char letter = compiler.euler_sequence[i];
    const Mat3 next = turn(letter, angles[i] * compiler.radians_per_unit);
    R = std::islower(static_cast<unsigned char>(letter)) ? Mat3(R * next) : Mat3(next * R);
  }
  return R;
}

Mat3 axes_rotation(const Attributes& of, const std::vector<double>& numbers) {
  const Vec3 x(numbers[0], numbers[1], numbers[2]), y(numbers[3], numbers[4], numbers[5]);
  const Vec3 z = x.cross(y);
  if (!(z.norm() > 0.0)) {
    of.fail("xyaxes", "two axes on one line", "", "axes of two directions");
    return Mat3::Identity();
  }
  Mat3 R;
  R.col(0) = x.normalized();
  R.col(2) = z.normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

/// By the spelling that the element has.
Mat3 spelled_rotation(const Attributes& of, const MjcfCompiler& compiler) {
  if (of.has("euler")) return euler_rotation(of.numbers("euler", 3, 3), compiler);
  if (of.has("xyaxes")) return axes_rotation(of, of.numbers("xyaxes", 6, 6));
  const bool turns = of.has("axisangle");
  const std::vector<double> n = of.numbers(turns ? "axisangle" : "zaxis", turns ? 4 : 3, turns ? 4 : 3);
  const Vec3 direction(n[0], n[1], n[2]);
  const double length = direction.norm();
  if (!(length > 0.0 && std::isfinite(length))) {
    of.fail(turns ? "axisangle" : "zaxis", "an orientation of length 0", "", "numbers that are not all 0");
    return Mat3::Identity();
  }
  if (!turns) return rotation_to(direction);
  return Eigen::AngleAxisd(n[3] * compiler.radians_per_unit, direction / length).toRotationMatrix();
}

/// `depth` is that of the element; `files` counts the included ones.
void include_into(XmlElement& element, const std::string& folder, int depth, int& files, ImportLog& log) {
  if (depth > kMostDeep)
    return log.fail(element, "included elements stand too deep in each other", fmt::format("{} deep", depth),
                    fmt::format("at most {}", kMostDeep));
  for (std::size_t i = 0; i < element.children.size() && !log.errors();) {
    if (element.children[i].name != "include") {
      include_into(element.children[i++], folder, depth + 1, files, log);
      continue;
    }
    const XmlElement include = element.children[i];
    const std::string path = (std::filesystem::path(folder) / Attributes(log, include).text("file")).string();
    if (++files > kMostIncluded)
      return log.fail(include, "too many included files", fmt::format("{}", files),
                      "a file that does not include itself");
    Result<XmlElement> included = read_xml_file(path);
    if (!included)
      return log.fail(include, "the included file cannot be read", included.error().message(), "");
    const auto place = element.children.erase(element.children.begin() + static_cast<std::ptrdiff_t>(i));
    element.children.insert(place, included->children.begin(), included->children.end());
  }
}

}  // namespace

Mat3 rotation_to(const Vec3& z) { return Quat::FromTwoVectors(Vec3::UnitZ(), z).toRotationMatrix(); }

MjcfCompiler read_compiler(const XmlElement& mujoco, ImportLog& log) {
  MjcfCompiler compiler;
  for (const XmlElement* element : mujoco.all("compiler")) {
    const Attributes of(log, *element);
    if (of.has("angle"))
      compiler.radians_per_unit = of.word("angle", 0, {"degree", "radian"}) == 1 ? 1.0 : kPi / 180.0;
    if (of.word("coordinate", 0, {"local", "global"}) == 1)
      of.fail("coordinate", "poses in the axes of the world", "\"global\"", "\"local\"");
    compiler.euler_sequence = of.text("eulerseq", compiler.euler_sequence);
    if (compiler.euler_sequence.size() != 3 ||
        compiler.euler_sequence.find_first_not_of("xyzXYZ") != std::string::npos) {
      of.fail("eulerseq", "no sequence of axes", fmt::format("\"{}\"", compiler.euler_sequence),
              "three of xyzXYZ");
      compiler.euler_sequence = "xyz";
    }
    compiler.mesh_folder = of.text("meshdir", of.text("assetdir", compiler.mesh_folder));
    compiler.strips_paths = of.flag("strippath", compiler.strips_paths);
    compiler.limits_by_range = of.flag("autolimits", compiler.limits_by_range);
    MassRules& masses = compiler.masses;
    using FromShapes = MassRules::FromShapes;
    if (of.has("inertiafromgeom"))
      masses.from_shapes = static_cast<FromShapes>(of.word("inertiafromgeom", 2, {"false", "true", "auto"}));
    masses.least_mass_kg = of.number("boundmass", masses.least_mass_kg, kNotNegative);
    masses.least_inertia_kg_m2 = of.number("boundinertia", masses.least_inertia_kg_m2, kNotNegative);
    masses.balance = of.flag("balanceinertia", masses.balance);
    if (of.number("settotalmass", -1.0) > 0.0) masses.total_mass_kg = of.number("settotalmass", 0.0);
    const std::vector<double> groups = of.numbers("inertiagrouprange", 2, 2);
    if (!groups.empty()) {
      compiler.least_group = static_cast<int>(std::clamp(groups[0], 0.0, 5.0));
      compiler.most_group = static_cast<int>(std::clamp(groups[1], 0.0, 5.0));
    }
  }
  return compiler;
}

void MjcfDefaults::add(const XmlElement& element, const std::string& parent, ImportLog& log) {
  const Attributes of(log, element);
  const std::string name = of.text("class", parent.empty() ? "main" : "");
  if (name.empty()) log.fail(element, "a <default> in another one without a class", "", "class=\"NAME\"");
  Class& added = classes_[name];
  added.parent = parent;
  for (const XmlElement& child : element.children) {
    if (child.name == "default") {
      child.read = true;
      if (name == Attributes(log, child).text("class"))
        return log.fail(child, "a class in itself", fmt::format("\"{}\"", name), "a name of its own");
      add(child, name, log);
      continue;
    }
    if (child.name == "geom" || child.name == "joint" || child.name == "mesh") child.read = true;
    classes_[name].elements.push_back(&child);
  }
}

MjcfDefaults::MjcfDefaults(const XmlElement& mujoco, ImportLog& log) {
  for (const XmlElement* element : mujoco.all("default")) add(*element, "", log);
}

Attributes MjcfDefaults::of(const XmlElement& element, const std::string& childclass, ImportLog& log) const {
  const XmlAttribute* own = element.find("class");
  std::string name = own != nullptr ? own->value : childclass;
  if (name.empty()) name = "main";
  if (own != nullptr && !classes_.contains(name)) {
    std::vector<std::string> names;
    for (const auto& [known, unused] : classes_) names.push_back(known);
    log.fail(element, *own, "no class of this name", fmt::format("\"{}\"", name), one_of_meant(name, names));
  }
  std::vector<const XmlElement*> layers;
  for (std::size_t steps = 0; classes_.contains(name) && steps <= classes_.size(); ++steps) {
    const Class& found = classes_.at(name);
    for (auto layer = found.elements.rbegin(); layer != found.elements.rend(); ++layer)
      if ((*layer)->name == element.name) layers.push_back(*layer);
    name = found.parent;
  }
  return {log, element, layers};
}

void include_files(XmlElement& mujoco, const std::string& folder, ImportLog& log) {
  int files = 0;
  include_into(mujoco, folder, 0, files, log);
}

Mat3 rotation_of(const Attributes& attributes, const MjcfCompiler& compiler) {
  // As in MuJoCo a quaternion counts where no layer, not even a class of defaults, has another spelling.
  const XmlElement* chosen = nullptr;
  for (const XmlElement* layer : attributes.layers()) {
    int spellings = 0;
    for (const char* name : {"axisangle", "euler", "xyaxes", "zaxis"})
      spellings += layer->find(name) != nullptr ? 1 : 0;
    if (spellings > 1)
      attributes.log().fail(*layer, "several orientations in one element", "", "one of them");
    if (spellings > 0 && chosen == nullptr) chosen = layer;
  }
  if (chosen != nullptr) {
    attributes.has("quat");  // overruled
    return spelled_rotation(Attributes(attributes.log(), *chosen), compiler);
  }
  const std::vector<double> q = attributes.numbers("quat", 4, 4);
  if (q.empty()) return Mat3::Identity();
  const Quat quat(q[0], q[1], q[2], q[3]);
  if (quat.norm() > 0.0 && std::isfinite(quat.norm())) return quat.normalized().toRotationMatrix();
  attributes.fail("quat", "an orientation of length 0", "", "numbers that are not all 0");
  return Mat3::Identity();
}

}  // namespace tactum::inline v0_1
