#include <ode/ode.h>

#include <array>
#include <vector>

#include "bench/peers/peers.h"

namespace tactum::bench {
namespace {

/// What ODE's geometry points to, and the geometry itself.
class Geometry {
 public:
  explicit Geometry(const Shape& shape) {
    if (shape.box_half_m) {
      const Vec3 side = 2.0 * *shape.box_half_m;
      id_ = dCreateBox(nullptr, side.x(), side.y(), side.z());
      return;
    }
    const Polytope& P = shape.polytope;
    for (const Vec3& v : P.vertices) points_.insert(points_.end(), {v.x(), v.y(), v.z()});
    for (const Polytope::Face& face : P.faces) {
      planes_.insert(planes_.end(), {face.normal.x(), face.normal.y(), face.normal.z(), face.offset});
      polygons_.push_back(static_cast<unsigned>(face.count));
      for (int i = 0; i < face.count; ++i)
        polygons_.push_back(static_cast<unsigned>(P.face_vertices[static_cast<std::size_t>(face.first + i)]));
    }
    id_ = dCreateConvex(nullptr, planes_.data(), static_cast<unsigned>(P.faces.size()), points_.data(),
                        static_cast<unsigned>(P.vertices.size()), polygons_.data());
  }
  ~Geometry() { dGeomDestroy(id_); }
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;
  dGeomID id() const { return id_; }

 private:
  std::vector<dReal> planes_, points_;
  std::vector<unsigned> polygons_;
  dGeomID id_ = nullptr;
};

class Ode final : public Engine {
 public:
  Ode() { dInitODE2(0); }
  ~Ode() override {
    a_.reset();
    b_.reset();
    dCloseODE();
  }
  bool tells_distances() const override { return false; }
  bool hold(const Shape& a, const Shape& b) override {
    // Its collider tries every pair of edges, 0.1 us each.
    constexpr std::size_t kMostEdgePairs = 1'000'000;
    if (a.polytope.edges.size() * b.polytope.edges.size() > kMostEdgePairs) return false;
    a_ = std::make_unique<Geometry>(a);
    b_ = std::make_unique<Geometry>(b);
    return true;
  }
  void forget() override {}
  void place(const Recording& recording, std::size_t i) override {
    const Pose& X = recording.poses[i];
    const Mat3& R = X.R;
    const dMatrix3 rotation = {R(0, 0), R(0, 1), R(0, 2), 0,       R(1, 0), R(1, 1),
                               R(1, 2), 0,       R(2, 0), R(2, 1), R(2, 2), 0};
    dGeomSetRotation(b_->id(), rotation);
    dGeomSetPosition(b_->id(), X.p.x(), X.p.y(), X.p.z());
  }
  void query() override {
    const int count = dCollide(a_->id(), b_->id(), static_cast<int>(contacts_.size()), contacts_.data(),
                               sizeof(dContactGeom));
    double depth = 0.0;
    for (int i = 0; i < count; ++i) depth = std::max(depth, contacts_[static_cast<std::size_t>(i)].depth);
    found_ = {count > 0, -depth, 0};
  }
  Answer answer() const override { return found_; }

 private:
  std::unique_ptr<Geometry> a_, b_;
  std::array<dContactGeom, 32> contacts_{};
  Answer found_;
};

}  // namespace

std::unique_ptr<Engine> make_ode() { return std::make_unique<Ode>(); }

}  // namespace tactum::bench
