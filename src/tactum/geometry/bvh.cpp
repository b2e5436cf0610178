#include "tactum/geometry/bvh.h"

#include <algorithm>

#include "tactum/base/assert.h"
#include "tactum/base/parallel.h"

namespace tactum::inline v0_1 {
namespace {

constexpr int kBins = 16;
constexpr int kFewItems = 8192;   // below so many a thread costs more than it saves
constexpr int kMedianDepth = 32;  // below it the median splits: 32 + log2(2^31) levels stay within kMaxDepth

double surface(const Aabb& box) {
  if (box.empty()) return 0.0;
  const Vec3 d = box.max - box.min;
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

class TreeBuilder {
 public:
  TreeBuilder(const std::vector<Aabb>& boxes, int leaf_size, int threads, std::vector<Bvh::Node>& nodes,
              std::vector<std::int32_t>& order)
      : boxes_(boxes), leaf_size_(leaf_size), order_(order) {
    centers_.reserve(boxes.size());
    for (const Aabb& box : boxes) centers_.push_back(box.center());
    order_.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) order_[i] = static_cast<std::int32_t>(i);
    nodes.reserve(2 * boxes.size() / static_cast<std::size_t>(leaf_size));
    build(nodes, {0, static_cast<int>(boxes.size()), 0}, threads);
  }

 private:
  struct Range {
    int first, last, depth;
  };

  int build(std::vector<Bvh::Node>& nodes, const Range& range, int threads) {
    const auto [first, last, depth] = range;
    TACTUM_DEMAND(depth < Bvh::kMaxDepth);
    Aabb box;
    Aabb centers;
    for (int i = first; i < last; ++i) {
      box.extend(boxes_[order_[i]]);
      centers.extend(centers_[order_[i]]);
    }
    const int index = static_cast<int>(nodes.size());
    nodes.push_back({box.center(), outer_half(box), first, last - first});
    if (last - first <= leaf_size_) return index;
    int middle = depth < kMedianDepth ? split_by_area(first, last, centers) : first;
    if (middle == first || middle == last) middle = split_by_median(first, last, centers);
    const int second = build_halves(nodes, {first, middle, depth + 1}, {middle, last, depth + 1}, threads);
    nodes[index].second = second;
    nodes[index].count = 0;
    return index;
  }

  /// Returns where the second half begins.
  int build_halves(std::vector<Bvh::Node>& nodes, const Range& one, const Range& other, int threads) {
    if (threads < 2 || other.last - one.first < kFewItems) {
      build(nodes, one, 1);
      return build(nodes, other, 1);
    }
    std::vector<Bvh::Node> beyond;
    for_both(
        threads, [&](int share) { build(nodes, one, share); },
        [&](int share) { build(beyond, other, share); });
    const int second = static_cast<int>(nodes.size());
    for (Bvh::Node& node : beyond)
      if (!node.leaf()) node.second += second;
    nodes.insert(nodes.end(), beyond.begin(), beyond.end());
    return second;
  }

  /// Half the sides, grown so that center +- half contains the box in spite of rounding.
  static Vec3 outer_half(const Aabb& box) {
    const Vec3 scale = box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs());
    return box.half() + tolerances::kBoxMargin * scale;
  }

  /// The place that divides the range at the bin border of least cost, or `first` when there is none.
  int split_by_area(int first, int last, const Aabb& centers) {
    double best_cost = 1e300;
    int best_axis = -1;
    int best_border = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = centers.min[axis];
      const double width = centers.max[axis] - low;
      if (!(width > 0.0)) continue;
      std::array<Aabb, kBins> boxes;
      std::array<int, kBins> counts{};
      for (int i = first; i < last; ++i) {
        const int bin = bin_of(centers_[order_[i]][axis], low, width);
        boxes[bin].extend(boxes_[order_[i]]);
        ++counts[bin];
      }
      std::array<double, kBins> right_cost{};
      Aabb right;
      int right_count = 0;
      for (int bin = kBins - 1; bin > 0; --bin) {
        right.extend(boxes[bin]);
        right_count += counts[bin];
        right_cost[bin] = surface(right) * right_count;
      }
      Aabb left;
      int left_count = 0;
      for (int border = 1; border < kBins; ++border) {
        left.extend(boxes[border - 1]);
        left_count += counts[border - 1];
        const double cost = surface(left) * left_count + right_cost[border];
        if (left_count == 0 || left_count == last - first || cost >= best_cost) continue;
        best_cost = cost;
        best_axis = axis;
        best_border = border;
      }
    }
    if (best_axis < 0) return first;
    const double low = centers.min[best_axis];
    const double width = centers.max[best_axis] - low;
    const auto is_left = [&](std::int32_t item) {
      return bin_of(centers_[item][best_axis], low, width) < best_border;
    };
    const auto middle = std::stable_partition(order_.begin() + first, order_.begin() + last, is_left);
    return static_cast<int>(middle - order_.begin());
  }

  static int bin_of(double value, double low, double width) {
    return std::min(kBins - 1, static_cast<int>(kBins * ((value - low) / width)));
  }

  int split_by_median(int first, int last, const Aabb& centers) {
    int axis = 0;
    (centers.max - centers.min).maxCoeff(&axis);
    const auto before = [&](std::int32_t a, std::int32_t b) {
      return centers_[a][axis] < centers_[b][axis] || (centers_[a][axis] == centers_[b][axis] && a < b);
    };
    std::sort(order_.begin() + first, order_.begin() + last, before);
    return first + (last - first) / 2;
  }

  const std::vector<Aabb>& boxes_;
  int leaf_size_;
  std::vector<std::int32_t>& order_;
  std::vector<Vec3> centers_;
};

}  // namespace

Bvh::Bvh(const std::vector<Aabb>& boxes, int leaf_size, int threads) {
  if (!boxes.empty()) TreeBuilder(boxes, std::max(1, leaf_size), threads, nodes_, order_);
}

}  // namespace tactum::inline v0_1
