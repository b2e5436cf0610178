#pragma once
/// Tactum for programs in C++17: the C interface (tactum_c.h) with handles that release themselves and errors
/// as exceptions. Header only; link libtactum_c. docs/c-api.md shows it.
///
///   auto scene = tactum_client::Scene::open("gears");
///   const tactum_frame frame = scene.step(X_DH);            frame.F_D: the wrench on the hand
///
/// SceneDevice has the shape of the devices of haptic libraries, so that a host written for one can try a
/// scene of ours without a device. Units, frames and thread rules are those of tactum_c.h.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tactum/embedding/tactum_c.h"

namespace tactum_client {

/// A call that was refused: what was found, what was expected and where.
class Error : public std::runtime_error {
 public:
  Error(tactum_status status, const std::string& sentence) : std::runtime_error(sentence), status_(status) {}
  tactum_status status() const noexcept { return status_; }

 private:
  tactum_status status_;
};

/// Throws Error where the call that gave this status in this thread was refused.
inline void check(tactum_status status) {
  if (status != TACTUM_OK) throw Error(status, tactum_last_error());
}

/// A struct of tactum_c.h, zero but for its size.
template <class Sized>
Sized sized() {
  Sized made{};
  made.struct_size = sizeof(Sized);
  return made;
}

/// A part; may be moved, not copied. A part that was moved from may only be assigned to or destroyed.
class Part {
 public:
  /// A prepared part, or a mesh file, which is prepared then. `options` may be null. Slow.
  static Part load(const std::string& path, const tactum_part_options* options = nullptr) {
    tactum_part* part = nullptr;
    check(tactum_load_part(path.c_str(), options, &part));
    return Part(part);
  }
  /// Of a mesh in memory: corners [m], and three of them for each triangle, counter-clockwise from outside.
  static Part make(const std::vector<std::array<double, 3>>& vertices,
                   const std::vector<std::array<std::int32_t, 3>>& triangles,
                   const tactum_part_options* options = nullptr) {
    tactum_part* part = nullptr;
    check(tactum_make_part(vertices.empty() ? nullptr : vertices.front().data(), vertices.size(),
                           triangles.empty() ? nullptr : triangles.front().data(), triangles.size(), options,
                           &part));
    return Part(part);
  }
  void save(const std::string& path) const { check(tactum_save_part(handle(), path.c_str())); }
  std::string name() const { return tactum_part_name(handle()); }
  /// Of its preparation, as JSON.
  std::string report() const { return tactum_part_report(handle()); }
  tactum_part_info info() const {
    auto info = sized<tactum_part_info>();
    check(tactum_inspect_part(handle(), &info));
    return info;
  }
  /// The surface, as long as the part lives.
  tactum_mesh_view mesh() const {
    auto view = sized<tactum_mesh_view>();
    check(tactum_part_mesh(handle(), &view));
    return view;
  }
  const tactum_part* handle() const noexcept { return part_.get(); }

 private:
  struct Release {
    void operator()(tactum_part* part) const noexcept { tactum_release_part(part); }
  };
  explicit Part(tactum_part* part) noexcept : part_(part) {}
  std::unique_ptr<tactum_part, Release> part_;
};

/// Exact clearance of two surfaces; zero where they touch or cross.
inline tactum_distance clearance(const Part& a, const tactum_pose& X_WA, const Part& b,
                                 const tactum_pose& X_WB) {
  auto distance = sized<tactum_distance>();
  check(tactum_clearance(a.handle(), &X_WA, b.handle(), &X_WB, &distance));
  return distance;
}
/// Signed distance of two parts of solid pieces.
inline tactum_distance signed_distance(const Part& a, const tactum_pose& X_WA, const Part& b,
                                       const tactum_pose& X_WB) {
  auto distance = sized<tactum_distance>();
  check(tactum_signed_distance(a.handle(), &X_WA, b.handle(), &X_WB, &distance));
  return distance;
}

/// A scene that is stepped; may be moved, not copied. One that was moved from may only be assigned to or
/// destroyed.
class Scene {
 public:
  /// By name or file. `options` may be null. Slow.
  static Scene open(const std::string& name_or_file, const tactum_scene_options* options = nullptr) {
    tactum_simulation* scene = nullptr;
    check(tactum_open_scene(name_or_file.c_str(), options, &scene));
    return Scene(scene);
  }
  /// Of the text of a scene file; meshes are searched in `folder`.
  static Scene open_text(const std::string& toml, const std::string& folder = "",
                         const tactum_scene_options* options = nullptr) {
    tactum_simulation* scene = nullptr;
    check(tactum_open_scene_text(toml.c_str(), folder.empty() ? nullptr : folder.c_str(), options, &scene));
    return Scene(scene);
  }

