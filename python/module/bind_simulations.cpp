/// tactum.Simulation: a scene or a world that Python steps, or lets C++ step along a motion.

#include <pybind11/stl.h>

#include <algorithm>
#include <span>
#include <vector>

#include "stepping.h"

namespace tactum::python {
namespace {

using namespace pybind11::literals;

ContactRecord contact_record(const StepContact& contact) {
  ContactRecord out{};
  out.body_a = contact.body_a;
  out.body_b = contact.body_b;
  out.piece_a = contact.piece_a;
  out.piece_b = contact.piece_b;
  out.kind_a = static_cast<std::int32_t>(contact.a.kind);
  out.feature_a = contact.a.index;
  out.kind_b = static_cast<std::int32_t>(contact.b.kind);
  out.feature_b = contact.b.index;
  std::copy_n(contact.p_W.data(), 3, out.point);
  std::copy_n(contact.n_W.data(), 3, out.normal);
  out.distance_m = contact.distance_m;
  out.normal_force_N = contact.force_N;
  out.friction_N = contact.friction_N;
  out.friction_coefficient = contact.friction_coefficient;
  out.cone_used = contact.cone_used;
  out.grip = static_cast<std::int32_t>(contact.grip);
  out.patch = contact.patch;
  out.residual_m = contact.residual_m;
  return out;
}

py::array contacts_of(SteppedScene& scene) {
  const std::vector<StepContact>& contacts = scene.contacts();
  py::array_t<ContactRecord> out(static_cast<py::ssize_t>(contacts.size()));
  ContactRecord* record = out.mutable_data();
  for (const StepContact& contact : contacts) *record++ = contact_record(contact);
  return out;
}

DeviceSample sample_at(const Pose& X_DH) {
  DeviceSample sample;
  sample.X_DH = X_DH;
  sample.valid = true;
  return sample;
}

/// A hand's place in the scene, or an IndexError.
std::size_t hand_number(const SteppedScene& scene, std::size_t hand) {
  if (hand >= scene.hands()) throw py::index_error("there is no hand of this number");
  return hand;
}

/// Shapes of what is one for each hand: the axis of the hands is left out where there is one hand only.
std::vector<py::ssize_t> shape_by_hand(const SteppedScene& scene, std::initializer_list<py::ssize_t> before,
                                       std::initializer_list<py::ssize_t> of_each) {
  std::vector<py::ssize_t> shape(before);
  if (scene.hands() > 1) shape.push_back(static_cast<py::ssize_t>(scene.hands()));
  shape.insert(shape.end(), of_each);
  return shape;
}

/// The input of a frame: a sample or a pose (4, 4) of the only hand, a list or tuple with one for each hand, or
/// poses (hands, 4, 4).
std::vector<HandSample> samples_of(const py::object& given) {
  if (py::isinstance<DeviceSample>(given)) return {{given.cast<DeviceSample>()}};
  std::vector<HandSample> samples;
  if (py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given)) {
    const py::sequence each(given);
    if (std::any_of(each.begin(), each.end(),
                    [](const py::handle one) { return py::isinstance<DeviceSample>(one); })) {
      for (const py::handle one : each)
        samples.push_back(samples_of(py::reinterpret_borrow<py::object>(one)).front());
      return samples;
    }
  }
  const Array X_DH = Array::ensure(given);
  if (!X_DH) {
    PyErr_Clear();
    throw py::type_error("X_DH is neither a Sample, nor numbers of a pose, nor one of these for each hand");
  }
  if (X_DH.ndim() != 3) return {{sample_at(pose_of(X_DH, "X_DH"))}};
  for (py::ssize_t h = 0; h < X_DH.shape(0); ++h)
    samples.push_back({sample_at(pose_of(Array(X_DH[py::int_(h)]), "X_DH"))});
  return samples;
}

py::tuple step(SteppedScene& scene, const py::object& hands) {
  const std::vector<HandSample> samples = samples_of(hands);
  if (samples.size() != scene.hands())
    throw Refusal({"a step takes a pose or a sample for each hand", std::to_string(samples.size()),
                   std::to_string(scene.hands()), scene.name()});
  std::vector<Wrench> F_D(scene.hands());
  {
    const py::gil_scoped_release released;
    scene.step(samples, F_D);
  }
  Array wrenches(shape_by_hand(scene, {}, {6}));
  double* number = wrenches.mutable_data();
  for (const Wrench& F : F_D) {
    put(F, number);
    number += 6;
  }
  return py::make_tuple(wrenches, contacts_of(scene));
}

/// Reads a pose of 16 numbers in rows; returns where the next one begins.
const double* take_pose(const double* number, Pose& X) noexcept {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) X.R(row, column) = number[4 * row + column];
    X.p[row] = number[4 * row + 3];
  }
  return number + 16;
}

