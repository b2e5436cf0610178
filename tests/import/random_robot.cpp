#include "import/random_robot.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <vector>

#include "tactum/base/random.h"
#include "tactum/math/types.h"

namespace tactum::import_test {
namespace {

class RandomText {
 public:
  explicit RandomText(std::uint64_t seed) : products_(seed % 2 == 0), random_(seed) {}

 protected:
  bool chance(double share) { return random_.unit() < share; }
  std::string numbers(int count, double low, double high) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += fmt::format("{}{:.6g}", i == 0 ? "" : " ", random_.uniform(low, high));
    return text;
  }
  std::string attribute(const char* name, int count, double low, double high) {
    return fmt::format(" {}=\"{}\"", name, numbers(count, low, high));
  }
  /// Moments that a body can have: those of a box.
  Vec3 moments(double mass_kg) {
    const Vec3 sq(random_.uniform(0.001, 0.04), random_.uniform(0.001, 0.04), random_.uniform(0.001, 0.04));
    return mass_kg / 12.0 * Vec3(sq.y() + sq.z(), sq.x() + sq.z(), sq.x() + sq.y());
  }

  bool products_;  ///< of inertia, and what else has no axes of its own
  Random random_;
};

class RandomMjcf : RandomText {
 public:
  explicit RandomMjcf(std::uint64_t seed) : RandomText(seed) {}

  std::string text() {
    constexpr std::array kSequences{"xyz", "XYZ", "zyx", "zXy", "yzy", "ZxY"};
    radian_ = chance(0.5);
    const std::string compiler = fmt::format(
        "<compiler angle=\"{}\" eulerseq=\"{}\"{}{}/>", radian_ ? "radian" : "degree", kSequences[pick(6)],
        chance(0.2) ? " inertiafromgeom=\"true\"" : "", chance(0.2) ? " boundmass=\"0.5\"" : "");
    std::string bodies;
    const int roots = 1 + random_.index(3);
    for (int i = 0; i < roots; ++i) bodies += body(0, true);
    return fmt::format("<mujoco model=\"random\">{}{}<worldbody>{}{}</worldbody></mujoco>", compiler,
                       defaults(), chance(0.5) ? geom(true) : "", bodies);
  }

 private:
  std::size_t pick(int count) { return static_cast<std::size_t>(random_.index(count)); }
  double turn() const { return radian_ ? 1.0 : 180.0 / kPi; }

  std::string orientation() {
    switch (random_.index(6)) {
      case 0:
        return attribute("quat", 4, 0.1, 1.0);
      case 1:
        return fmt::format(" axisangle=\"{} {:.6g}\"", numbers(3, 0.1, 1.0),
                           random_.uniform(-3.0, 3.0) * turn());
      case 2:
        return attribute("euler", 3, -3.0 * turn(), 3.0 * turn());
      case 3:
        return fmt::format(" xyaxes=\"1 {} -0.5 {}\"", numbers(2, -0.4, 0.4), numbers(2, 0.5, 1.0));
      case 4:
        return attribute("zaxis", 3, -1.0, 1.0);
      default:
        return "";
    }
  }

  std::string defaults() {
    if (chance(0.4)) return "";
    return fmt::format(
        "<default><geom density=\"{0}\"/><joint damping=\"{1}\"/>"
        "<default class=\"a\"><geom size=\"{2}\"/><joint{3}/>"
        "<default class=\"b\"><geom density=\"{0}\" friction=\"0.3\"/></default></default></default>",
        100 + random_.index(2000), random_.index(3), numbers(1, 0.05, 0.1), attribute("axis", 3, 0.1, 1.0));
  }

  std::string geom(bool touches) {
    constexpr std::array kTypes{"sphere", "capsule", "ellipsoid", "cylinder", "box"};
    const std::size_t type = pick(5);
    std::string text = fmt::format("<geom type=\"{}\" size=\"{}\"", kTypes[type], numbers(3, 0.02, 0.1));
    if (type > 0 && chance(0.3))
      text += fmt::format(" fromto=\"{} {}\"", numbers(3, -0.2, 0.0), numbers(3, 0.05, 0.2));
    else
      text += orientation() + (chance(0.7) ? attribute("pos", 3, -0.2, 0.2) : "");
    if (chance(0.3)) text += attribute(chance(0.5) ? "mass" : "density", 1, 0.1, 5.0);
    if (!touches && chance(0.3)) text += " contype=\"0\" conaffinity=\"0\"";
    return text + "/>";
  }

  std::string inertial() {
    const double mass = random_.uniform(0.1, 5.0);
    const Vec3 I = moments(mass);
    std::string text = fmt::format("<inertial mass=\"{:.9g}\"{}", mass, attribute("pos", 3, -0.2, 0.2));
    if (products_ && chance(0.3)) {
      const double off = 0.1 * I.minCoeff();
      return text + fmt::format(" fullinertia=\"{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\"/>", I.x(), I.y(),
                                I.z(), off, -0.5 * off, 0.2 * off);
    }
    return text + orientation() + fmt::format(" diaginertia=\"{:.9g} {:.9g} {:.9g}\"/>", I.x(), I.y(), I.z());
  }

