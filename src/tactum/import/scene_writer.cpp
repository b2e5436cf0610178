#include "tactum/import/scene_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "tactum/import/scene_bodies.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kUsualSize_m = 0.1;        // a held part of this size needs no scale of the workspace
constexpr double kEndlessPlane_m = 20.0;    // the side of the plate for a plane without an end
constexpr double kPlateThickness = 0.05;    // of a plane's plate, by its side
constexpr std::size_t kMostFrictions = 32;  // different ones, of which each pair is a table of the scene

/// A text as TOML has it, in double quotes; control characters become spaces.
std::string toml_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return quoted + '"';
}

/// A number that reads back to the same bits, as a float of TOML.
std::string toml_number(double value) {
  std::string text = fmt::format("{}", value == 0.0 ? 0.0 : value);
  const bool whole = text.find_first_of(".e") == std::string::npos;
  return whole ? text + ".0" : text;
}

std::string toml_vector(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", toml_number(v.x()), toml_number(v.y()), toml_number(v.z()));
}

/// "pos_m = ... quat_wxyz = ...", as lines; nothing for what is zero.
std::string toml_pose(const Pose& X) {
  std::string text;
  if (!X.p.isZero(0.0)) text += fmt::format("pos_m = {}\n", toml_vector(X.p));
  const Quat q = Quat(X.R).normalized();
  if (!X.R.isIdentity(0.0))
    text += fmt::format("quat_wxyz = [{}, {}, {}, {}]\n", toml_number(q.w()), toml_number(q.x()),
                        toml_number(q.y()), toml_number(q.z()));
  return text;
}

std::string material_name(double friction) { return fmt::format("friction {}", friction); }

/// A plane's rectangle as a box whose upper side it is.
ModelShape plate_of(const ModelShape& plane) {
  ModelShape plate = plane;
  plate.kind = ModelShapeKind::kBox;
  for (int i = 0; i < 2; ++i)
    if (!(plate.size[i] > 0.0)) plate.size[i] = kEndlessPlane_m;
  plate.size.z() = kPlateThickness * std::max(plate.size.x(), plate.size.y());
  plate.X_LS = plate.X_LS * Pose{Mat3::Identity(), -0.5 * plate.size.z() * Vec3::UnitZ()};
  return plate;
}

class SceneWriter {
 public:
  SceneWriter(const ImportModel& model, const ImportChoices& choices, ModelMeshes& meshes, ImportLog& log)
      : model_(model), choices_(choices), meshes_(meshes), log_(log) {}

  WrittenScene write() {
    bodies_ = scene_bodies(model_, log_);
    if (log_.errors()) return {};
    if (bodies_.empty()) {
      log_.fail(*model_.links.front().at, "nothing in the file can be felt", "no shape",
                "shapes that collide");
      return {};
    }
    WrittenScene scene;
    scene.toml = fmt::format("schema = 1\ndescription = {}\n", toml_text("imported: " + model_.name));
    if (!model_.gravity_W.isZero(0.0))
      scene.toml += fmt::format("gravity_m_per_s2 = {}\n", toml_vector(model_.gravity_W));
    for (const SceneBody& body : bodies_) scene.toml += body_text(body);
    scene.toml += friction_text() + tool_text(scene.sentences);
    return scene;
  }

 private:
  const SceneBody& body(int i) const { return bodies_[static_cast<std::size_t>(i)]; }

  std::string mesh_name(const std::string& path) const {
    namespace fs = std::filesystem;
    const fs::path whole = fs::absolute(path).lexically_normal();
    if (choices_.folder.empty()) return whole.string();
    return whole.lexically_proximate(fs::absolute(choices_.folder).lexically_normal()).string();
  }

  /// The table of the part.
  std::string part_text(const ModelShape& shape) const {
    const Vec3& s = shape.size;
    switch (shape.kind) {
      case ModelShapeKind::kBox:
        return fmt::format("{{ box = {{ size_m = {} }} }}", toml_vector(s));
      case ModelShapeKind::kBall:
        return fmt::format("{{ ball = {{ radius_m = {} }} }}", toml_number(s.x()));
      case ModelShapeKind::kEllipsoid:
        return fmt::format("{{ ellipsoid = {{ radii_m = {} }} }}", toml_vector(s));
      case ModelShapeKind::kCylinder:
      case ModelShapeKind::kCapsule:
        return fmt::format("{{ {} = {{ radius_m = {}, height_m = {} }} }}",
                           shape.kind == ModelShapeKind::kCylinder ? "cylinder" : "capsule",
                           toml_number(s.x()), toml_number(s.y()));
      case ModelShapeKind::kMesh:
      case ModelShapeKind::kPlane:
        break;
    }
    const bool even = s.x() == s.y() && s.y() == s.z() && s.x() > 0.0;
    const std::string scale = even ? "scale = " + toml_number(s.x()) : "scale_xyz = " + toml_vector(s);
    return fmt::format("{{ mesh = {}, {} }}", toml_text(mesh_name(shape.mesh)), scale);
  }

