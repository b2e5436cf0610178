#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "bench/peers/motion_peers.h"

namespace tactum::bench {
namespace {

using Index = std::size_t;

/// Contacts are springs and dampers there, so many steps long. Shorter ones, down to the two steps that its
/// manual allows, let a stack fall over.
constexpr double kStepsOfContact = 5.0;

std::string text_of(const Vec3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z()); }

std::string pose_text(const Pose& X) {
  const Eigen::Quaterniond q(X.R);
  return fmt::format("pos='{}' quat='{:.17g} {:.17g} {:.17g} {:.17g}'", text_of(X.p), q.w(), q.x(), q.y(),
                     q.z());
}

/// The attribute solref: a time and a fraction of critical damping, or, negative, stiffness and damping of a
/// unit mass.
std::string contact_text(double restitution, double step_s) {
  if (restitution == 0.0) return fmt::format("solref='{:.17g} 1'", kStepsOfContact * step_s);
  const double omega = kPi / (kStepsOfContact * step_s);
  const double decay = -std::log(restitution) * omega / kPi;
  return fmt::format("solref='{:.17g} {:.17g}'", -(omega * omega + decay * decay), -2.0 * decay);
}

/// A FreeMotion as a model of MuJoCo.
class Model {
 public:
  Model(const FreeMotion& motion, double step_s) {
    contact_ = contact_text(motion.restitution, step_s);
    contact_ += motion.friction > 0.0
                    ? fmt::format(" condim='3' friction='{:.17g} 0.005 0.0001'", motion.friction)
                    : std::string(" condim='1'");
    for (Index i = 0; i < motion.world.bodies.size(); ++i) add(motion, i);
    // Euler's method is nearer to the closed forms of contacts, that of Runge and Kutta to all others.
    const char* const integrator = motion.world.bodies.size() > 1 ? "Euler" : "RK4";
    text_ = fmt::format(
        "<mujoco><compiler angle='radian'/><size njmax='4000' nconmax='1000'/>"
        "<option timestep='{:.17g}' gravity='{}' integrator='{}' solver='Newton' iterations='200' "
        "tolerance='1e-12' cone='elliptic' "
        "impratio='100'/><asset>{}</asset><worldbody>{}</worldbody></mujoco>",
        step_s, text_of(motion.world.gravity_W), integrator, assets_, bodies_);
  }
  const std::string& text() const { return text_; }

 private:
  void add(const FreeMotion& motion, Index i) {
    const Body& body = motion.world.bodies[i];
    const Shape& shape = motion.shapes[i];
    std::string what;
    if (motion.ball_of(i) > 0.0) {
      what = fmt::format("type='sphere' size='{:.17g}'", motion.ball_of(i));
    } else if (shape.box_half_m) {
      what = fmt::format("type='box' size='{}'", text_of(*shape.box_half_m));
    } else {
      what = fmt::format("type='mesh' mesh='m{}'", i);
      assets_ += fmt::format("<mesh name='m{}' vertex='", i);
      for (const Vec3& v : shape.polytope.vertices) assets_ += text_of(v) + " ";
      assets_ += "'/>";
    }
    const std::string geometry =
        fmt::format("<geom name='g{}' {} {} solimp='0.9999 0.9999 0.0001'", i, what, contact_);
    if (!body.moves()) {
      bodies_ += fmt::format("{} {}/>", geometry, pose_text(body.X_WB));
      return;
    }
    std::string joint = "<freejoint/>";
    if (body.joint.kind == JointKind::kHinge)
      joint = fmt::format("<joint type='hinge' pos='{}' axis='{}'/>",
                          text_of(body.X_WB.inverse() * body.joint.anchor_W),
                          text_of(body.X_WB.R.transpose() * body.joint.axis_W));
    bodies_ += fmt::format(
        "<body name='b{}' {}>{}<inertial pos='0 0 0' mass='{:.17g}' diaginertia='{}'/>{}/></body>", i,
        pose_text(body.X_WB), joint, body.mass_kg, text_of(body.inertia_B.diagonal()), geometry);
  }

  std::string contact_, assets_, bodies_, text_;
};

mjModel* loaded(const std::string& text) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), "scene.xml")], text.data(), text.size());
  char error[1000] = "";
  mjModel* const model = mj_loadXML("scene.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::runtime_error(fmt::format("MuJoCo: {}", error));
  return model;
}

class MujocoMotion final : public MotionEngine {
 public:
  MujocoMotion(const FreeMotion& motion, double step_s) : start_(initial_state(motion.world)) {
    mju_user_warning = [](const char*) {};  // else into a file beside the program
    model_ = loaded(Model(motion, step_s).text());
    data_ = mj_makeData(model_);
    for (Index i = 0; i < motion.world.bodies.size(); ++i) {
      const Body& body = motion.world.bodies[i];
      geometries_.push_back(mj_name2id(model_, mjOBJ_GEOM, fmt::format("g{}", i).c_str()));
      bodies_.push_back(body.moves() ? mj_name2id(model_, mjOBJ_BODY, fmt::format("b{}", i).c_str()) : -1);
      if (!body.moves()) continue;
      mjtNum* const V = data_->qvel + model_->body_dofadr[bodies_.back()];
      if (is_free(i)) {
        const Vec3 w_B = body.X_WB.R.transpose() * body.V_WB.w;
        std::copy_n(body.V_WB.v.data(), 3, V);
        std::copy_n(w_B.data(), 3, V + 3);
      } else {
        *V = body.joint.axis_W.dot(body.V_WB.w);
      }
    }
    mj_forward(model_, data_);
  }
  ~MujocoMotion() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  void step() override {
    mj_step(model_, data_);
    mj_forward(model_, data_);  // poses and contact forces at the end of the step
  }
  WorldState state() const override {
    WorldState state = start_;
    for (Index i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i] < 0) continue;
      Pose& X_WB = state.X_WB[i];
      X_WB.p = Eigen::Map<const Vec3>(data_->xpos + 3 * bodies_[i]);
      X_WB.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->xmat + 9 * bodies_[i]);
      state.V_WB[i] = {};
      if (!is_free(i)) continue;
      const mjtNum* const V = data_->qvel + model_->body_dofadr[bodies_[i]];
      state.V_WB[i] = {Eigen::Map<const Vec3>(V), X_WB.R * Eigen::Map<const Vec3>(V + 3)};
    }
    return state;
  }
  double load_N(int fixed_body) const override {
    const int geometry = geometries_[Index(fixed_body)];
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < data_->ncon; ++i) {
      const mjContact& contact = data_->contact[i];
      if (contact.geom1 != geometry && contact.geom2 != geometry) continue;
      mjtNum force[6] = {};
      mj_contactForce(model_, data_, i, force);
      const Vec3 F = Eigen::Map<const Mat3>(contact.frame) * Eigen::Map<const Vec3>(force);
      sum += contact.geom1 == geometry ? F : Vec3(-F);
    }
    return sum.norm();
  }

 private:
  bool is_free(Index i) const { return model_->body_dofnum[bodies_[i]] == 6; }

  WorldState start_;
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::vector<int> geometries_, bodies_;
};

}  // namespace

std::unique_ptr<MotionEngine> make_mujoco_motion(const FreeMotion& motion, double step_s) {
  return std::make_unique<MujocoMotion>(motion, step_s);
}

}  // namespace tactum::bench