  std::string joint() {
    constexpr std::array kTypes{"hinge", "slide", "ball"};
    const std::size_t type = pick(3);
    std::string text = fmt::format("<joint type=\"{}\"{}", kTypes[type], attribute("pos", 3, -0.1, 0.1));
    if (chance(0.5)) text += attribute("damping", 1, 0.0, 2.0);
    const double unit = type == 1 ? 0.1 : turn();
    if (type == 2) {
      if (chance(0.4))
        text += fmt::format(" limited=\"true\" range=\"0 {:.6g}\"", random_.uniform(0.1, 3.0) * unit);
      return text + "/>";
    }
    text += attribute("axis", 3, -1.0, 1.0);
    if (chance(0.4))
      text += fmt::format(" limited=\"true\" range=\"{:.6g} {:.6g}\"", random_.uniform(-1.0, 0.3) * unit,
                          random_.uniform(0.31, 1.0) * unit);
    if (chance(0.3)) text += fmt::format(" ref=\"{:.6g}\"", random_.uniform(-0.5, 0.5) * unit);
    if (chance(0.3))
      text += fmt::format(" stiffness=\"3\" springref=\"{:.6g}\"", random_.uniform(-0.5, 0.5) * unit);
    if (chance(0.3)) text += attribute("frictionloss", 1, 0.0, 2.0);
    return text + "/>";
  }

  std::string body(int depth, bool root) {
    std::string text =
        fmt::format("<body name=\"b{}\"{}{}>", ++count_, attribute("pos", 3, -0.5, 0.5), orientation());
    if (root && chance(0.3))
      text += "<freejoint/>";
    else if (chance(0.75))
      text += joint();
    if (chance(0.4)) text += inertial();
    const int geoms = products_ ? 1 + random_.index(3) : 1;
    for (int i = 0; i < geoms; ++i) text += geom(i == 0);
    if (depth < 4)
      for (int i = random_.index(3); i > 0; --i) text += body(depth + 1, false);
    return text + "</body>";
  }

  bool radian_ = false;
  int count_ = 0;
};

class RandomUrdf : RandomText {
 public:
  explicit RandomUrdf(std::uint64_t seed) : RandomText(seed) {}

  std::string text() {
    std::vector<std::string> elements{link(0, true)};
    const int links = 2 + random_.index(8);
    for (int i = 1; i < links; ++i) {
      elements.push_back(link(i, false));
      elements.push_back(joint(random_.index(i), i));
    }
    for (std::size_t i = elements.size() - 1; i > 0; --i)  // in any order
      std::swap(elements[i], elements[static_cast<std::size_t>(random_.index(static_cast<int>(i) + 1))]);
    std::string text = "<robot name=\"random\">\n";
    if (!products_) text += "<mujoco><compiler fusestatic=\"false\"/></mujoco>\n";
    for (const std::string& element : elements) text += element + "\n";
    return text + "</robot>\n";
  }

 private:
  std::string origin() {
    return chance(0.2) ? ""
                       : fmt::format("<origin{}{}/>", chance(0.8) ? attribute("xyz", 3, -0.5, 0.5) : "",
                                     chance(0.8) ? attribute("rpy", 3, -3.0, 3.0) : "");
  }

  std::string collision() {
    std::string shape = "<box" + attribute("size", 3, 0.02, 0.2) + "/>";
    if (chance(0.3)) shape = "<sphere" + attribute("radius", 1, 0.02, 0.2) + "/>";
    if (chance(0.3))
      shape = "<cylinder" + attribute("radius", 1, 0.02, 0.2) + attribute("length", 1, 0.02, 0.2) + "/>";
    return "<collision>" + origin() + "<geometry>" + shape + "</geometry></collision>";
  }

  std::string link(int number, bool root) {
    std::string text = fmt::format("<link name=\"l{}\">", number);
    if (chance(0.7)) {
      const double mass = random_.uniform(0.1, 5.0);
      const Vec3 I = moments(mass);
      const double off = products_ ? 0.1 * I.minCoeff() : 0.0;
      text += fmt::format(
          "<inertial>{}<mass value=\"{:.9g}\"/><inertia ixx=\"{:.9g}\" iyy=\"{:.9g}\" izz=\"{:.9g}\" "
          "ixy=\"{:.9g}\" ixz=\"{:.9g}\" iyz=\"{:.9g}\"/></inertial>",
          origin(), mass, I.x(), I.y(), I.z(), off, -0.3 * off, 0.5 * off);
    }
    const int shapes = root ? random_.index(2) : 1 + (products_ ? random_.index(2) : 0);
    for (int i = 0; i < shapes; ++i) text += collision();
    return text + "</link>";
  }

  std::string joint(int parent, int child) {
    constexpr std::array kTypes{"revolute", "prismatic", "continuous", "fixed", "floating"};
    const std::size_t type = static_cast<std::size_t>(random_.index(parent == 0 && products_ ? 5 : 4));
    std::string text =
        fmt::format("<joint name=\"j{1}\" type=\"{2}\"><parent link=\"l{0}\"/><child link=\"l{1}\"/>{3}",
                    parent, child, kTypes[type], origin());
    if (type < 3) text += "<axis" + attribute("xyz", 3, -1.0, 1.0) + "/>";
    if (type < 2)
      text += fmt::format("<limit lower=\"{}\" upper=\"{}\" effort=\"1\" velocity=\"1\"/>",
                          numbers(1, -1.0, 0.3), numbers(1, 0.31, 1.0));
    if (type < 3 && chance(0.4))
      text += "<dynamics" + attribute("damping", 1, 0.0, 2.0) + attribute("friction", 1, 0.0, 2.0) + "/>";
    return text + "</joint>";
  }
};

}  // namespace

std::string random_mjcf(std::uint64_t seed) { return RandomMjcf(seed).text(); }
std::string random_urdf(std::uint64_t seed) { return RandomUrdf(seed).text(); }

}  // namespace tactum::import_test