  std::string joint_text(const SceneBody& what) const {
    const ModelJoint& joint = what.joint;
    const bool slides = joint.kind == JointKind::kSlider;
    std::string keys;
    const auto add = [&](const char* key, double value) {
      if (value != 0.0) keys += fmt::format(", {} = {}", key, toml_number(value));
    };
    const double unit = slides ? 1.0 : kPi / 180.0;
    switch (joint.kind) {
      case JointKind::kFree:
        return "";
      case JointKind::kFixed:
        return "joint = { kind = \"fixed\" }\n";
      case JointKind::kHinge:
      case JointKind::kSlider:
        keys = fmt::format("kind = \"{}\", axis = {}", slides ? "slider" : "hinge", toml_vector(joint.axis));
        if (!slides) keys += fmt::format(", anchor_m = {}", toml_vector(joint.anchor));
        add(slides ? "damping_Ns_per_m" : "damping_Nms", joint.damping);
        add(slides ? "friction_N" : "friction_Nm", joint.friction);
        add(slides ? "stiffness_N_per_m" : "stiffness_Nm_per_rad", joint.stiffness);
        if (joint.stiffness != 0.0) add(slides ? "rest_m" : "rest_deg", joint.rest / unit);
        if (joint.limits)
          keys +=
              fmt::format(", {} = [{}, {}]", slides ? "limits_m" : "limits_deg",
                          toml_number(joint.limits->lower / unit), toml_number(joint.limits->upper / unit));
        break;
      case JointKind::kBall:
        keys = fmt::format("kind = \"ball\", anchor_m = {}", toml_vector(joint.anchor));
        add("damping_Nms", joint.damping);
        if (joint.limits) keys += fmt::format(", swing_deg = {}", toml_number(joint.limits->upper / unit));
        break;
    }
    if (what.parent >= 0) keys += ", parent = " + toml_text(body(what.parent).name);
    return fmt::format("joint = {{ {} }}\n", keys);
  }

  std::string body_text(const SceneBody& what) {
    std::string text = fmt::format("\n[[body]]\nname = {}\n", toml_text(what.name));
    std::vector<ModelShape> shapes = what.shapes;
    Pose X_WP = what.X_WP;
    for (ModelShape& shape : shapes) {
      if (shape.kind != ModelShapeKind::kPlane) continue;
      if (what.joint.kind != JointKind::kFixed)
        log_.fail(*shape.at, "a plane on a body that moves", fmt::format("\"{}\"", what.name), "a box");
      log_.note(*shape.at, "a plane is felt as the upper side of a plate");
      shape = plate_of(shape);
    }
    if (shapes.size() == 1) X_WP = X_WP * shapes.front().X_LS;
    text += toml_pose(X_WP);
    if (what.joint.kind != JointKind::kFixed) {
      const Mat3& I = what.inertial.inertia;
      text += fmt::format(
          "inertial = {{ mass_kg = {}, center_m = {}, inertia_kg_m2 = {}, products_kg_m2 = {} }}\n",
          toml_number(what.inertial.mass_kg), toml_vector(what.inertial.center), toml_vector(I.diagonal()),
          toml_vector({I(0, 1), I(0, 2), I(1, 2)}));
    }
    text += joint_text(what);
    if (what.friction >= 0.0) text += fmt::format("material = {}\n", toml_text(material_name(what.friction)));
    if (shapes.size() == 1) return text + fmt::format("part = {}\n", part_text(shapes.front()));
    for (const ModelShape& shape : shapes)
      text += fmt::format("\n[[body.component]]\npart = {}\n{}", part_text(shape), toml_pose(shape.X_LS));
    return text;
  }

  /// Of two bodies the larger friction counts, as in MuJoCo.
  std::string friction_text() {
    std::set<double> frictions;
    for (const SceneBody& what : bodies_)
      if (what.friction >= 0.0) frictions.insert(what.friction);
    if (frictions.size() > kMostFrictions) {
      log_.fail(*model_.links.front().at, "too many different frictions", fmt::format("{}", frictions.size()),
                fmt::format("at most {}", kMostFrictions));
      return "";
    }
    std::string text;
    for (const double a : frictions)
      for (const double b : frictions)
        if (a <= b && b > 0.0)
          text += fmt::format("\n[[friction]]\nmaterial_a = {}\nmaterial_b = {}\ncoefficient = {}\n",
                              toml_text(material_name(a)), toml_text(material_name(b)), toml_number(b));
    return text;
  }

