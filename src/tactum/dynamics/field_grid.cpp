#include "tactum/dynamics/field_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

constexpr int kMostNodes = 4096;       // a side
constexpr double kLargestForce = 1e9;  // of a sample: a larger one means a wrong file [N]

template <class Number>
Vec3 vector_at(const Number* three) {
  return {double(three[0]), double(three[1]), double(three[2])};
}

/// A place along one axis: the node below, how far it is to the next, and the factor of the field at the
/// edge.
struct Place {
  Index node;
  double share;      // fraction of the distance to the next node
  double left;       // 1 inside the box, 0 beyond the edge
  double left_rate;  // its change [1/m]
  bool inside;
};

Place place_of(double x, int nodes, double per_spacing, double per_edge) {
  const double u = x * per_spacing;
  const double last = nodes - 1;
  if (u >= 0.0 && u < last) {
    const int cell = static_cast<int>(u);
    return {static_cast<Index>(cell), u - cell, 1.0, 0.0, true};
  }
  const double inside = u > 0.0 ? last : 0.0;  // also when u is not a number
  const int below = u > 0.0 ? nodes - 2 : 0;
  Place place{static_cast<Index>(below), inside - below, 1.0, 0.0, true};
  const double out = u < 0.0 ? -x : u > last ? x - last / per_spacing : 0.0;
  if (out > 0.0) {
    place.inside = false;
    place.left = std::max(0.0, 1.0 - out * per_edge);
    place.left_rate = place.left == 0.0 ? 0.0 : u < 0.0 ? per_edge : -per_edge;
  }
  return place;
}

/// Interpolates linearly in each direction, with the gradient inside the cell; `row` and `layer` are steps of
/// memory.
template <class Number>
void interpolate(const Number* corner, Index row, Index layer, const double (&s)[3], const Vec3& per_spacing,
                 FieldValue& value) {
  for (int c = 0; c < 3; ++c) {
    const auto along_x = [&](Index offset, double& rate) {
      const double a = double(corner[offset + Index(c)]);
      rate = double(corner[offset + 3 + Index(c)]) - a;
      return a + s[0] * rate;
    };
    double rate[4];
    const double v00 = along_x(0, rate[0]);
    const double v10 = along_x(row, rate[1]);
    const double v01 = along_x(layer, rate[2]);
    const double v11 = along_x(layer + row, rate[3]);
    const double y0 = v10 - v00, y1 = v11 - v01;
    const double v0 = v00 + s[1] * y0;
    const double v1 = v01 + s[1] * y1;
    const double x0 = rate[0] + s[1] * (rate[1] - rate[0]);
    const double x1 = rate[2] + s[1] * (rate[3] - rate[2]);
    value.force[c] = v0 + s[2] * (v1 - v0);
    value.gradient(c, 0) = (x0 + s[2] * (x1 - x0)) * per_spacing[0];
    value.gradient(c, 1) = (y0 + s[2] * (y1 - y0)) * per_spacing[1];
    value.gradient(c, 2) = (v1 - v0) * per_spacing[2];
  }
}

/// Multiplies the field by its factors at the edge.
void fade(const Place (&place)[3], FieldValue& value) {
  const double left[3] = {place[0].left, place[1].left, place[2].left};
  const double all = left[0] * left[1] * left[2];
  const Vec3 force = value.force;
  value.force *= all;
  for (int axis = 0; axis < 3; ++axis) {
    if (place[axis].inside) {
      value.gradient.col(axis) *= all;
    } else {
      const double others = left[(axis + 1) % 3] * left[(axis + 2) % 3];
      value.gradient.col(axis) = place[axis].left_rate * others * force;
    }
  }
}

/// The gradients from differences at every node; at the outermost nodes also that of the fall to zero at the
/// edge.
template <class Number>
double steepest_of(const GridShape& shape, const std::vector<Number>& samples, const Vec3& per_spacing,
                   const Vec3& per_edge) {
  const Index step[3] = {3, 3 * Index(shape.nodes[0]), 3 * Index(shape.nodes[0]) * Index(shape.nodes[1])};
  double steepest_sq = 0.0;
  const Number* here = samples.data();
  std::array<int, 3> at{};
  for (at[2] = 0; at[2] < shape.nodes[2]; ++at[2])
    for (at[1] = 0; at[1] < shape.nodes[1]; ++at[1])
      for (at[0] = 0; at[0] < shape.nodes[0]; ++at[0], here += 3) {
        double rows[3] = {0.0, 0.0, 0.0};
        double widest = 0.0;
        for (Index axis = 0; axis < 3; ++axis) {
          const bool last = at[axis] + 1 == shape.nodes[axis];
          const bool first = at[axis] == 0;
          double column = 0.0, faded = 0.0;
          for (Index c = 0; c < 3; ++c) {
            const double v = double(here[c]);
            const double change =
                last ? 0.0 : std::abs(double(here[c + step[axis]]) - v) * per_spacing[Eigen::Index(axis)];
            const double edge = last || first ? std::abs(v) * per_edge[Eigen::Index(axis)] : 0.0;
            rows[c] += std::max(change, edge);
            column += change;
            faded += edge;
          }
          widest = std::max({widest, column, faded});
        }
        steepest_sq = std::max(steepest_sq, std::max({rows[0], rows[1], rows[2]}) * widest);
      }
  return std::sqrt(steepest_sq);
}

