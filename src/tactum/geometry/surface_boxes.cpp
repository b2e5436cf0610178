#include "tactum/geometry/surface_boxes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tactum/base/parallel.h"
#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kLanes = SurfaceLayout::kLanes;

/// Of two boxes the larger is opened, or rather the one with the wider cone: its children face fewer
/// directions. Below this angle widths do not count [rad].
constexpr float kNarrow = 0.02F;

void put_lane(SurfaceLayout::Lanes3& lanes, std::size_t lane, const Vec3& v) {
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

/// Below so many features a thread costs more than it saves.
constexpr std::size_t kFewFeatures = 8192;

std::size_t leaves_of(std::size_t features) { return (features + kLanes - 1) / kLanes; }

/// The features of each child of a node, but for the last.
std::size_t unit_of(std::size_t features) {
  return kLanes * power_of_lanes((leaves_of(features) + kLanes - 1) / kLanes);
}

/// The nodes of a box of so many features.
std::size_t nodes_of(std::size_t features) {
  if (features <= kLanes) return 0;
  const std::size_t unit = unit_of(features);
  const std::size_t full = features / unit;
  return 1 + full * nodes_of(unit) + nodes_of(features - full * unit);
}

/// The axes of the spread of values about their mean, the longest last.
struct Spread {
  std::array<Vec3, 3> axis;
  std::array<double, 3> square{};  ///< of the spread along them
};
template <class Values>
Spread spread_of(const Values& value, std::size_t first, std::size_t last) {
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = first; i < last; ++i) mean += value(i);
  mean /= static_cast<double>(last - first);
  Mat3 moments = Mat3::Zero();
  for (std::size_t i = first; i < last; ++i) {
    const Vec3 off = value(i) - mean;
    moments += off * off.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(moments);
  const Mat3& axes = solver.eigenvectors();
  const Vec3& squares = solver.eigenvalues();
  return {{axes.col(0), axes.col(1), axes.col(2)}, {squares[0], squares[1], squares[2]}};
}

}  // namespace

SurfaceBoxes::SurfaceBoxes(const TriangleMesh& mesh, const SurfaceCones& cones, const Vec3& center,
                           int threads)
    : mesh_(mesh), center_(center) {
  grown_ = tolerances::kSingle * bounds(mesh.vertices).diagonal();
  std::size_t leaf_count = 0;
  std::size_t node_count = 0;
  for (const auto& features : cones.features) {
    leaf_count += leaves_of(features.size());
    node_count += features.empty() ? 0 : 1 + nodes_of(features.size());
  }
  leaves.reserve(leaf_count);
  nodes.reserve(node_count);
  for (const SurfaceLayout::Kind kind :
       {SurfaceLayout::kVertices, SurfaceLayout::kEdges, SurfaceLayout::kFaces}) {
    kind_ = kind;
    order_ = cones.features[kind];
    keyed_.resize(order_.size());
    if (!order_.empty()) root[kind] = make_tree(threads);
  }
}

Vec3 SurfaceBoxes::middle(const ConedFeature& feature) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < points(); ++i) sum += point(feature.corner, i);
  return sum / static_cast<double>(points());
}

std::int32_t SurfaceBoxes::make_tree(int threads) {
  const std::size_t index = nodes.size();
  const std::size_t first_leaf = leaves.size();
  nodes.resize(index + 1 + nodes_of(order_.size()));
  leaves.resize(first_leaf + leaves_of(order_.size()));
  make_child(index, 0, {0, order_.size()}, {index + 1, first_leaf}, threads);
  return static_cast<std::int32_t>(index);
}

/// Makes the box of a range and the nodes below it.
void SurfaceBoxes::make_child(std::size_t node, std::size_t lane, Range range, Place below, int threads) {
  make_box(nodes[node], lane, range);
  const bool leaf = range.second - range.first <= kLanes;
  nodes[node].child[lane] = leaf ? make_leaf(range, below.leaf) : make_node(range, below, threads);
}

std::int32_t SurfaceBoxes::make_leaf(Range range, std::size_t place) {
  SurfaceLayout::Corners& leaf = leaves[place];
  leaf.fill(-1);
  const std::size_t count = range.second - range.first;
  for (std::size_t lane = 0; lane < count; ++lane) leaf[lane] = order_[range.first + lane].corner;
  std::sort(leaf.begin(), leaf.begin() + static_cast<std::ptrdiff_t>(count));
  return ~static_cast<std::int32_t>(place);
}

std::int32_t SurfaceBoxes::make_node(Range range, Place place, int threads) {
  const std::size_t count = range.second - range.first;
  const std::size_t unit = unit_of(count);
  if (count < kFewFeatures) threads = 1;
  split(range, unit, threads);
  for_ranges(threads, count, unit, [&](std::size_t first, std::size_t last) {
    const std::size_t lane = first / unit;
    const Place below{place.node + 1 + lane * nodes_of(unit), place.leaf + lane * leaves_of(unit)};
    const auto share = static_cast<int>(static_cast<std::size_t>(threads) * (last - first) / count);
    make_child(place.node, lane, {range.first + first, range.first + last}, below, std::max(share, 1));
  });
  return static_cast<std::int32_t>(place.node);
}