  /// The length of the body's chain, itself included.
  int chain(int i) const {
    int length = 0;
    for (; i >= 0; i = body(i).parent) ++length;
    return length;
  }

  /// The held body; -1 where nothing moves. `why` says how it was chosen.
  int grasped_body(std::string& why) const {
    int grasped = -1, longest = 0;
    for (int i = 0; i < static_cast<int>(bodies_.size()); ++i) {
      const SceneBody& what = body(i);
      if (!choices_.tool.empty() && what.name == choices_.tool) {
        why = "as asked for";
        return i;
      }
      if (what.joint.kind == JointKind::kFixed) continue;
      if (what.joint.kind == JointKind::kFree && longest < static_cast<int>(bodies_.size()) + 1) {
        grasped = i;
        longest = static_cast<int>(bodies_.size()) + 1;
        why = "the first body that is free";
      } else if (chain(i) > longest) {
        grasped = i;
        longest = chain(i);
        why = "the end of the longest chain, since no body is free";
      }
    }
    return choices_.tool.empty() ? grasped : -1;
  }

  std::string tool_text(std::vector<std::string>& sentences) {
    std::string why;
    const int grasped = grasped_body(why);
    if (grasped < 0 && !choices_.tool.empty()) {
      std::vector<std::string> names;
      for (const SceneBody& what : bodies_) names.push_back(what.name);
      log_.fail(*model_.links.front().at, "no body of this name", fmt::format("\"{}\"", choices_.tool),
                one_of_meant(choices_.tool, names));
      return "";
    }
    if (grasped < 0) {
      sentences.emplace_back("Nothing moves, so the hand holds nothing.");
      return "";
    }
    if (body(grasped).joint.kind == JointKind::kFixed) {
      log_.fail(*model_.links.front().at, "the hand cannot hold a body that never moves",
                fmt::format("\"{}\"", body(grasped).name), "a body that moves");
      return "";
    }
    sentences.push_back(fmt::format("The hand holds \"{}\", {}.", body(grasped).name, why));
    const double scale = std::max(1.0, size_of_shapes(body(grasped)) / kUsualSize_m);
    return fmt::format("\n[workspace]\nscale = {}\n\n[tool]\nbody = {}\ngrasp = \"centre\"\n",
                       toml_number(std::ceil(10.0 * scale) / 10.0), toml_text(body(grasped).name));
  }

  /// The longest side of the box around the shapes' own boxes [m].
  double size_of_shapes(const SceneBody& what) {
    Aabb box;
    for (const ModelShape& shape : what.shapes) {
      const Aabb own = box_of(shape);
      for (int corner = 0; corner < 8; ++corner) {
        const auto pick = [&](int axis) { return (corner >> axis) % 2 == 0 ? own.min[axis] : own.max[axis]; };
        box.extend(shape.X_LS * Vec3(pick(0), pick(1), pick(2)));
      }
    }
    return (box.max - box.min).maxCoeff();
  }

  Aabb box_of(const ModelShape& shape) {
    const Vec3& s = shape.size;
    Vec3 half = 0.5 * s;
    switch (shape.kind) {
      case ModelShapeKind::kMesh: {
        const ModelMesh* mesh = meshes_.find(shape, log_);
        return mesh != nullptr ? mesh->box : Aabb{Vec3::Zero(), Vec3::Zero()};
      }
      case ModelShapeKind::kBall:
        half = Vec3::Constant(s.x());
        break;
      case ModelShapeKind::kEllipsoid:
        half = s;
        break;
      case ModelShapeKind::kCylinder:
        half = Vec3(s.x(), s.x(), 0.5 * s.y());
        break;
      case ModelShapeKind::kCapsule:
        half = Vec3(s.x(), s.x(), 0.5 * s.y() + s.x());
        break;
      case ModelShapeKind::kBox:
      case ModelShapeKind::kPlane:
        break;
    }
    return {-half, half};
  }

  const ImportModel& model_;
  const ImportChoices& choices_;
  ModelMeshes& meshes_;
  ImportLog& log_;
  std::vector<SceneBody> bodies_;
};

}  // namespace

WrittenScene write_scene(const ImportModel& model, const ImportChoices& choices, ModelMeshes& meshes,
                         ImportLog& log) {
  return SceneWriter(model, choices, meshes, log).write();
}

}  // namespace tactum::inline v0_1
