#include "tactum/import/mjcf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/import/mjcf_shapes.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kMujocoGravity = 9.81;  // where <option> gives none [m/s^2]
constexpr int kMostReplicas = 10000;     // in one file, so that a few in each other end soon

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
      if (!log_.errors()) read_body(*world, -1, {});
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

  /// Where an element stands in its body: the frames and replicas around it.
  struct Around {
    Pose X_BF = {};
    std::string childclass = {};
    std::string suffix = {};  // of names, by the replicas
  };

  /// A body, or the world.
  void read_body(const XmlElement& element, int parent, const Around& outer) {
    const Attributes of(log_, element);
    ModelLink link;
    link.at = &element;
    link.parent = parent;
    link.name = of.text("name");
    if (!link.name.empty()) link.name += outer.suffix;
    const Around inner{{}, of.text("childclass", outer.childclass), outer.suffix};
    if (element.name == "body") {
      link.X_PL = outer.X_BF * Pose{rotation_of(of, compiler_), of.vector("pos", Vec3::Zero())};
      if (const XmlElement* inertial = element.child("inertial")) link.inertial = read_inertial(*inertial);
    }
    read_parts(element, inner, link);
    const int number = static_cast<int>(model_.links.size());
    model_.links.push_back(std::move(link));
    read_bodies(element, inner, number);
  }

  /// The joints and geoms of a body, also those in its frames.
  void read_parts(const XmlElement& element, const Around& around, ModelLink& link) {
    if (link.at->name == "body")
      for (const char* name : {"joint", "freejoint"})
        for (const XmlElement* joint : element.all(name)) add_joint(*joint, around, link);
    for (const XmlElement* geom : element.all("geom"))
      if (auto shape = read_geom(defaults_.of(*geom, around.childclass, log_), compiler_, meshes_)) {
        shape->X_LS = around.X_BF * shape->X_LS;
        if (!shape->name.empty()) shape->name += around.suffix;
        link.shapes.push_back(std::move(*shape));
      }
    in_frames(element, around,
              [&](const XmlElement& frame, const Around& in) { read_parts(frame, in, link); });
  }

  void read_bodies(const XmlElement& element, const Around& around, int number) {
    for (const XmlElement* body : element.all("body")) {
      if (log_.errors()) return;
      read_body(*body, number, around);
    }
    in_frames(element, around,
              [&](const XmlElement& frame, const Around& in) { read_bodies(frame, in, number); });
  }

  /// Visits the frames that stand in an element, and each replica, whose frame follows on that of the one
  /// before it.
  template <class Visit>
  void in_frames(const XmlElement& element, const Around& around, Visit visit) {
    for (const XmlElement* frame : element.all("frame")) {
      const Attributes of(log_, *frame);
      of.text("name");
      const Pose X{rotation_of(of, compiler_), of.vector("pos", Vec3::Zero())};
      visit(*frame, Around{around.X_BF * X, of.text("childclass", around.childclass), around.suffix});
    }
    for (const XmlElement* replicate : element.all("replicate")) {
      const Attributes of(log_, *replicate);
      const double count = of.number("count", 0.0);
      const Pose step{rotation_of(of, compiler_), of.vector("offset", Vec3::Zero())};
      if (!(count >= 1.0 && count <= kMostReplicas && count == std::floor(count)))
        return of.fail("count", "how many replicas", fmt::format("{}", count),
                       fmt::format("a whole number from 1 to {}", kMostReplicas));
      const std::string last = fmt::format("{}", static_cast<int>(count));
      Pose X = around.X_BF;
      for (int i = 0; i < static_cast<int>(count) && !log_.errors(); ++i, X = renormalized(X * step)) {
        if (++replicas_ > 2 * kMostReplicas)  // each is visited for its geoms and for its bodies
          return log_.fail(*replicate, "too many replicas", fmt::format("more than {}", kMostReplicas),
                           "fewer, in all of the file");
        visit(*replicate, Around{X, around.childclass,
                                 fmt::format("{}{:0{}}{}", of.text("sep"), i, last.size(), around.suffix)});
      }
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

  /// A body has its first joint.
  void add_joint(const XmlElement& element, const Around& around, ModelLink& link) {
    if (link.joint.at != nullptr) {
      log_.note(element, fmt::format("a body has one joint here: \"{}\" is held by the one in line {} alone",
                                     link.name, link.joint.at->line));
      for (const XmlAttribute& attribute : element.attributes) attribute.read = true;
      return;
    }
    if (element.name == "freejoint") {
      Attributes(log_, element).text("name");
      link.joint.kind = JointKind::kFree;
      link.joint.at = &element;
      return;
    }
    link.joint = read_joint(defaults_.of(element, around.childclass, log_));
    link.joint.anchor = around.X_BF * link.joint.anchor;
    link.joint.axis = around.X_BF.R * link.joint.axis;
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
  int replicas_ = 0;
};

}  // namespace

ImportModel read_mjcf(XmlElement& mujoco, const std::string& folder, ImportLog& log) {
  return MjcfReader(mujoco, folder, log).read();
}

}  // namespace tactum::inline v0_1