/// The wrenches of every frame of a motion, without Python in between.
Array run_along(SteppedScene& scene, const Array& X_DH) {
  const std::vector<py::ssize_t> wanted = shape_by_hand(scene, {X_DH.ndim() > 0 ? X_DH.shape(0) : 0}, {4, 4});
  if (!std::equal(wanted.begin(), wanted.end(), X_DH.shape(), X_DH.shape() + X_DH.ndim()))
    throw Refusal({"poses have another shape", shape_of(X_DH),
                   scene.hands() == 1 ? "(n, 4, 4)" : "(n, " + std::to_string(scene.hands()) + ", 4, 4)",
                   "X_DH"});
  Array out(shape_by_hand(scene, {X_DH.shape(0)}, {6}));
  double* wrench = out.mutable_data();
  const double* number = X_DH.data();
  std::vector<HandSample> samples(scene.hands(), {sample_at({})});
  std::vector<Wrench> F_D(scene.hands());
  const py::gil_scoped_release released;
  for (py::ssize_t i = 0; i < wanted.front(); ++i) {
    for (HandSample& sample : samples) number = take_pose(number, sample.X_DH);
    scene.step(samples, F_D);
    for (const Wrench& F : F_D) {
      put(F, wrench);
      wrench += 6;
    }
  }
  return out;
}

DeviceSample read_hand(SteppedScene& scene, std::size_t hand) {
  Device& device = scene.hand(hand_number(scene, hand));
  DeviceSample sample;
  const py::gil_scoped_release released;
  if (!device.read(scene.next_time_s(), sample)) sample.valid = false;
  return sample;
}

bool write_hand(SteppedScene& scene, const Array& F_D, std::size_t hand) {
  return scene.hand(hand_number(scene, hand)).write(wrench_of(F_D, "F_D"));
}

/// The wrenches of every frame in which the scene's own hands lead it, and the poses of the hands.
py::tuple follow_hand(SteppedScene& scene, std::uint64_t frames) {
  const auto rows = static_cast<py::ssize_t>(frames);
  Array wrenches(shape_by_hand(scene, {rows}, {6})), poses(shape_by_hand(scene, {rows}, {4, 4}));
  double* wrench = wrenches.mutable_data();
  double* pose = poses.mutable_data();
  {
    const py::gil_scoped_release released;
    HandDevices& hands = scene.devices();
    DeviceSample first;
    for (std::uint64_t i = 0; i < frames; ++i) {
      hands.read(scene.next_time_s(), first);
      scene.step(hands.samples(), hands.wrenches());
      for (std::size_t h = 0; h < hands.hands(); ++h, wrench += 6, pose += 16) {
        put(hands.wrenches()[h], wrench);
        put(hands.samples()[h].X_DH, pose);
      }
      hands.write(hands.largest());
    }
  }
  return py::make_tuple(wrenches, poses);
}

