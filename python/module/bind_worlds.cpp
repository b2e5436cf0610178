/// tactum.World: bodies put together in code.

#include <pybind11/stl.h>

#include <optional>

#include "stepping.h"
#include "tactum/drivers/registry.h"
#include "tactum/embedding/part_query.h"
#include "tactum/haptics/materials.h"

namespace tactum::python {
namespace {

using namespace pybind11::literals;

/// A world that is not stepped yet; coefficients are of materials until all bodies are there.
struct WorldInTheMaking {
  World world;
  std::vector<MaterialPair> friction, restitution;

  int body_called(const std::string& name) const {
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (world.bodies[i].name == name) return static_cast<int>(i);
    throw Refusal({"there is no such body", name, "one of the bodies' names", "world"});
  }
};

JointKind kind_called(const std::string& name) {
  constexpr std::pair<const char*, JointKind> kKinds[] = {{"free", JointKind::kFree},
                                                          {"fixed", JointKind::kFixed},
                                                          {"hinge", JointKind::kHinge},
                                                          {"slider", JointKind::kSlider},
                                                          {"ball", JointKind::kBall}};
  for (const auto& [word, kind] : kKinds)
    if (name == word) return kind;
  throw Refusal({"no such joint", name, "free, fixed, hinge, slider or ball", "joint"});
}

Joint joint_of(const std::string& kind, const Array& axis_W, const Array& anchor_W, double damping,
               double friction, double stiffness, double rest, double lower, double upper) {
  return {.kind = kind_called(kind),
          .axis_W = vector_of(axis_W, "axis_W"),
          .anchor_W = vector_of(anchor_W, "anchor_W"),
          .damping = damping,
          .friction = friction,
          .stiffness = stiffness,
          .rest = rest,
          .lower = lower,
          .upper = upper};
}

/// The part of a body: that of the file, with its origin told.
std::shared_ptr<const Part> body_part(const QueriedPart& queried) {
  Part part = queried.file().part;
  part.origin = queried.file().origin;
  return std::make_shared<const Part>(std::move(part));
}

int add_body(WorldInTheMaking& making, const std::string& name, const QueriedPart& part, const Array& X_WP,
             const Joint& joint, const std::string& material, std::optional<double> mass_kg,
             std::optional<double> density, const Array& V_WB) {
  const Wrench twist = wrench_of(V_WB, "V_WB");
  return or_raise(making.world.add({.name = name,
                                    .part = body_part(part),
                                    .density_kg_per_m3 = density,
                                    .mass_kg = mass_kg,
                                    .X_WP = pose_of(X_WP, "X_WP"),
                                    .V_WB = {twist.f, twist.t},
                                    .joint = joint,
                                    .material = material}));
}

std::unique_ptr<SteppedScene> simulation_of(const WorldInTheMaking& making, const std::string& tool,
                                            const std::string& device_name, double rate_Hz,
                                            const std::optional<Array>& p_BH) {
  or_raise(check_rate(rate_Hz));
  std::unique_ptr<Device> device = or_raise(make_device(device_name, {}));
  FrameSettings settings = settings_for(device->info(), rate_Hz);
  if (!tool.empty()) settings.tool.body = making.body_called(tool);
  if (p_BH) settings.tool.X_BH.p = vector_of(*p_BH, "p_BH");
  for (const MaterialPair& pair : making.friction)
    or_raise(set_coefficient(making.world, pair, settings.friction));
  for (const MaterialPair& pair : making.restitution)
    or_raise(set_coefficient(making.world, pair, settings.impacts.restitution));
  return or_raise(SteppedScene::open(making.world, settings, std::move(device)));
}

}  // namespace

void bind_worlds(py::module_& module) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  py::class_<Joint>(module, "Joint", "How a body is held, by the world or by another body.")
      .def(py::init(&joint_of), "kind"_a, py::kw_only(), "axis_W"_a = array_of(Vec3(Vec3::UnitZ())),
           "anchor_W"_a = array_of(Vec3(Vec3::Zero())), "damping"_a = 0.0, "friction"_a = 0.0,
           "stiffness"_a = 0.0, "rest"_a = 0.0, "lower"_a = -kInfinite, "upper"_a = kInfinite);
  py::class_<WorldInTheMaking>(module, "World", "Bodies, put together in code.")
      .def(py::init([](const Array& gravity) {
             WorldInTheMaking making;
             making.world.gravity_W = vector_of(gravity, "gravity_W");
             return making;
           }),
           "gravity_W"_a = array_of(Vec3(Vec3::Zero())))
      .def("add", &add_body, "name"_a, "part"_a, "X_WP"_a = array_of(Pose{}), py::kw_only(),
           "joint"_a = Joint{}, "material"_a = "", "mass_kg"_a = py::none(),
           "density_kg_per_m3"_a = py::none(), "V_WB"_a = array_of(Wrench{}))
      .def(
          "join",
          [](WorldInTheMaking& making, const std::string& body, const std::string& parent, const Joint& joint,
             bool contact) {
            or_raise(making.world.join(making.body_called(body), making.body_called(parent), joint, contact));
          },
          "body"_a, "parent"_a, "joint"_a, "contact"_a = false)
      .def(
          "friction",
          [](WorldInTheMaking& making, const std::string& a, const std::string& b, double coefficient) {
            making.friction.push_back({a, b, coefficient});
          },
          "material_a"_a, "material_b"_a, "coefficient"_a)
      .def(
          "restitution",
          [](WorldInTheMaking& making, const std::string& a, const std::string& b, double coefficient) {
            making.restitution.push_back({a, b, coefficient});
          },
          "material_a"_a, "material_b"_a, "coefficient"_a)
      .def("simulate", &simulation_of, "tool"_a = "", py::kw_only(), "device"_a = "premium-1.5-6dof",
           "rate_Hz"_a = 1000.0, "p_BH"_a = py::none());
}

}  // namespace tactum::python
