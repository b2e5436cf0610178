#include "tactum/geometry/surface_boxes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

constexpr std::size_t kLanes = SurfaceTree::kLanes;
void put(SurfaceTree::Lanes3& lanes, std::size_t lane, const Vec3& v) {
  for (std::size_t i = 0; i < 3; ++i) lanes[i][lane] = static_cast<float>(v[static_cast<int>(i)]);
}

float grown_angle(double angle_rad) {
  return static_cast<float>(std::min(kPi, angle_rad + tolerances::kSingle));
}

/// The smallest number not below `value` that is 1, 8, 64, ...
std::size_t power_of_lanes(std::size_t value) {
  std::size_t power = 1;
  while (power < value) power *= kLanes;
  return power;
}

/// The axis along which values spread most about their mean.
template <class Values>
Vec3 longest_spread(const Values& value, std::size_t first, std::size_t last) {
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = first; i < last; ++i) mean += value(i);
  mean /= static_cast<double>(last - first);
  Mat3 moments = Mat3::Zero();
  for (std::size_t i = first; i < last; ++i) {
    const Vec3 off = value(i) - mean;
    moments += off * off.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Mat3>(moments).eigenvectors().col(2);
}

}  // namespace

SurfaceBoxes::SurfaceBoxes(const TriangleMesh& mesh, const SurfaceCones& cones, const Vec3& center)
    : mesh_(mesh), center_(center) {
  grown_ = tolerances::kSingle * bounds(mesh.vertices).diagonal();
  std::size_t leaf_count = 0;
  for (const auto& features : cones.features) leaf_count += (features.size() + kLanes - 1) / kLanes;
  leaves.reserve(leaf_count);
  for (const SurfaceTree::Kind kind : {SurfaceTree::kVertices, SurfaceTree::kEdges, SurfaceTree::kFaces}) {
    kind_ = kind;
    order_ = cones.features[kind];
    keyed_.resize(order_.size());
    if (!order_.empty()) root[kind] = make_tree();
  }
}

Vec3 SurfaceBoxes::middle(const ConedFeature& feature) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < points(); ++i) sum += point(feature, i);
  return sum / static_cast<double>(points());
}

std::int32_t SurfaceBoxes::make_tree() {
  const Range all{0, order_.size()};
  const std::size_t index = nodes.size();
  nodes.emplace_back();
  make_box(nodes[index], 0, all);
  const std::int32_t below = order_.size() <= kLanes ? make_leaf(all) : make_node(all);
  nodes[index].child[0] = below;
  return static_cast<std::int32_t>(index);
}

std::int32_t SurfaceBoxes::make_leaf(Range range) {
  SurfaceTree::Leaf& leaf = leaves.emplace_back();
  leaf.corner.fill(-1);
  for (std::size_t i = range.first; i < range.second; ++i) leaf.corner[i - range.first] = order_[i].corner;
  std::sort(leaf.corner.begin(),
            leaf.corner.begin() + static_cast<std::ptrdiff_t>(range.second - range.first));
  return ~static_cast<std::int32_t>(leaves.size() - 1);
}

std::int32_t SurfaceBoxes::make_node(Range range) {
  const std::size_t leaf_count = (range.second - range.first + kLanes - 1) / kLanes;
  const std::size_t unit = kLanes * power_of_lanes((leaf_count + kLanes - 1) / kLanes);
  std::vector<Range> parts;
  split(range, unit, parts);
  const std::size_t index = nodes.size();
  nodes.emplace_back();
  for (std::size_t lane = 0; lane < parts.size(); ++lane) {
    make_box(nodes[index], lane, parts[lane]);
    const bool leaf = parts[lane].second - parts[lane].first <= kLanes;
    const std::int32_t below = leaf ? make_leaf(parts[lane]) : make_node(parts[lane]);
    nodes[index].child[lane] = below;
  }
  return static_cast<std::int32_t>(index);
}

/// Parts of `unit` features, the last perhaps of fewer.
void SurfaceBoxes::split(Range range, std::size_t unit, std::vector<Range>& parts) {
  const std::size_t units = (range.second - range.first + unit - 1) / unit;
  if (units <= 1) {
    parts.push_back(range);
    return;
  }
  const std::size_t middle = range.first + (units + 1) / 2 * unit;
  sort_halves(range, middle);
  split({range.first, middle}, unit, parts);
  split({middle, range.second}, unit, parts);
}

void SurfaceBoxes::sort_halves(Range range, std::size_t halfway) {
  const Vec3 axis =
      longest_spread([&](std::size_t i) { return middle(order_[i]); }, range.first, range.second);
  for (std::size_t i = range.first; i < range.second; ++i)
    keyed_[i] = {middle(order_[i]).dot(axis), order_[i]};
  const auto at = [&](std::size_t i) { return keyed_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(range.first), at(halfway), at(range.second), [](const auto& x, const auto& y) {
    return x.first < y.first || (x.first == y.first && x.second.corner < y.second.corner);
  });
  for (std::size_t i = range.first; i < range.second; ++i) order_[i] = keyed_[i].second;
}

void SurfaceBoxes::make_box(SurfaceTree::Node& node, std::size_t lane, Range range) {
  Vec3 up = Vec3::Zero();
  for (std::size_t i = range.first; i < range.second; ++i) up += order_[i].axis;
  const double length = up.norm();
  up = length > tolerances::kSameNormal ? Vec3(up / length) : Vec3::UnitZ();
  // In the plane square to it, along the longest spread of the points.
  const auto flat_point = [&](std::size_t i) {
    const Vec3 p = point(order_[i / points()], i % points());
    return Vec3(p - up * up.dot(p));
  };
  const Vec3 spread = longest_spread(flat_point, points() * range.first, points() * range.second);
  Vec3 along = spread - up * up.dot(spread);
  along = along.norm() > 0.5 ? Vec3(along.normalized()) : any_orthogonal(up);
  const std::array<Vec3, 3> axis = {along, up.cross(along), up};
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);
  double width = 0.0;
  for (std::size_t i = range.first; i < range.second; ++i) {
    for (std::size_t k = 0; k < points(); ++k) {
      const Vec3 p = point(order_[i], k);
      const Vec3 told(axis[0].dot(p), axis[1].dot(p), axis[2].dot(p));
      low = low.cwiseMin(told);
      high = high.cwiseMax(told);
    }
    const Vec3& own = order_[i].axis;
    width = std::max(width, std::atan2(up.cross(own).norm(), up.dot(own)) + order_[i].width);
  }
  const Vec3 middle_told = 0.5 * (low + high);
  put(node.center, lane, axis[0] * middle_told[0] + axis[1] * middle_told[1] + axis[2] * middle_told[2]);
  put(node.up, lane, up);
  put(node.along, lane, along);
  put(node.half, lane, 0.5 * (high - low) + Vec3::Constant(grown_));
  node.cone[lane] = grown_angle(width);
}

}  // namespace tactum
