#include "tactum/import/urdf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tactum/import/mesh_paths.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kEarthGravity = 9.81;  // URDF has none; its z axis is up [m/s^2]

class UrdfReader {
 public:
  UrdfReader(const XmlElement& robot, const std::string& folder, ImportLog& log)
      : robot_(robot), folder_(folder), log_(log) {}

  ImportModel read() {
    ImportModel model;
    robot_.read = true;
    model.name = Attributes(log_, robot_).text("name", "robot");
    model.gravity_W = {0.0, 0.0, -kEarthGravity};
    for (const XmlElement* link : robot_.all("link")) read_link(*link);
    for (const XmlElement* joint : robot_.all("joint")) read_joint(*joint);
    if (links_.empty()) log_.fail(robot_, "the robot has no <link>", "", "at least one");
    if (!log_.errors()) sort_into(model);
    return model;
  }

 private:
  struct Edge {
    int parent = -1, child = -1;
    const XmlElement* at = nullptr;
  };

  /// <origin xyz rpy> of an element: roll, pitch and yaw about fixed axes.
  Pose origin(const XmlElement& of) {
    const XmlElement* element = of.child("origin");
    if (element == nullptr) return {};
    const Attributes attributes(log_, *element);
    const Vec3 rpy_rad = attributes.vector("rpy", Vec3::Zero());
    return {rotation_rpy_deg(rpy_rad * (180.0 / kPi)), attributes.vector("xyz", Vec3::Zero())};
  }

  void read_link(const XmlElement& element) {
    ModelLink link;
    link.at = &element;
    link.name = Attributes(log_, element).text("name");
    if (link.name.empty()) log_.fail(element, "a <link> without a name", "", "a name of its own");
    if (!number_of_.emplace(link.name, static_cast<int>(links_.size())).second)
      log_.fail(element, "two links of one name", fmt::format("\"{}\"", link.name), "a name of its own");
    if (const XmlElement* inertial = element.child("inertial")) link.inertial = read_inertial(*inertial);
    std::vector<const XmlElement*> shapes = element.all("collision");
    if (shapes.empty() && std::any_of(element.children.begin(), element.children.end(),
                                      [](const XmlElement& child) { return child.name == "visual"; })) {
      shapes = element.all("visual");
      log_.note(element, fmt::format("\"{}\" has no <collision>: its <visual> is felt", link.name));
    }
    for (const XmlElement* shape : shapes) read_shape(*shape, link);
    links_.push_back(std::move(link));
  }

  ModelInertial read_inertial(const XmlElement& element) {
    ModelInertial inertial;
    const Pose X = origin(element);
    const XmlElement* mass = element.child("mass");
    const XmlElement* inertia = element.child("inertia");
    if (mass == nullptr || inertia == nullptr) {
      log_.fail(element, "an <inertial> is not whole", mass == nullptr ? "no <mass>" : "no <inertia>",
                "<mass value> and <inertia ixx ixy ixz iyy iyz izz>");
      return inertial;
    }
    inertial.mass_kg = Attributes(log_, *mass).number("value", 0.0, kNotNegative);
    const Attributes of(log_, *inertia);
    Mat3 tensor = Vec3(of.number("ixx", 0.0), of.number("iyy", 0.0), of.number("izz", 0.0)).asDiagonal();
    tensor(0, 1) = tensor(1, 0) = of.number("ixy", 0.0);
    tensor(0, 2) = tensor(2, 0) = of.number("ixz", 0.0);
    tensor(1, 2) = tensor(2, 1) = of.number("iyz", 0.0);
    inertial.center = X.p;
    inertial.inertia = X.R * tensor * X.R.transpose();
    return inertial;
  }

  void read_shape(const XmlElement& element, ModelLink& link) {
    ModelShape shape;
    shape.at = &element;
    shape.X_LS = origin(element);
    shape.name = Attributes(log_, element).text("name");
    const XmlElement* geometry = element.child("geometry");
    if (geometry == nullptr || geometry->children.size() != 1)
      return log_.fail(element, "no shape, or several", fmt::format("<{}>", element.name),
                       "<geometry> with one of <box>, <cylinder>, <sphere>, <capsule>, <mesh>");
    const XmlElement& kind = geometry->children.front();
    kind.read = true;
    const Attributes of(log_, kind);
    const auto positive = [&](const char* name) {
      if (!of.has(name)) log_.fail(kind, fmt::format("<{}> without \"{}\"", kind.name, name), "", "a length");
      return of.number(name, 1.0, kPositive);
    };
    if (kind.name == "box") {
      shape.kind = ModelShapeKind::kBox;
      shape.size = of.vector("size", Vec3::Zero());
      if (!(shape.size.minCoeff() > 0.0)) of.fail("size", "a <box> has three sides", "", "numbers above 0");
    } else if (kind.name == "sphere") {
      shape.size = {positive("radius"), 0.0, 0.0};
    } else if (kind.name == "cylinder" || kind.name == "capsule") {
      shape.kind = kind.name == "capsule" ? ModelShapeKind::kCapsule : ModelShapeKind::kCylinder;
      shape.size = {positive("radius"), positive("length"), 0.0};
    } else if (kind.name == "mesh") {
      read_mesh(of, shape);
    } else {
      log_.fail(kind, "a shape that is not known", fmt::format("<{}>", kind.name),
                one_of_meant(kind.name, {"box", "cylinder", "sphere", "capsule", "mesh"}));
    }
    link.shapes.push_back(std::move(shape));
  }