Array poses_of(const SteppedScene& scene) {
  const std::vector<Pose>& poses = scene.simulation().bodies().X_WB;
  Array out({static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
  double* number = out.mutable_data();
  for (const Pose& X_WB : poses) {
    put(X_WB, number);
    number += 16;
  }
  return out;
}

Array twists_of(const SteppedScene& scene) {
  const std::vector<Twist>& twists = scene.simulation().bodies().V_WB;
  Array out({static_cast<py::ssize_t>(twists.size()), py::ssize_t{6}});
  double* number = out.mutable_data();
  for (const Twist& V : twists) {
    put(Wrench{V.v, V.w}, number);
    number += 6;
  }
  return out;
}

py::dict report_of(const SteppedScene& scene) {
  const FrameReport& report = scene.simulation().report();
  return py::dict("index"_a = report.index, "time_s"_a = static_cast<double>(report.index) / scene.rate_Hz(),
                  "flags"_a = report.flags, "safety"_a = report.safety,
                  "grasped_body"_a = report.grasped_body, "penetrating"_a = report.penetrating,
                  "min_distance_m"_a = report.min_distance_m, "X_WH"_a = array_of(report.X_WH),
                  "X_WH_proxy"_a = array_of(report.X_WH_proxy), "F_W_contacts"_a = array_of(report.restoring),
                  "F_W_felt"_a = array_of(report.coupling), "solver_iterations"_a = report.solver_iterations,
                  "exact_tests"_a = report.tests());
}

/// What the report has of each hand.
std::vector<py::dict> hand_reports_of(const SteppedScene& scene) {
  std::vector<py::dict> reports;
  for (std::size_t h = 0; h < scene.hands(); ++h) {
    const HandReport& report =
        h == 0 ? scene.simulation().report() : scene.simulation().state().other_reports[h - 1];
    reports.push_back(py::dict("safety"_a = report.safety, "grasped_body"_a = report.grasped_body,
                               "X_WH"_a = array_of(report.X_WH), "X_WH_proxy"_a = array_of(report.X_WH_proxy),
                               "F_W_contacts"_a = array_of(report.restoring),
                               "F_W_felt"_a = array_of(report.coupling)));
  }
  return reports;
}

std::vector<std::string> devices_of(const SteppedScene& scene) {
  std::vector<std::string> names;
  for (std::size_t h = 0; h < scene.hands(); ++h) names.push_back(scene.hand(h).info().name);
  return names;
}

std::vector<std::string> names_of(const SteppedScene& scene) {
  std::vector<std::string> names;
  for (const Body& body : scene.simulation().world().bodies) names.push_back(body.name);
  return names;
}

/// Vertices in the body's frame and triangles; copies.
py::tuple mesh_of_body(const SteppedScene& scene, std::size_t body) {
  const std::vector<Body>& bodies = scene.simulation().world().bodies;
  if (body >= bodies.size()) throw py::index_error("there is no body of this number");
  const TriangleMesh& mesh = bodies[body].part->surface;
  Array vertices({static_cast<py::ssize_t>(mesh.vertices.size()), py::ssize_t{3}});
  py::array_t<std::int32_t> triangles({static_cast<py::ssize_t>(mesh.triangles.size()), py::ssize_t{3}});
  std::copy_n(mesh.vertices.front().data(), 3 * mesh.vertices.size(), vertices.mutable_data());
  std::copy_n(mesh.triangles.front().data(), 3 * mesh.triangles.size(), triangles.mutable_data());
  return py::make_tuple(vertices, triangles);
}

std::unique_ptr<SteppedScene> open_scene_of(const std::string& scene, const std::string& device,
                                            const std::vector<std::string>& other_devices,
                                            const std::string& grip, const std::string& response,
                                            const std::string& settings, double rate_Hz) {
  const py::gil_scoped_release released;
  return or_raise(SteppedScene::open(scene, {device, other_devices, grip, response, settings, rate_Hz}));
}

void bind_samples(py::module_& module) {
  py::class_<DeviceSample>(module, "Sample", "What a device measures in a frame.")
      .def(py::init([](const Array& X_DH, std::uint32_t buttons) {
             DeviceSample sample;
             sample.X_DH = pose_of(X_DH, "X_DH");
             sample.buttons = buttons;
             sample.valid = true;
             return sample;
           }),
           "X_DH"_a, "buttons"_a = 0)
      .def_property_readonly("X_DH", [](const DeviceSample& sample) { return array_of(sample.X_DH); })
      .def_property_readonly("V_DH",
                             [](const DeviceSample& sample) {
                               return array_of(Wrench{sample.V_DH.v, sample.V_DH.w});
                             })
      .def_readonly("buttons", &DeviceSample::buttons)
      .def_readonly("valid", &DeviceSample::valid);
}

}  // namespace

void bind_simulations(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(ContactRecord, body_a, body_b, piece_a, piece_b, kind_a, feature_a, kind_b, feature_b,
                       point, normal, distance_m, normal_force_N, friction_N, friction_coefficient, cone_used,
                       grip, patch, residual_m);
  module.attr("contact_dtype") = py::dtype::of<ContactRecord>();
  bind_samples(module);
  py::class_<SteppedScene>(module, "Simulation", "A scene or a world that its caller steps.")
      .def_static("_open", &open_scene_of, "scene"_a, "device"_a, "other_devices"_a, "grip"_a, "response"_a,
                  "settings"_a, "rate_Hz"_a)
      .def("step", &step, "X_DH"_a)
      .def("run", &run_along, "X_DH"_a)
      .def_property_readonly("hands", &SteppedScene::hands)
      .def("open_hand", [](SteppedScene& scene) { or_raise(scene.devices().open()); })
      .def("read_hand", &read_hand, "hand"_a = 0)
      .def("write_hand", &write_hand, "F_D"_a, "hand"_a = 0)
      .def("close_hand", [](SteppedScene& scene) { scene.devices().close(); })
      .def("follow_hand", &follow_hand, "frames"_a)
      .def_property_readonly("hand_frames", &SteppedScene::frames_of_hand)
      .def_property_readonly("device", [](const SteppedScene& scene) { return scene.hand().info().name; })
      .def_property_readonly("devices", &devices_of)
      .def_property_readonly("contacts", &contacts_of)
      .def_property_readonly("X_WB", &poses_of)
      .def_property_readonly("V_WB", &twists_of)
      .def_property_readonly("report", &report_of)
      .def_property_readonly("hand_reports", &hand_reports_of)
      .def_property_readonly("bodies", &names_of)
      .def("body_mesh", &mesh_of_body, "body"_a)
      .def_property_readonly("name", &SteppedScene::name)
      .def_property_readonly("frames",
                             [](const SteppedScene& scene) { return scene.simulation().next_index(); })
      .def_property_readonly("dt_s",
                             [](const SteppedScene& scene) { return scene.simulation().settings().dt_s; })
      .def_property_readonly("hash", [](const SteppedScene& scene) { return scene.record().hash(); });
}

}  // namespace tactum::python