  /// One frame with the hand at X_DH; the first pose is where it takes hold.
  tactum_frame step(const tactum_pose& X_DH) {
    auto frame = sized<tactum_frame>();
    check(tactum_step_pose(handle(), &X_DH, &frame));
    return frame;
  }
  /// The same with all that a device measures.
  tactum_frame step(const tactum_sample& sample) {
    auto frame = sized<tactum_frame>();
    check(tactum_step_sample(handle(), &sample, &frame));
    return frame;
  }
  /// Of the last frame.
  std::vector<tactum_contact> contacts() {
    std::size_t count = 0;
    check(tactum_contacts(handle(), sizeof(tactum_contact), nullptr, 0, &count));
    std::vector<tactum_contact> all(count);
    check(tactum_contacts(handle(), sizeof(tactum_contact), all.data(), all.size(), &count));
    return all;
  }
  std::int32_t bodies() const { return tactum_body_count(handle()); }
  std::string body_name(std::int32_t body) const { return tactum_body_name(handle(), body); }
  tactum_body body(std::int32_t body) const {
    auto out = sized<tactum_body>();
    check(tactum_get_body(handle(), body, &out));
    return out;
  }
  std::int32_t hands() const { return tactum_hand_count(handle()); }
  /// One frame of a scene with any number of hands: a sample for each; returns the wrench on each.
  std::vector<tactum_wrench> step(const std::vector<tactum_sample>& samples) {
    std::vector<tactum_wrench> F_D(samples.size());
    check(tactum_step_hands(handle(), sizeof(tactum_sample), samples.data(), samples.size(), F_D.data(),
                            nullptr));
    return F_D;
  }
  /// The handle, for all other calls of tactum_c.h.
  tactum_simulation* handle() const noexcept { return scene_.get(); }

 private:
  friend class World;
  struct Close {
    void operator()(tactum_simulation* scene) const noexcept { tactum_close_scene(scene); }
  };
  explicit Scene(tactum_simulation* scene) noexcept : scene_(scene) {}
  std::unique_ptr<tactum_simulation, Close> scene_;
};

/// Bodies, put together call by call; may be moved, not copied.
class World {
 public:
  /// [m/s^2]
  explicit World(const std::array<double, 3>& gravity_W = {}) {
    tactum_world* world = nullptr;
    check(tactum_make_world(gravity_W.data(), &world));
    world_.reset(world);
  }
  /// Adds a body and returns its number. The part is copied.
  std::int32_t add(const Part& part, const tactum_pose& X_WP, const tactum_body_options* options = nullptr) {
    std::int32_t body = -1;
    check(tactum_add_body(handle(), part.handle(), &X_WP, options, &body));
    return body;
  }
  void join(const std::string& body, const std::string& parent, const tactum_joint& joint,
            bool contact = false) {
    check(tactum_join_bodies(handle(), body.c_str(), parent.c_str(), &joint, contact ? 1 : 0));
  }
  void friction(const std::string& material_a, const std::string& material_b, double coefficient) {
    check(tactum_set_friction(handle(), material_a.c_str(), material_b.c_str(), coefficient));
  }
  void restitution(const std::string& material_a, const std::string& material_b, double coefficient) {
    check(tactum_set_restitution(handle(), material_a.c_str(), material_b.c_str(), coefficient));
  }
  /// A scene of the world as it is now, with a hand for each tool. Slow.
  Scene simulate(const std::vector<tactum_tool>& tools, double rate_Hz = 0.0) const {
    tactum_simulation* scene = nullptr;
    check(tactum_open_world(handle(), sizeof(tactum_tool), tools.data(), tools.size(), rate_Hz, &scene));
    return Scene(scene);
  }
  tactum_world* handle() const noexcept { return world_.get(); }

