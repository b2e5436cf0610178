#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>

#include "bench/peers/peers.h"

namespace tactum::bench {
namespace {

using Boxd = fcl::Box<double>;
using Convexd = fcl::Convex<double>;

fcl::Transform3<double> transform(const Pose& X) {
  fcl::Transform3<double> T = fcl::Transform3<double>::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T.matrix()(i, j) = X.R(i, j);
    T.matrix()(i, 3) = X.p(i);
  }
  return T;
}

std::unique_ptr<Convexd> convex(const Polytope& P) {
  auto vertices = std::make_shared<std::vector<fcl::Vector3<double>>>();
  for (const Vec3& v : P.vertices) vertices->emplace_back(v.x(), v.y(), v.z());
  auto faces = std::make_shared<std::vector<int>>();
  for (const Polytope::Face& face : P.faces) {
    faces->push_back(face.count);
    for (int i = 0; i < face.count; ++i)
      faces->push_back(P.face_vertices[static_cast<std::size_t>(face.first + i)]);
  }
  return std::make_unique<Convexd>(vertices, static_cast<int>(P.faces.size()), faces);
}

/// With their own 1e-6, and with 1e-7, the solvers are off by up to a millimetre; this costs them a few
/// percent.
constexpr double kTolerance_m = 1e-9;

void set_up(fcl::detail::GJKSolver_indep<double>& solver) {
  solver.gjk_tolerance = kTolerance_m;
  solver.enable_cached_guess = true;
}
void set_up(fcl::detail::GJKSolver_libccd<double>& solver) { solver.distance_tolerance = kTolerance_m; }
void reset(fcl::detail::GJKSolver_indep<double>& solver) { solver.cached_guess = {1.0, 0.0, 0.0}; }
void reset(fcl::detail::GJKSolver_libccd<double>&) {}
/// FCL keeps the direction it ended with and starts the next search from its opposite.
void turn_guess(fcl::detail::GJKSolver_indep<double>& solver) { solver.cached_guess = -solver.cached_guess; }
void turn_guess(fcl::detail::GJKSolver_libccd<double>&) {}

template <class Solver>
class Fcl final : public Engine {
 public:
  Fcl() { set_up(solver_); }
  bool hold(const Shape& a, const Shape& b) override {
    boxes_ = a.box_half_m && b.box_half_m;
    if (boxes_) {
      box_a_ = std::make_unique<Boxd>(2 * a.box_half_m->x(), 2 * a.box_half_m->y(), 2 * a.box_half_m->z());
      box_b_ = std::make_unique<Boxd>(2 * b.box_half_m->x(), 2 * b.box_half_m->y(), 2 * b.box_half_m->z());
    } else {
      convex_a_ = convex(a.polytope);
      convex_b_ = convex(b.polytope);
    }
    return true;
  }
  void forget() override { reset(solver_); }
  void place(const Recording& recording, std::size_t i) override { X_AB_ = transform(recording.poses[i]); }
  void query() override {
    try {
      if (boxes_)
        ask(*box_a_, *box_b_);
      else
        ask(*convex_a_, *convex_b_);
    } catch (const std::exception&) {  // FCL throws where its polytope degenerates
      found_ = {};
    }
  }
  Answer answer() const override { return found_; }

 private:
  template <class S>
  void ask(const S& a, const S& b) {
    found_ = {};
    double distance = 0.0;
    if (solver_.shapeDistance(a, X_WA_, b, X_AB_, &distance, &p_a_, &p_b_)) {
      turn_guess(solver_);
      found_ = {true, distance, 0};
      return;
    }
    contacts_.clear();
    if (!solver_.shapeIntersect(a, X_WA_, b, X_AB_, &contacts_) || contacts_.empty()) return;
    double depth = 0.0;
    // Of FCL's own solver the depth is negative, of the one on libccd positive.
    for (const auto& contact : contacts_) depth = std::max(depth, std::abs(contact.penetration_depth));
    found_ = {true, -depth, 0};
  }

  Solver solver_;
  bool boxes_ = false;
  std::unique_ptr<Boxd> box_a_, box_b_;
  std::unique_ptr<Convexd> convex_a_, convex_b_;
  fcl::Transform3<double> X_WA_ = fcl::Transform3<double>::Identity();
  fcl::Transform3<double> X_AB_ = fcl::Transform3<double>::Identity();
  fcl::Vector3<double> p_a_, p_b_;
  std::vector<fcl::ContactPoint<double>> contacts_;
  Answer found_;
};

}  // namespace

std::unique_ptr<Engine> make_fcl() { return std::make_unique<Fcl<fcl::detail::GJKSolver_indep<double>>>(); }
std::unique_ptr<Engine> make_fcl_libccd() {
  return std::make_unique<Fcl<fcl::detail::GJKSolver_libccd<double>>>();
}

}  // namespace tactum::bench
