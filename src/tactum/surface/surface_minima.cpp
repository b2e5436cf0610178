#include "tactum/surface/surface_minima.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/surface/surface_minima_walk.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kDiagonal = 1.42;  // a little more than the root of two

lanes::Bounds bounds_of(const MinimaQuery& query, double size) noexcept {
  const double grown = tolerances::kSingle * size;
  lanes::Bounds q{};
  q.grown = static_cast<float>(grown);
  q.max_distance = static_cast<float>(query.max_distance + grown);
  q.depth = static_cast<float>(query.depth + grown);
  q.far = std::max(q.max_distance, q.depth);
  // The normal of parallel edges may leave an edge's cone by the inflation to two sides at once.
  q.inflation = static_cast<float>(kDiagonal * query.cone_inflation + tolerances::kSingle);
  return q;
}

}  // namespace

MinimaWork surface_minima(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                          const MinimaQuery& query, std::vector<SurfaceMinimum>& minima) noexcept {
  return lanes::surface_minima(lanes::builds().best(), a, b, X_AB, query, minima);
}

namespace {

void walk_all(const lanes::Kernels& kernels, const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
              const MinimaQuery& query, FeatureComparison& features) noexcept {
  lanes::Bounds bounds = bounds_of(query, a.size() + b.size());
  using Tree = SurfaceTree;
  {
    SurfaceWalk walk(a, b, X_AB.inverse(), false, bounds, kernels, features);
    walk.run<Tree::kEdges, Tree::kEdges>();
    walk.run<Tree::kVertices, Tree::kFaces>();
    walk.run<Tree::kVertices, Tree::kEdges>();
    walk.run<Tree::kVertices, Tree::kVertices>();
  }
  SurfaceWalk back(b, a, X_AB, true, bounds, kernels, features);
  back.run<Tree::kVertices, Tree::kFaces>();
  back.run<Tree::kVertices, Tree::kEdges>();
}

}  // namespace

MinimaWork lanes::surface_minima(const Kernels& kernels, const SurfaceTree& a, const SurfaceTree& b,
                                 const Pose& X_AB, const MinimaQuery& query,
                                 std::vector<SurfaceMinimum>& minima) noexcept {
  FeatureComparison features(a, b, X_AB, query, minima);
  walk_all(kernels, a, b, X_AB, query, features);
  features.finish();
  return features.work;
}

double surface_clearance(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                         const MinimaQuery& query, MinimaWork& work) noexcept {
  constexpr double kShort = 0.9;
  std::vector<SurfaceMinimum> none;  // without room: takes no memory
  FeatureComparison features(a, b, X_AB, query, none);
  features.narrow_by(kShort);
  walk_all(lanes::builds().best(), a, b, X_AB, query, features);
  work = features.work;
  work.full = false;
  return features.max_distance();
}

}  // namespace tactum::inline v0_1