/// Sorts into parts of `unit` features, the last perhaps of fewer.
void SurfaceBoxes::split(Range range, std::size_t unit, int threads) {
  const std::size_t units = (range.second - range.first + unit - 1) / unit;
  if (units <= 1) return;
  const std::size_t middle = range.first + (units + 1) / 2 * unit;
  sort_halves(range, middle, threads);
  for_both(
      threads,
      [&](int share) {
        split({range.first, middle}, unit, share);
      },
      [&](int share) {
        split({middle, range.second}, unit, share);
      });
}

/// Divides into halves whose boxes are smallest, by the squares of their diagonals: cut across the longest
/// spread of places, or where others are nearly as long across one of them, or half-way between.
void SurfaceBoxes::sort_halves(Range range, std::size_t halfway, int threads) {
  constexpr double kNearly = 0.3;
  const Spread spread =
      spread_of([&](std::size_t i) { return middle(order_[i]); }, range.first, range.second);
  const auto& [shortest, second, longest] = spread.axis;
  std::vector<Vec3> axes = {longest};
  if (spread.square[1] > kNearly * spread.square[2])
    axes.insert(axes.end(), {second, (longest + second).normalized(), (longest - second).normalized()});
  if (spread.square[0] > kNearly * spread.square[2]) axes.push_back(shortest);
  Vec3 best = longest;
  double least = 1e300;
  for (const Vec3& axis : axes) {
    cut_across(axis, range, halfway);
    if (axes.size() == 1) return;
    std::array<double, 2> squares{};
    for_both(
        threads,
        [&](int) {
          squares[0] = span({range.first, halfway}).half.squaredNorm();
        },
        [&](int) {
          squares[1] = span({halfway, range.second}).half.squaredNorm();
        });
    const double size = squares[0] + squares[1];
    if (size >= least) continue;
    least = size;
    best = axis;
  }
  cut_across(best, range, halfway);
}

void SurfaceBoxes::cut_across(const Vec3& axis, Range range, std::size_t halfway) {
  for (std::size_t i = range.first; i < range.second; ++i)
    keyed_[i] = {middle(order_[i]).dot(axis), order_[i]};
  const auto at = [&](std::size_t i) { return keyed_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(range.first), at(halfway), at(range.second), [](const auto& x, const auto& y) {
    return x.first < y.first || (x.first == y.first && x.second.corner < y.second.corner);
  });
  for (std::size_t i = range.first; i < range.second; ++i) order_[i] = keyed_[i].second;
}

SurfaceBoxes::Span SurfaceBoxes::span(Range range) const {
  Vec3 up = Vec3::Zero();
  for (std::size_t i = range.first; i < range.second; ++i) up += order_[i].axis;
  const double length = up.norm();
  up = length > tolerances::kSameNormal ? Vec3(up / length) : Vec3::UnitZ();
  const auto at = [&](std::size_t i) { return point(order_[i / points()].corner, i % points()); };
  // In the plane square to it, along the longest spread of the points.
  const auto flat_point = [&](std::size_t i) {
    const Vec3 p = at(i);
    return Vec3(p - up * up.dot(p));
  };
  const std::size_t first = points() * range.first;
  const std::size_t last = points() * range.second;
  const Vec3 spread = spread_of(flat_point, first, last).axis[2];
  Vec3 along = spread - up * up.dot(spread);
  along = along.norm() > 0.5 ? Vec3(along.normalized()) : any_orthogonal(up);
  Span box;
  box.axis = {along, up.cross(along), up};
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);
  for (std::size_t i = first; i < last; ++i) {
    const Vec3 p = at(i);
    const Vec3 in_box(box.axis[0].dot(p), box.axis[1].dot(p), box.axis[2].dot(p));
    low = low.cwiseMin(in_box);
    high = high.cwiseMax(in_box);
  }
  box.half = 0.5 * (high - low);
  const Vec3 middle_in_box = 0.5 * (low + high);
  box.center =
      box.axis[0] * middle_in_box[0] + box.axis[1] * middle_in_box[1] + box.axis[2] * middle_in_box[2];
  return box;
}

void SurfaceBoxes::make_box(SurfaceLayout::Node& node, std::size_t lane, Range range) {
  const Span box = span(range);
  const Vec3& up = box.axis[2];
  double width = 0.0;
  for (std::size_t i = range.first; i < range.second; ++i) {
    const Vec3& own = order_[i].axis;
    width = std::max(width, std::atan2(up.cross(own).norm(), up.dot(own)) + order_[i].width);
  }
  const Vec3 half = box.half + Vec3::Constant(grown_);
  put_lane(node.at.center, lane, box.center);
  put_lane(node.at.along, lane, box.axis[0]);
  put_lane(node.at.across, lane, box.axis[1]);
  put_lane(node.at.up, lane, up);
  put_lane(node.half, lane, half);
  node.cone[lane] = grown_angle(width);
  node.extent[lane] = (kNarrow + node.cone[lane]) * static_cast<float>(half.maxCoeff());
}

}  // namespace tactum::inline v0_1
