#include "tactum/import/scene_bodies.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>
#include <set>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kStandInRadius_m = 0.001;  // of a ball for a body without a shape that is felt

/// Makes the bodies of one model.
class BodyMaker {
 public:
  BodyMaker(const ImportModel& model, ImportLog& log)
      : model_(model), log_(log), X_WL_(model.links.size()), body_of_(model.links.size(), -1) {}

  std::vector<SceneBody> make() {
    for (int i = 0; i < static_cast<int>(model_.links.size()); ++i) add_link(i);
    for (SceneBody& body : bodies_) finish(body);
    std::vector<SceneBody> felt;
    std::vector<int> place(bodies_.size(), -1);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i].shapes.empty()) continue;
      place[i] = static_cast<int>(felt.size());
      if (bodies_[i].parent >= 0) bodies_[i].parent = place[static_cast<std::size_t>(bodies_[i].parent)];
      felt.push_back(std::move(bodies_[i]));
    }
    return felt;
  }

 private:
  const ModelLink& link(int i) const { return model_.links[static_cast<std::size_t>(i)]; }
  SceneBody& body(int i) { return bodies_[static_cast<std::size_t>(i)]; }
  bool moves(const SceneBody& what) const { return what.joint.kind != JointKind::kFixed; }

  /// A name that no other body has.
  std::string free_name(const std::string& wanted) {
    std::string name = wanted;
    for (int i = 2; !names_.insert(name).second; ++i) name = fmt::format("{} {}", wanted, i);
    return name;
  }

  void add_link(int i) {
    const ModelLink& what = link(i);
    const auto at = static_cast<std::size_t>(i);
    const Pose X_WP = what.parent < 0 ? Pose{} : X_WL_[static_cast<std::size_t>(what.parent)];
    X_WL_[at] = renormalized(X_WP * what.X_PL);
    const int below = what.parent < 0 ? -1 : body_of_[static_cast<std::size_t>(what.parent)];
    if (what.joint.kind == JointKind::kFixed && below >= 0 && moves(body(below))) return merge(i, below);
    if (what.joint.kind == JointKind::kFixed && what.at->name == "worldbody") return add_world(i);
    SceneBody made{.name = free_name(what.name.empty() ? fmt::format("body {}", i) : what.name),
                   .link = i,
                   .parent = jointed_to(what.parent),
                   .X_WP = X_WL_[at],
                   .inertial = what.inertial.value_or(ModelInertial{}),
                   .joint = started(what),
                   .shapes = what.shapes};
    made.X_WP = X_WL_[at] = moved_by(what, made.joint);
    body_of_[at] = static_cast<int>(bodies_.size());
    bodies_.push_back(std::move(made));
  }

  /// Each shape of the world is a body of its own.
  void add_world(int i) {
    int number = 0;
    for (const ModelShape& shape : link(i).shapes) {
      SceneBody made{.name = free_name(shape.name.empty() ? fmt::format("world {}", ++number) : shape.name),
                     .link = i,
                     .parent = -1,
                     .X_WP = X_WL_[static_cast<std::size_t>(i)],
                     .inertial = {},
                     .joint = {},
                     .shapes = {shape}};
      bodies_.push_back(std::move(made));
    }
  }

  void merge(int i, int below) {
    const auto at = static_cast<std::size_t>(i);
    body_of_[at] = below;
    SceneBody& into = body(below);
    const Pose X = X_WL_[static_cast<std::size_t>(into.link)].inverse() * X_WL_[at];
    if (link(i).inertial) into.inertial = together(into.inertial, placed(X, *link(i).inertial));
    for (ModelShape shape : link(i).shapes) {
      shape.X_LS = renormalized(X * shape.X_LS);
      into.shapes.push_back(std::move(shape));
    }
  }

  /// The body of the nearest link below that moves, or that has a shape that is felt; -1: the world.
  int jointed_to(int parent) {
    for (int i = parent; i >= 0; i = link(i).parent) {
      const int candidate = body_of_[static_cast<std::size_t>(i)];
      if (candidate < 0) continue;
      const SceneBody& what = body(candidate);
      const bool felt =
          std::any_of(what.shapes.begin(), what.shapes.end(), [](const ModelShape& s) { return s.felt; });
      if (moves(what) || felt) return candidate;
    }
    return -1;
  }

  /// The joint with its limits about the start: of one whose limits leave out the pose of the file, `rest`
  /// and the limits count from the nearest limit.
  ModelJoint started(const ModelLink& what) {
    ModelJoint joint = what.joint;
    start_ = 0.0;
    if (!joint.limits) return joint;
    start_ = std::clamp(0.0, joint.limits->lower, joint.limits->upper);
    joint.limits->lower -= start_;
    joint.limits->upper -= start_;
    joint.rest -= start_;
    if (start_ != 0.0)
      log_.note(*joint.at,
                fmt::format("the limits leave out the pose of the file: the joint starts at {:.6g} {}",
                            start_, joint.kind == JointKind::kSlider ? "m" : "rad"));
    return joint;
  }

  /// Where the link starts.
  Pose moved_by(const ModelLink& what, const ModelJoint& joint) const {
    const Pose& X = X_WL_[static_cast<std::size_t>(&what - model_.links.data())];
    if (start_ == 0.0) return X;
    const Vec3 axis = joint.axis.normalized();
    if (joint.kind == JointKind::kSlider) return X * Pose{Mat3::Identity(), start_ * axis};
    const Mat3 R = Eigen::AngleAxisd(start_, axis).toRotationMatrix();
    return renormalized(X * Pose{R, joint.anchor - R * joint.anchor});
  }

  /// Sorts shapes, checks the inertia, and moves all into the frame of the only shape.
  void finish(SceneBody& made) {
    std::erase_if(made.shapes, [](const ModelShape& shape) { return !shape.felt; });
    take_friction(made);
    if (moves(made)) check_inertial(made);
    if (log_.errors()) return;
    if (moves(made) && made.shapes.empty()) {
      ModelShape ball{.kind = ModelShapeKind::kBall, .size = {kStandInRadius_m, 0.0, 0.0}};
      ball.X_LS.p = made.inertial.center;
      ball.at = link(made.link).at;
      made.shapes.push_back(ball);
      log_.note(*ball.at,
                fmt::format("\"{}\" has no shape that is felt: a ball of 1 mm stands at its centre of mass",
                            made.name));
    }
    if (made.shapes.size() != 1) return;
    const Pose X_LP = made.shapes.front().X_LS, X_PL = X_LP.inverse();
    made.shapes.front().X_LS = {};
    made.X_WP = renormalized(made.X_WP * X_LP);
    made.inertial = placed(X_PL, made.inertial);
    made.joint.axis = X_PL.R * made.joint.axis;
    made.joint.anchor = X_PL * made.joint.anchor;
  }

  void take_friction(SceneBody& made) {
    for (const ModelShape& shape : made.shapes) {
      if (!shape.friction) continue;
      if (made.friction >= 0.0 && made.friction != *shape.friction)
        log_.note(*shape.at,
                  fmt::format("a body has one friction: \"{}\" has {:.6g} here as everywhere, not {:.6g}",
                              made.name, made.friction, *shape.friction));
      if (made.friction < 0.0) made.friction = *shape.friction;
    }
  }

  void check_inertial(const SceneBody& made) {
    const XmlElement& at = *link(made.link).at;
    if (!(made.inertial.mass_kg > 0.0))
      return log_.fail(at, fmt::format("\"{}\" moves and has no mass", made.name),
                       "no inertia, and no shape that weighs", "an inertia, or a shape");
    if (!made.inertial.inertia.allFinite() || !made.inertial.center.allFinite())
      return log_.fail(at, fmt::format("the inertia of \"{}\" is beyond all numbers", made.name), "", "less");
    const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(made.inertial.inertia).eigenvalues();
    if (!(moments[0] > 0.0 && moments[2] <= (moments[0] + moments[1]) * (1.0 + tolerances::kCentered)))
      log_.fail(at, fmt::format("no body has the inertia of \"{}\"", made.name),
                fmt::format("principal moments of {:.6g}, {:.6g} and {:.6g} kg m^2", moments[0], moments[1],
                            moments[2]),
                "moments above 0, none larger than the sum of the others");
  }

  const ImportModel& model_;
  ImportLog& log_;
  std::vector<Pose> X_WL_;
  std::vector<int> body_of_;  // of each link
  std::vector<SceneBody> bodies_;
  std::set<std::string> names_;
  double start_ = 0.0;  // of the joint that was looked at last
};

}  // namespace

std::vector<SceneBody> scene_bodies(const ImportModel& model, ImportLog& log) {
  return BodyMaker(model, log).make();
}

}  // namespace tactum::inline v0_1
