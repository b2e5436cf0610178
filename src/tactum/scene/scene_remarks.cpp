#include "tactum/scene/scene_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/scene/fit_remarks.h"
#include "tactum/scene/item_errors.h"
#include "tactum/scene/start_distance.h"

namespace tactum::inline v0_1 {
namespace {

// What a person holds in front of a device is a few millimetres to a metre long.
constexpr double kLargestGrasped_m = 2.0;
constexpr double kLargestBody_m = 20.0;  // of the others: a floor may be larger than what is held
constexpr double kSmallestGrasped_m = 2e-4;
constexpr double kDensest = 30'000.0;       // osmium has 22 600 kg/m^3
constexpr double kLightest = 1.0;           // air has 1.2 kg/m^3
constexpr double kLeastAcceleration = 0.1;  // from the device's largest force: a second for 50 mm [m/s^2]
constexpr double kStiffestSlider = 1e7;     // [N/m]: a steel rod of 10 mm, a metre long, has 1.6e7
constexpr double kStiffestHinge = 1e6;      // [N m/rad]
constexpr std::size_t kMostOverlaps = 10;   // that are named one by one

std::string sizes_text(const Vec3& size_m) {
  if (size_m.maxCoeff() >= 1.0)
    return fmt::format("{:.3g} x {:.3g} x {:.3g} m", size_m.x(), size_m.y(), size_m.z());
  return fmt::format("{:.3g} x {:.3g} x {:.3g} mm", size_m.x() * 1e3, size_m.y() * 1e3, size_m.z() * 1e3);
}

std::string mass_text(double mass_kg) {
  if (mass_kg >= 1.0) return fmt::format("{:.3g} kg", mass_kg);
  return mass_kg >= 1e-3 ? fmt::format("{:.3g} g", mass_kg * 1e3) : fmt::format("{:.3g} mg", mass_kg * 1e6);
}

double longest(const Body& body) {
  const Aabb box = bounds(body.part->surface.vertices);
  return (box.max - box.min).maxCoeff();
}

/// Makes the remarks on one scene.
class Remarks {
 public:
  Remarks(const SceneDescription& description, const Scene& scene)
      : description_(description),
        scene_(scene),
        world_(scene.world),
        scale_(scene.settings.workspace.scale) {
    if (const Result<SimulatedDeviceModel> device = simulated_device_preset(scene.device)) device_ = *device;
  }

  std::vector<SceneRemark> all() {
    const int grasped = scene_.settings.tool.body;
    size_of_scene();
    for (const Body& body : world_.bodies)
      if (is_grasped(body)) size_of_grasped(body);
    for (const std::string& remark : scene_.remarks) note(remark);
    meshes_without_scale();
    for (const Body& body : world_.bodies) body_alone(body);
    for (const std::string& remark : fit_remarks(description_)) warn(remark);
    overlaps();
    if (grasped >= 0) {
      nearest_to_grasped(grasped);
    } else {
      empty_hand();
    }
    std::stable_partition(remarks_.begin(), remarks_.end(), [](const SceneRemark& r) { return !r.warning; });
    return std::move(remarks_);
  }

 private:
  void note(std::string text) { remarks_.push_back({false, std::move(text)}); }
  void warn(std::string text) { remarks_.push_back({true, std::move(text)}); }
  int number_of(const Body& body) const { return static_cast<int>(&body - world_.bodies.data()); }
  bool is_grasped(const Body& body) const {
    for (std::size_t h = 0; h < scene_.settings.hands(); ++h)
      if (number_of(body) == scene_.settings.hand(h).tool.body) return true;
    return false;
  }
  /// "the held part "peg"", "the body "block"".
  std::string called(const Body& body) const {
    return fmt::format("the {} \"{}\"", is_grasped(body) ? "held part" : "body", body.name);
  }

  void size_of_scene();
  void size_of_grasped(const Body& body);
  void meshes_without_scale();
  void mesh_without_scale(const std::string& path, const std::string& body, const Body& made);
  void body_alone(const Body& body);
  void mass(const Body& body);
  void spring(const Body& body);
  void overlaps();
  void nearest_to_grasped(int grasped);
  void empty_hand();

