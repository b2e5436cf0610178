/// tactum.World: bodies put together in code.

#include <pybind11/stl.h>

#include <limits>
#include <optional>
#include <variant>

#include "stepping.h"
#include "tactum/embedding/world_maker.h"

namespace tactum::python {
namespace {

using namespace pybind11::literals;

/// One text for the only hand, or one for each of several.
using Texts = std::variant<std::string, std::vector<std::string>>;

std::vector<std::string> texts_of(const Texts& texts) {
  if (const auto* one = std::get_if<std::string>(&texts)) return {*one};
  return std::get<std::vector<std::string>>(texts);
}

Joint joint_of(const std::string& kind, const Array& axis_W, const Array& anchor_W, double damping,
               double friction, double stiffness, double rest, double lower, double upper) {
  return {.kind = or_raise(joint_kind_called(kind)),
          .axis_W = vector_of(axis_W, "axis_W"),
          .anchor_W = vector_of(anchor_W, "anchor_W"),
          .damping = damping,
          .friction = friction,
          .stiffness = stiffness,
          .rest = rest,
          .lower = lower,
          .upper = upper};
}

int add_body(WorldMaker& maker, const std::string& name, const QueriedPart& part, const Array& X_WP,
             const Joint& joint, const std::string& material, std::optional<double> mass_kg,
             std::optional<double> density, const Array& V_WB) {
  const Wrench twist = wrench_of(V_WB, "V_WB");
  return or_raise(maker.world.add({.name = name,
                                   .part = body_part(part),
                                   .density_kg_per_m3 = density,
                                   .mass_kg = mass_kg,
                                   .X_WP = pose_of(X_WP, "X_WP"),
                                   .V_WB = {twist.f, twist.t},
                                   .joint = joint,
                                   .material = material}));
}

/// `tools` and `devices` are texts or lists of them, `p_BH` none, a vector, or a list of such: one for each
/// hand.
std::unique_ptr<SteppedScene> simulation_of(const WorldMaker& maker, const Texts& tools, const Texts& devices,
                                            double rate_Hz, const py::object& p_BH) {
  const std::vector<std::string> names = texts_of(tools), on = texts_of(devices);
  if (on.size() != 1 && on.size() != names.size())
    throw Refusal({"there is another number of devices than of tools", std::to_string(on.size()),
                   "1, or " + std::to_string(names.size()), "device"});
  std::vector<WorldTool> held;
  for (std::size_t h = 0; h < names.size(); ++h)
    held.push_back({.body = names[h], .device = on[on.size() == 1 ? 0 : h], .p_BH = {}});
  if (!p_BH.is_none() && std::holds_alternative<std::string>(tools)) {
    held.front().p_BH = vector_of(p_BH.cast<Array>(), "p_BH");
  } else if (!p_BH.is_none()) {
    const auto places = p_BH.cast<std::vector<std::optional<Array>>>();
    if (places.size() != held.size())
      throw Refusal({"there is another number of places than of tools", std::to_string(places.size()),
                     std::to_string(held.size()), "p_BH"});
    for (std::size_t h = 0; h < held.size(); ++h)
      if (places[h]) held[h].p_BH = vector_of(*places[h], "p_BH");
  }
  return or_raise(maker.simulate(held, rate_Hz));
}

}  // namespace

void bind_worlds(py::module_& module) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  py::class_<Joint>(module, "Joint", "How a body is held, by the world or by another body.")
      .def(py::init(&joint_of), "kind"_a, py::kw_only(), "axis_W"_a = array_of(Vec3(Vec3::UnitZ())),
           "anchor_W"_a = array_of(Vec3(Vec3::Zero())), "damping"_a = 0.0, "friction"_a = 0.0,
           "stiffness"_a = 0.0, "rest"_a = 0.0, "lower"_a = -kInfinite, "upper"_a = kInfinite);
  py::class_<WorldMaker>(module, "World", "Bodies, put together in code.")
      .def(py::init([](const Array& gravity) {
             WorldMaker maker;
             maker.world.gravity_W = vector_of(gravity, "gravity_W");
             return maker;
           }),
           "gravity_W"_a = array_of(Vec3(Vec3::Zero())))
      .def("add", &add_body, "name"_a, "part"_a, "X_WP"_a = array_of(Pose{}), py::kw_only(),
           "joint"_a = Joint{}, "material"_a = "", "mass_kg"_a = py::none(),
           "density_kg_per_m3"_a = py::none(), "V_WB"_a = array_of(Wrench{}))
      .def(
          "join",
          [](WorldMaker& maker, const std::string& body, const std::string& parent, const Joint& joint,
             bool contact) { or_raise(maker.join(body, parent, joint, contact)); },
          "body"_a, "parent"_a, "joint"_a, "contact"_a = false)
      .def(
          "friction",
          [](WorldMaker& maker, const std::string& a, const std::string& b, double coefficient) {
            maker.friction.push_back({a, b, coefficient});
          },
          "material_a"_a, "material_b"_a, "coefficient"_a)
      .def(
          "restitution",
          [](WorldMaker& maker, const std::string& a, const std::string& b, double coefficient) {
            maker.restitution.push_back({a, b, coefficient});
          },
          "material_a"_a, "material_b"_a, "coefficient"_a)
      .def("simulate", &simulation_of, "tool"_a = "", py::kw_only(), "device"_a = "premium-1.5-6dof",
           "rate_Hz"_a = 1000.0, "p_BH"_a = py::none());
}

}  // namespace tactum::python
