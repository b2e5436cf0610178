#include "tactum/collision/convex_path.h"

#include "tactum/collision/closest_features.h"
#include "tactum/math/path_search.h"

namespace tactum::inline v0_1 {
namespace {

constexpr int kIntervalTests = 64;

/// Two pieces, of which B moves (path_search.h).
class ConvexPair {
 public:
  ConvexPair(const Polytope& A, const Polytope& B, const RelativeMotion& motion, const PairCache& cache)
      : A_(A), B_(B), motion_(motion), cache_(cache) {}

  Vec3 direction(double s) noexcept {
    const PairDistance found = closest_features(A_, B_, motion_.at(s), cache_);
    return found.distance > 0.0 ? found.normal : Vec3(Vec3::Zero());
  }
  double gap(const Vec3& n, double s) noexcept {
    const Pose X_AB = motion_.at(s);
    on_a_ = support_vertex(A_, -n, on_a_);
    on_b_ = support_vertex(B_, rotated_back(X_AB.R, n), on_b_);
    return n.dot(A_.vertices[std::size_t(on_a_)]) - n.dot(X_AB * B_.vertices[std::size_t(on_b_)]);
  }
  Vec3 turned(const Vec3& n, double from, double to) const noexcept {
    return rotated(motion_.at(to).R, rotated_back(motion_.at(from).R, n));
  }
  double turn() const noexcept { return motion_.by.w.norm(); }
  double curving(const Vec3& n) const noexcept {
    return motion_.curving(n, motion_.X_AB * B_.extent.center, B_.extent.radius);
  }

 private:
  const Polytope& A_;
  const Polytope& B_;
  const RelativeMotion& motion_;
  PairCache cache_;
  int on_a_ = 0, on_b_ = 0;
};

}  // namespace

double convex_path_free(const Polytope& A, const Polytope& B, const RelativeMotion& motion,
                        const PairCache& cache) noexcept {
  ConvexPair pair(A, B, motion, cache);
  return path_free_until(pair, 1.0, kIntervalTests);
}

}  // namespace tactum::inline v0_1