  const SceneDescription& description_;
  const Scene& scene_;
  const World& world_;
  double scale_;
  SimulatedDeviceModel device_;
  std::vector<std::string> unit_doubted_;  // bodies whose mesh has a remark about its unit already
  bool overlaps_grasped_ = false;
  std::vector<SceneRemark> remarks_;
};

void Remarks::size_of_scene() {
  Aabb box;
  std::size_t moving = 0;
  for (const Body& body : world_.bodies) {
    box.extend(box_at_start(body));
    moving += body.moves() ? 1 : 0;
  }
  note(fmt::format("the scene is {} large; {} {}, {} of them can move", sizes_text(box.max - box.min),
                   world_.bodies.size(), world_.bodies.size() == 1 ? "body" : "bodies", moving));
}

void Remarks::size_of_grasped(const Body& body) {
  const Aabb box = bounds(body.part->surface.vertices);
  note(fmt::format("{} is {} large and weighs {}", called(body), sizes_text(box.max - box.min),
                   mass_text(body.mass_kg)));
}

void Remarks::meshes_without_scale() {
  for (std::size_t b = 0; b < description_.bodies.size(); ++b) {
    const BodyDescription& body = description_.bodies[b];
    const Body& made = world_.bodies[b];
    const std::string path = item_path("", "body", b);
    const auto look = [&](const std::optional<PartDescription>& part, const std::string& owner) {
      const MeshPart* mesh = part ? std::get_if<MeshPart>(&*part) : nullptr;
      if (mesh != nullptr && !mesh->scale && !mesh->mesh.ends_with(".tactum"))
        mesh_without_scale(item_path(item_path(owner, "part"), "mesh"), mesh->mesh, made);
    };
    look(body.part, path);
    for (std::size_t c = 0; c < body.components.size(); ++c)
      look(body.components[c].part, item_path(path, "component", c));
  }
}

/// A mesh without `scale` counts in metres; its size says whether that can be so.
void Remarks::mesh_without_scale(const std::string& path, const std::string& file, const Body& made) {
  const UnitGuess guess = guess_unit(bounds(made.part->surface.vertices));
  const double size = longest(made);
  if (guess.metres_per_unit == 1.0 || size <= kLargestGrasped_m * scale_) return;
  unit_doubted_.push_back(made.name);
  warn(
      fmt::format("the mesh \"{0}\" of {1} is {2} long, since it has no `scale`; if it is in {3}, write "
                  "part = {{ mesh = \"{0}\", scale = {4} }} ({5})",
                  file, called(made), length_text(size), guess.name, guess.metres_per_unit,
                  description_.source.where(path)));
}

void Remarks::body_alone(const Body& body) {
  // Where the unit is wrong the mass is too, and one remark is enough.
  if (std::find(unit_doubted_.begin(), unit_doubted_.end(), body.name) != unit_doubted_.end()) return;
  const double size = longest(body);
  if (size > (is_grasped(body) ? kLargestGrasped_m : kLargestBody_m) * scale_)
    return warn(fmt::format("{} is {} long; are its sizes in millimetres? Lengths in a scene are metres",
                            called(body), length_text(size)));
  if (is_grasped(body) && size < kSmallestGrasped_m * scale_)
    warn(fmt::format("{} is {} long, too small to be felt; lengths in a scene are metres", called(body),
                     length_text(size)));
  if (!body.moves()) return;
  mass(body);
  spring(body);
}

void Remarks::mass(const Body& body) {
  const MassProperties& solid = body.part->mass;
  const double density = solid.volume > 0.0 ? body.mass_kg / solid.volume : 0.0;
  const bool exact = solid.approximation.empty() && density > 0.0;
  if (exact && density > kDensest)
    return warn(fmt::format("{} weighs {}, {:.2g} kg/m^3; the densest metal has 22 600", called(body),
                            mass_text(body.mass_kg), density));
  if (exact && density < kLightest)
    return warn(fmt::format("{} weighs {}, {:.2g} kg/m^3; that is lighter than air", called(body),
                            mass_text(body.mass_kg), density));
  if (!is_grasped(body) || !(device_.max_force_N > 0.0)) return;
  const double weight = body.mass_kg * world_.gravity_W.norm();
  const bool carried = world_.joint_of(number_of(body)).kind != JointKind::kFree;
  if (!carried && weight > device_.max_force_N)
    warn(fmt::format("the weight of {} is {:.3g} N; the device {} exerts {:.3g} N at most", called(body),
                     weight, device_.name, device_.max_force_N));
  else if (device_.max_force_N < kLeastAcceleration * body.mass_kg)
    warn(fmt::format("{} weighs {}: the largest force of the device {}, {:.3g} N, hardly moves it",
                     called(body), mass_text(body.mass_kg), device_.name, device_.max_force_N));
}

void Remarks::spring(const Body& body) {
  const Joint& joint = world_.joint_of(number_of(body));
  const bool slides = joint.kind == JointKind::kSlider;
  if (joint.stiffness > (slides ? kStiffestSlider : kStiffestHinge))
    warn(fmt::format(
        "the spring of the joint of {} has {:.3g} {}, stiffer than any spring; a joint of the kind "
        "\"fixed\" holds a body in its place",
        called(body), joint.stiffness, slides ? "N/m" : "N m/rad"));
}

void Remarks::overlaps() {
  const std::vector<BodyOverlap> found = overlaps_at_start(world_, tolerances::kSkin * std::max(1.0, scale_));
  const auto name = [&](int body) { return world_.bodies[static_cast<std::size_t>(body)].name; };
  for (std::size_t i = 0; i < found.size(); ++i) {
    const BodyOverlap& pair = found[i];
    const int grasped = scene_.settings.tool.body;
    overlaps_grasped_ = overlaps_grasped_ || (grasped >= 0 && (pair.a == grasped || pair.b == grasped));
    if (i < kMostOverlaps)
      warn(fmt::format("\"{}\" and \"{}\" overlap at the start: they are {} inside each other", name(pair.a),
                       name(pair.b), length_text(pair.depth_m)));
  }
  if (found.size() > kMostOverlaps)
    warn(fmt::format("{} more pairs of bodies overlap at the start", found.size() - kMostOverlaps));
}

void Remarks::nearest_to_grasped(int grasped) {
  const Body& body = world_.bodies[static_cast<std::size_t>(grasped)];
  const NearestBody nearest = nearest_at_start(world_, grasped);
  const bool free = world_.joint_of(grasped).kind == JointKind::kFree;
  if (nearest.body < 0) {
    if (free && world_.fields.empty())
      warn("there is nothing to touch: the scene has no other body and no field");
    return;
  }
  const std::string& name = world_.bodies[static_cast<std::size_t>(nearest.body)].name;
  if (!overlaps_grasped_)
    note(fmt::format("{} is {} from the nearest body, \"{}\"", called(body), length_text(nearest.distance_m),
                     name));
  // The handle can go from where it starts to the far side of the workspace.
  const Workspace& workspace = scene_.settings.workspace;
  const Vec3 handle_W = body.X_WB * scene_.settings.tool.X_BH.p;
  const double farthest = device_.workspace_radius_m * scale_ + (handle_W - workspace.X_WD.p).norm();
  if (free && world_.fields.empty() && nearest.distance_m > farthest)
    warn(
        fmt::format("nothing is within reach of the held part: the nearest body, \"{}\", is {} away, and the "
                    "device {} moves it by {} at most",
                    name, length_text(nearest.distance_m), device_.name, length_text(farthest)));
}

void Remarks::empty_hand() {
  if (!scene_.settings.tool.picks)
    return warn("nothing is held: the scene has no [tool], so nothing is felt");
  const Vec3& middle = scene_.settings.workspace.X_WD.p;
  const NearestBody nearest = nearest_to(world_, middle);
  if (nearest.body < 0) return warn("there is nothing to pick: no body of the scene moves");
  const double farthest = device_.workspace_radius_m * scale_ + scene_.settings.tool.pick_distance_m;
  if (nearest.distance_m > farthest)
    warn(fmt::format(
        "nothing is within reach of the hand: the nearest body that moves, \"{}\", is {} from the "
        "middle of the workspace, whose radius is {}",
        world_.bodies[static_cast<std::size_t>(nearest.body)].name, length_text(nearest.distance_m),
        length_text(device_.workspace_radius_m * scale_)));
}

}  // namespace

std::vector<SceneRemark> remarks_on(const SceneDescription& description, const Scene& scene) {
  return Remarks(description, scene).all();
}

}  // namespace tactum::inline v0_1