template <class Number>
Result<void> check_samples(const GridShape& shape, const std::vector<Number>& samples) {
  if (samples.size() != 3 * shape.count())
    return Error{"the samples do not fill the grid", fmt::format("{} numbers", samples.size()),
                 fmt::format("{}", 3 * shape.count()), ""};
  const auto bad = std::find_if(samples.begin(), samples.end(),
                                [](Number x) { return !(std::abs(double(x)) <= kLargestForce); });
  if (bad == samples.end()) return {};
  const Index node = Index(bad - samples.begin()) / 3;
  const Index nx = Index(shape.nodes[0]), ny = Index(shape.nodes[1]);
  return Error{"a sample is no force", fmt::format("{}", double(*bad)),
               fmt::format("a number, at most {:g} N", kLargestForce),
               fmt::format("node ({}, {}, {})", node % nx, node / nx % ny, node / nx / ny)};
}

}  // namespace

Result<void> check_shape(const GridShape& shape) {
  for (int axis = 0; axis < 3; ++axis) {
    const int nodes = shape.nodes[Index(axis)];
    if (nodes < 2 || nodes > kMostNodes)
      return Error{"a grid cannot have so many nodes along " + std::string(1, "xyz"[axis]),
                   fmt::format("{}", nodes), fmt::format("2 to {}", kMostNodes), ""};
    const double spacing = shape.spacing[axis];
    if (!(spacing > 0.0) || !std::isfinite(spacing) || !std::isfinite(1.0 / spacing))
      return Error{"a grid's spacing is no length", fmt::format("{}", spacing), "more than 0 m", ""};
    if (!std::isfinite(shape.origin[axis]))
      return Error{"a grid's origin is not finite", fmt::format("{}", shape.origin[axis]), "a number", ""};
  }
  return {};
}

Result<FieldGrid> FieldGrid::make(const GridShape& shape, Samples samples, double edge_m) {
  if (const Result<void> fine = check_shape(shape); !fine) return fine.error();
  if (!(edge_m >= 0.0) || !std::isfinite(edge_m))
    return Error{"the edge of a grid is no length", fmt::format("{}", edge_m), "0 or more", ""};
  const Result<void> fine =
      std::visit([&](const auto& numbers) { return check_samples(shape, numbers); }, samples);
  if (!fine) return fine.error();
  return FieldGrid(shape, std::move(samples), edge_m);
}

FieldGrid::FieldGrid(const GridShape& shape, Samples samples, double edge_m)
    : shape_(shape), samples_(std::move(samples)), per_spacing_(shape.spacing.cwiseInverse()) {
  per_edge_ = edge_m > 0.0 ? Vec3(Vec3::Constant(1.0 / edge_m)) : per_spacing_;
  steepest_ = std::visit(
      [&](const auto& numbers) { return steepest_of(shape_, numbers, per_spacing_, per_edge_); }, samples_);
}

FieldValue FieldGrid::at(const Vec3& p) const noexcept {
  FieldValue value;
  const Vec3 x = p - shape_.origin;
  Place place[3];
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] = place_of(x[axis], shape_.nodes[Index(axis)], per_spacing_[axis], per_edge_[axis]);
    if (!(place[axis].left > 0.0)) return value;
    inside &= place[axis].inside;
  }
  const Index row = 3 * Index(shape_.nodes[0]);
  const Index layer = row * Index(shape_.nodes[1]);
  const Index first = 3 * place[0].node + row * place[1].node + layer * place[2].node;
  const double shares[3] = {place[0].share, place[1].share, place[2].share};
  if (const auto* singles = std::get_if<std::vector<float>>(&samples_)) {
    interpolate(singles->data() + first, row, layer, shares, per_spacing_, value);
  } else {
    interpolate(std::get_if<std::vector<double>>(&samples_)->data() + first, row, layer, shares, per_spacing_,
                value);
  }
  if (!inside) fade(place, value);
  return value;
}

}  // namespace tactum::inline v0_1
