#include "tactum/import/mjcf_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactum/import/mjcf_shapes.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kMujocoGravity = 9.81;  // where <option> gives none [m/s^2]

/// Attributes that are honoured where an element has them, so that a class of defaults may have them as well.
const std::set<std::string> kHonouredByDefault{
    "class", "type", "pos",     "quat",    "axisangle", "euler",        "xyaxes",    "zaxis", "fromto",
    "size",  "mesh", "contype", "mass",    "density",   "conaffinity",  "friction",  "group", "axis",
    "range", "ref",  "limited", "damping", "stiffness", "frictionloss", "springref", "scale"};

class MjcfReader {
 public:
  MjcfReader(XmlElement& mujoco, const std::string& folder, ImportLog& log)
      : mujoco_(included(mujoco, folder, log)),
        log_(log),
        compiler_(read_compiler(mujoco_, log)),
        defaults_(mujoco_, log),
        meshes_(mujoco_, folder, compiler_, defaults_, log) {}

  ImportModel read() {
    mujoco_.read = true;
    model_.name = Attributes(log_, mujoco_).text("model", "model");
    model_.masses = compiler_.masses;
    model_.gravity_W = gravity();
    std::vector<const XmlElement*> worlds = mujoco_.all("worldbody");
    if (worlds.empty()) log_.fail(mujoco_, "the model has no <worldbody>", "", "one");
    for (const XmlElement* world : worlds)
      if (!log_.errors()) read_body(*world, -1, "");
    mark_defaults(mujoco_);
    return std::move(model_);
  }

 private:
  static const XmlElement& included(XmlElement& mujoco, const std::string& folder, ImportLog& log) {
    include_files(mujoco, folder, log);
    return mujoco;
  }

  Vec3 gravity() {
    Vec3 gravity(0.0, 0.0, -kMujocoGravity);
    for (const XmlElement* option : mujoco_.all("option")) {
      gravity = Attributes(log_, *option).vector("gravity", gravity);
      if (const XmlElement* flag = option->child("flag"))
        if (Attributes(log_, *flag).word("gravity", 1, {"disable", "enable"}) == 0) gravity = Vec3::Zero();
    }
    return gravity;
  }

  /// What the classes of defaults give to elements that the file happens not to have is honoured all the
  /// same.
  static void mark_defaults(const XmlElement& element) {
    for (const XmlElement& child : element.children) {
      if (child.name == "default") mark_defaults(child);
      if (element.name != "default" || !child.read) continue;
      for (const XmlAttribute& attribute : child.attributes)
        attribute.read = attribute.read || kHonouredByDefault.contains(attribute.name);
    }
  }

  /// A body, or the world.
  void read_body(const XmlElement& element, int parent, const std::string& outer_class) {
    const Attributes of(log_, element);
    ModelLink link;
    link.at = &element;
    link.parent = parent;
    link.name = of.text("name");
    const std::string childclass = of.text("childclass", outer_class);
    if (element.name == "body") {
      link.X_PL = {rotation_of(of, compiler_), of.vector("pos", Vec3::Zero())};
      if (const XmlElement* inertial = element.child("inertial")) link.inertial = read_inertial(*inertial);
      read_joints(element, childclass, link);
    }
    for (const XmlElement* geom : element.all("geom"))
      if (const auto shape = read_geom(defaults_.of(*geom, childclass, log_), compiler_, meshes_))
        link.shapes.push_back(*shape);
    const int number = static_cast<int>(model_.links.size());
    model_.links.push_back(std::move(link));
    for (const XmlElement* body : element.all("body")) {
      if (log_.errors()) return;
      read_body(*body, number, childclass);
    }
  }

  ModelInertial read_inertial(const XmlElement& element) {
    const Attributes of(log_, element);
    ModelInertial inertial;
    if (!of.has("mass")) log_.fail(element, "an <inertial> without a mass", "", "mass=\"...\"");
    inertial.mass_kg = of.number("mass", 0.0, kNotNegative);
    inertial.center = of.vector("pos", Vec3::Zero());
    const std::vector<double> full = of.numbers("fullinertia", 6, 6);
    if (full.empty() == !of.has("diaginertia"))
      log_.fail(element,
                full.empty() ? "an <inertial> without an inertia" : "an <inertial> with two inertias", "",
                "diaginertia or fullinertia");
    Mat3 tensor = of.vector("diaginertia", Vec3::Zero()).asDiagonal();
    if (!full.empty()) {
      tensor = Vec3(full[0], full[1], full[2]).asDiagonal();
      tensor(0, 1) = tensor(1, 0) = full[3];
      tensor(0, 2) = tensor(2, 0) = full[4];
      tensor(1, 2) = tensor(2, 1) = full[5];
    }
    const Mat3 R = rotation_of(of, compiler_);
    inertial.inertia = R * tensor * R.transpose();
    return inertial;
  }