  void read_mesh(const Attributes& of, ModelShape& shape) {
    shape.kind = ModelShapeKind::kMesh;
    shape.size = of.vector("scale", Vec3::Ones());
    if (shape.size.cwiseAbs().minCoeff() == 0.0)
      of.fail("scale", "a scale of zero", "0", "any other numbers");
    const std::string name = of.text("filename");
    const std::optional<std::string> path = find_mesh_file(name, folder_);
    if (!path)
      return of.fail("filename", "the mesh is not there", fmt::format("\"{}\"", name),
                     places_of_meshes(name, folder_));
    shape.mesh = *path;
  }

  /// The link that <parent link> or <child link> names; -1 and an error when there is none.
  int linked(const XmlElement& joint, const char* end) {
    const XmlElement* element = joint.child(end);
    const std::string name = element != nullptr ? Attributes(log_, *element).text("link") : "";
    const auto found = number_of_.find(name);
    if (found != number_of_.end()) return found->second;
    std::vector<std::string> names;
    for (const ModelLink& link : links_) names.push_back(link.name);
    log_.fail(element != nullptr ? *element : joint, fmt::format("the joint's {} is no link", end),
              fmt::format("\"{}\"", name), one_of_meant(name, names));
    return -1;
  }

  void read_joint(const XmlElement& element) {
    const Edge edge{linked(element, "parent"), linked(element, "child"), &element};
    const Attributes of(log_, element);
    of.text("name");
    const std::vector<std::string> kinds{"fixed",     "revolute", "continuous",
                                         "prismatic", "floating", "planar"};
    if (!of.has("type")) log_.fail(element, "a <joint> without a type", "", one_of(kinds));
    const int kind = of.word("type", 0, kinds);
    if (kind == 5)
      of.fail("type", "a joint of three degrees of freedom", "\"planar\"",
              "a joint of one, \"fixed\" or \"floating\"");
    if (log_.errors()) return;
    ModelLink& child = links_[static_cast<std::size_t>(edge.child)];
    for (const Edge& other : edges_)
      if (other.child == edge.child)
        log_.fail(element, fmt::format("\"{}\" hangs on two joints", child.name), "",
                  "one joint for each link");
    edges_.push_back(edge);
    child.X_PL = origin(element);
    constexpr JointKind kKinds[] = {JointKind::kFixed,  JointKind::kHinge, JointKind::kHinge,
                                    JointKind::kSlider, JointKind::kFree,  JointKind::kFixed};
    child.joint.kind = kKinds[kind];
    child.joint.at = &element;
    if (kind < 1 || kind > 3) return;
    if (const XmlElement* axis = element.child("axis")) {
      const Attributes xyz(log_, *axis);
      child.joint.axis = xyz.vector("xyz", Vec3::UnitX());
      if (!(child.joint.axis.norm() > 0.0)) xyz.fail("xyz", "an axis of length 0", "", "any other length");
    }
    if (const XmlElement* dynamics = element.child("dynamics")) {
      child.joint.damping = Attributes(log_, *dynamics).number("damping", 0.0, kNotNegative);
      child.joint.friction = Attributes(log_, *dynamics).number("friction", 0.0, kNotNegative);
    }
    if (kind != 2) read_limits(element, child.joint);
  }

  void read_limits(const XmlElement& element, ModelJoint& joint) {
    const XmlElement* limit = element.child("limit");
    if (limit == nullptr) return;
    const Attributes of(log_, *limit);
    const Interval limits{of.number("lower", 0.0), of.number("upper", 0.0)};
    if (limits.lower > limits.upper)
      return of.fail("lower", "limits from more to less", fmt::format("{} to {}", limits.lower, limits.upper),
                     "from less to more");
    if (limits.lower < limits.upper)
      joint.limits = limits;
    else
      log_.note(*limit, "limits without a range between them are none");
  }

  /// Links behind those they hang on. A circle of joints is an error, and so is a second root.
  void sort_into(ImportModel& model) {
    std::vector<int> parent(links_.size(), -1);
    for (const Edge& edge : edges_) parent[static_cast<std::size_t>(edge.child)] = edge.parent;
    std::vector<int> place(links_.size(), -1);
    std::vector<std::vector<int>> children(links_.size());
    std::vector<int> open;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (parent[i] >= 0)
        children[static_cast<std::size_t>(parent[i])].push_back(static_cast<int>(i));
      else if (open.empty())
        open.push_back(static_cast<int>(i));
      else
        return log_.fail(*links_[i].at, "a second link that hangs on no joint",
                         fmt::format("\"{}\"", links_[i].name), "one root");
    }
    for (std::size_t next = 0; next < open.size(); ++next) {
      const auto at = static_cast<std::size_t>(open[next]);
      place[at] = static_cast<int>(model.links.size());
      ModelLink link = std::move(links_[at]);
      link.parent = parent[at] < 0 ? -1 : place[static_cast<std::size_t>(parent[at])];
      model.links.push_back(std::move(link));
      open.insert(open.end(), children[at].begin(), children[at].end());
    }
    if (model.links.size() < links_.size())
      log_.fail(robot_, "the joints go in a circle",
                fmt::format("{} links on no chain from the root", links_.size() - model.links.size()),
                "a tree");
  }

  const XmlElement& robot_;
  const std::string& folder_;
  ImportLog& log_;
  std::vector<ModelLink> links_;
  std::map<std::string, int> number_of_;
  std::vector<Edge> edges_;
};

}  // namespace

ImportModel read_urdf(const XmlElement& robot, const std::string& folder, ImportLog& log) {
  return UrdfReader(robot, folder, log).read();
}

}  // namespace tactum::inline v0_1