 private:
  struct Release {
    void operator()(tactum_world* world) const noexcept { tactum_release_world(world); }
  };
  std::unique_ptr<tactum_world, Release> world_;
};

/// The hand of a scene as the device of a host: a host asks in each cycle where the handle is, and then sets
/// a force. The cycle is a frame of the scene, 1 / rate_Hz long, whatever the clock says: asking begins it,
/// setting the force ends it. The handle is pushed by the sum of the host's force and, where `feels_scene`,
/// the scene's: so a host with an empty world of its own feels the scene, and one with a world of its own has
/// a simulated hand that its forces move. Vectors have the axes of D: x towards the operator, y to the
/// operator's right, z up, as CHAI3D's have. Calls return false where they were refused, and trouble() says
/// why. One thread at a time.
class SceneDevice {
 public:
  using Vector = std::array<double, 3>;
  using Matrix = std::array<double, 9>;  ///< row by row

  /// The simulated device of a scene, by its name or file: a host's forces pass no safety stage, so that a
  /// real device is none for this. Throws Error. Slow.
  explicit SceneDevice(const std::string& name_or_file, bool feels_scene = true)
      : scene_(Scene::open(name_or_file)), feels_scene_(feels_scene) {}

  // NOLINTBEGIN(readability-identifier-naming): the names that hosts of such devices call.
  bool open() { return is_open_ = done(tactum_open_hand(scene_.handle())); }
  bool close() {
    if (is_open_) tactum_close_hand(scene_.handle());
    is_open_ = has_sample_ = false;
    return true;
  }
  /// [m]
  bool getPosition(Vector& p) {
    if (!ask()) return false;
    for (std::size_t i = 0; i < 3; ++i) p[i] = sample_.X_DH.p[i];
    return true;
  }
  bool getRotation(Matrix& R) {
    if (!ask()) return false;
    for (std::size_t i = 0; i < 9; ++i) R[i] = sample_.X_DH.R[i];
    return true;
  }
  /// [m/s]
  bool getLinearVelocity(Vector& v) {
    if (!ask()) return false;
    for (std::size_t i = 0; i < 3; ++i) v[i] = sample_.V_DH.v[i];
    return true;
  }
  /// [rad/s]
  bool getAngularVelocity(Vector& w) {
    if (!ask()) return false;
    for (std::size_t i = 0; i < 3; ++i) w[i] = sample_.V_DH.w[i];
    return true;
  }
  /// Whether this switch is pressed; 0 is the primary one.
  bool getUserSwitch(int number) {
    return number >= 0 && number < 32 && ask() && ((sample_.buttons >> number) & 1u) != 0;
  }
  /// Ends the cycle: the hand is pushed by this [N, N m]. It has no gripper, whose force [N] must be zero.
  bool setForceAndTorqueAndGripperForce(const Vector& f, const Vector& t, double gripper_N) {
    if (gripper_N != 0.0) return refuse("the hand of a scene has no gripper: its force must be zero");
    if (!ask()) return false;
    tactum_wrench F_D{};
    if (feels_scene_) F_D = frame_.F_D;
    for (std::size_t i = 0; i < 3; ++i) {
      F_D.f[i] += f[i];
      F_D.t[i] += t[i];
    }
    has_sample_ = false;
    return done(tactum_write_hand(scene_.handle(), &F_D));
  }
  bool setForce(const Vector& f) { return setForceAndTorqueAndGripperForce(f, {}, 0.0); }
  // NOLINTEND(readability-identifier-naming)

  const std::string& trouble() const noexcept { return trouble_; }
  Scene& scene() noexcept { return scene_; }
  /// Of the cycle.
  const tactum_frame& frame() const noexcept { return frame_; }

 private:
  bool refuse(const char* sentence) {
    trouble_ = sentence;
    return false;
  }
  bool done(tactum_status status) { return status == TACTUM_OK || refuse(tactum_last_error()); }
  /// Begins a cycle where none has begun.
  bool ask() {
    if (has_sample_) return true;
    if (!is_open_) return refuse("the device is not open");
    if (!done(tactum_read_hand(scene_.handle(), &sample_))) return false;
    return has_sample_ = done(tactum_step_sample(scene_.handle(), &sample_, &frame_));
  }

  Scene scene_;
  bool feels_scene_, is_open_ = false, has_sample_ = false;
  tactum_sample sample_ = sized<tactum_sample>();
  tactum_frame frame_ = sized<tactum_frame>();
  std::string trouble_;
};

}  // namespace tactum_client