  void read_joints(const XmlElement& body, const std::string& childclass, ModelLink& link) {
    std::vector<const XmlElement*> joints = body.all("joint");
    const std::vector<const XmlElement*> free = body.all("freejoint");
    joints.insert(joints.end(), free.begin(), free.end());
    for (const XmlElement* joint : joints) {
      if (joint != joints.front()) {
        log_.note(*joint, fmt::format("a body has one joint here: \"{}\" is held by the one in line {} alone",
                                      link.name, joints.front()->line));
        for (const XmlAttribute& attribute : joint->attributes) attribute.read = true;
        continue;
      }
      if (joint->name == "freejoint") {
        Attributes(log_, *joint).text("name");
        link.joint.kind = JointKind::kFree;
        link.joint.at = joint;
        continue;
      }
      link.joint = read_joint(defaults_.of(*joint, childclass, log_));
    }
  }

  ModelJoint read_joint(const Attributes& of) {
    constexpr JointKind kKinds[] = {JointKind::kFree, JointKind::kBall, JointKind::kSlider,
                                    JointKind::kHinge};
    ModelJoint joint;
    joint.at = &of.element();
    of.text("name");
    joint.kind = kKinds[of.word("type", 3, {"free", "ball", "slide", "hinge"})];
    if (joint.kind == JointKind::kFree) return joint;
    const bool slides = joint.kind == JointKind::kSlider;
    joint.anchor = of.vector("pos", Vec3::Zero());
    joint.damping = of.number("damping", 0.0, kNotNegative);
    if (joint.kind != JointKind::kBall) {
      joint.axis = of.vector("axis", Vec3::UnitZ());
      if (!(joint.axis.norm() > 0.0)) of.fail("axis", "an axis of length 0", "", "any other length");
      joint.friction = of.number("frictionloss", 0.0, kNotNegative);
      joint.stiffness = of.number("stiffness", 0.0, kNotNegative);
    }
    const double unit = slides ? 1.0 : compiler_.radians_per_unit;
    // The file's poses are those at `ref`, from which the scene counts.
    const double start = joint.kind == JointKind::kBall ? 0.0 : of.number("ref", 0.0) * unit;
    if (joint.kind != JointKind::kBall) joint.rest = of.number("springref", 0.0) * unit - start;
    read_limits(of, unit, start, joint);
    return joint;
  }

  void read_limits(const Attributes& of, double unit, double start, ModelJoint& joint) {
    const int limited = of.word("limited", 2, {"false", "true", "auto"});
    const std::vector<double> range = of.numbers("range", 2, 2);
    const bool wanted = limited == 1 || (limited == 2 && compiler_.limits_by_range && !range.empty());
    if (!wanted) return;
    if (range.empty() || !(range[0] < range[1]))
      return of.fail("range", "a joint that is limited to nothing", "", "range=\"LEAST LARGEST\"");
    if (joint.kind == JointKind::kBall) {
      if (range[0] != 0.0 || range[1] * unit > kPi)
        return of.fail("range", "the range of a ball", fmt::format("{} to {}", range[0], range[1]),
                       "from 0 to at most half a turn");
      joint.limits = Interval{0.0, range[1] * unit};
      return;
    }
    joint.limits = Interval{range[0] * unit - start, range[1] * unit - start};
  }

  const XmlElement& mujoco_;
  ImportLog& log_;
  MjcfCompiler compiler_;
  MjcfDefaults defaults_;
  MjcfMeshes meshes_;
  ImportModel model_;
};

}  // namespace

ImportModel read_mjcf(XmlElement& mujoco, const std::string& folder, ImportLog& log) {
  return MjcfReader(mujoco, folder, log).read();
}

}  // namespace tactum::inline v0_1
