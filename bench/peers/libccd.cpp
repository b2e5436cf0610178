#include <ccd/ccd.h>

#include "bench/peers/peers.h"

namespace tactum::bench {
namespace {

/// libccd leaves the support function to its user: here it climbs from the last support over our adjacency,
/// the fastest it could be given.
struct Piece {
  const Polytope* polytope = nullptr;
  Pose X;
  mutable int last = 0;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* result) {
  const Piece& piece = *static_cast<const Piece*>(object);
  const Vec3 d = piece.X.R.transpose() * Vec3(direction->v[0], direction->v[1], direction->v[2]);
  piece.last = support_vertex(*piece.polytope, d, piece.last);
  const Vec3 p = piece.X * piece.polytope->vertices[static_cast<std::size_t>(piece.last)];
  ccdVec3Set(result, p.x(), p.y(), p.z());
}

void center(const void* object, ccd_vec3_t* result) {
  const Piece& piece = *static_cast<const Piece*>(object);
  const Vec3 p = piece.X * piece.polytope->extent.center;
  ccdVec3Set(result, p.x(), p.y(), p.z());
}

class Libccd final : public Engine {
 public:
  Libccd() {
    CCD_INIT(&ccd_);
    ccd_.support1 = support;
    ccd_.support2 = support;
    ccd_.center1 = center;
    ccd_.center2 = center;
    ccd_.max_iterations = 500;
    ccd_.epa_tolerance = 1e-9;  // [m]
  }
  bool reports_distances() const override { return false; }
  bool hold(const Shape& a, const Shape& b) override {
    a_ = {&a.polytope, {}, 0};
    b_ = {&b.polytope, {}, 0};
    return true;
  }
  void forget() override { a_.last = b_.last = 0; }
  void place(const Recording& recording, std::size_t i) override { b_.X = recording.poses[i]; }
  void query() override {
    ccd_vec3_t direction;
    ccd_vec3_t position;
    ccd_real_t depth = 0.0;
    found_ = {};
    if (ccdGJKPenetration(&a_, &b_, &ccd_, &depth, &direction, &position) == 0) found_ = {true, -depth, 0};
  }
  Answer answer() const override { return found_; }

 private:
  ccd_t ccd_{};
  Piece a_, b_;
  Answer found_;
};

}  // namespace

std::unique_ptr<Engine> make_libccd() { return std::make_unique<Libccd>(); }

}  // namespace tactum::bench
