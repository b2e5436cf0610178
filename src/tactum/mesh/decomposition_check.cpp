#include "tactum/mesh/decomposition_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/polygon_clip.h"

namespace tactum::inline v0_1::detail {
namespace {

double highest(const Polytope& piece, const Polytope::Face& plane) {
  double height = -1e300;
  for (const Vec3& vertex : piece.vertices)
    height = std::max(height, plane.normal.dot(vertex) - plane.offset);
  return height;
}

double lowest(const Polytope& piece, const Polytope::Face& plane) {
  double height = 1e300;
  for (const Vec3& vertex : piece.vertices)
    height = std::min(height, plane.normal.dot(vertex) - plane.offset);
  return height;
}

/// With one plane of `a` that has `b` above it, and every other plane of `a` with `b` below.
bool holds_but_for_one(const Polytope& a, const Polytope& b, double noise) {
  const Polytope::Face* parting = nullptr;
  for (const Polytope::Face& face : a.faces) {
    if (highest(b, face) <= noise) continue;
    if (lowest(b, face) < -noise) return false;
    if (parting != nullptr && parting->normal.cross(face.normal).norm() > tolerances::kCoplanarMeshSine)
      return false;
    parting = &face;
  }
  return parting != nullptr;
}

double area_of(const Polytope& piece) {
  double area = 0.0;
  for (int face = 0; face < piece.counts[2]; ++face)
    area += polygon_area(face_corners(piece, face), piece.faces[face].normal);
  return area;
}

std::optional<Polytope> joined(const Polytope& a, const Polytope& b, double noise) {
  if (!holds_but_for_one(a, b, noise) || !holds_but_for_one(b, a, noise)) return std::nullopt;
  std::vector<Vec3> points = a.vertices;
  points.insert(points.end(), b.vertices.begin(), b.vertices.end());
  Result<Polytope> hull = convex_hull(points);
  if (!hull || hull->flat) return std::nullopt;
  // Pieces that are convex together but apart (two of three boxes in a row) leave a gap.
  const double gap = volume_of(*hull) - volume_of(a) - volume_of(b);
  if (gap > noise * area_of(*hull)) return std::nullopt;
  return std::move(*hull);
}

/// Pieces may bulge by the noise and share corners moved by it: this many times the noise is an overlap.
constexpr double kSureOverlap = 4.0;

/// Whether some point is just `depth` below the face of `a`, and no nearer to all other planes of both.
bool face_inside(const Polytope& a, int face, const Polytope& b, double depth) {
  std::vector<Vec3> polygon = face_corners(a, face);
  for (Vec3& corner : polygon) corner -= a.faces[face].normal * depth;
  for (const Polytope* piece : {&b, &a})
    for (const Polytope::Face& plane : piece->faces) {
      if (&plane == &a.faces[face]) continue;
      keep_below(polygon, plane.normal, plane.offset - depth);
      if (polygon.empty()) return false;
    }
  return true;
}

Aabb grown(const Polytope& piece, double by) {
  const Aabb box = bounds(piece.vertices);
  return {box.min - Vec3::Constant(by), box.max + Vec3::Constant(by)};
}

}  // namespace

double volume_of(const Polytope& piece) {
  double three = 0.0;
  for (std::size_t i = 0; i < piece.faces.size(); ++i) {
    const Polytope::Face& face = piece.faces[i];
    three += polygon_area(face_corners(piece, static_cast<int>(i)), face.normal) *
             (face.offset - face.normal.dot(piece.extent.center));
  }
  return three / 3.0;
}

Result<Polytope> convex_piece(const std::vector<Vec3>& corners, const Solid& body, double noise) {
  std::vector<Vec3> points;
  for (int corner : corners_of(body)) points.push_back(corners[corner]);
  Result<Polytope> piece = convex_hull(points);
  if (!piece) return piece.error();
  const double excess = (piece->flat ? 0.0 : volume_of(*piece)) - volume_of(corners, body);
  if (piece->flat || std::abs(excess) > noise * area_of(corners, body))
    return Error{"a cut went wrong", fmt::format("a piece that is not convex at {}", place(points[0])),
                 "a surface that does not cross itself", ""};
  return piece;
}

int join_convex(std::vector<Polytope>& pieces, double noise) {
  int gone = 0;
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (std::size_t j = i + 1; j < pieces.size();) {
        std::optional<Polytope> both;
        if (grown(pieces[i], noise).overlaps(grown(pieces[j], noise)))
          both = joined(pieces[i], pieces[j], noise);
        if (!both) {
          ++j;
          continue;
        }
        pieces[i] = std::move(*both);
        pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(j));
        ++gone;
        again = true;
      }
  }
  return gone;
}

bool overlap_deeper(const Polytope& a, const Polytope& b, double depth) {
  if (!bounds(a.vertices).overlaps(bounds(b.vertices))) return false;
  for (std::size_t face = 0; face < a.faces.size(); ++face)
    if (face_inside(a, static_cast<int>(face), b, depth)) return true;
  for (std::size_t face = 0; face < b.faces.size(); ++face)
    if (face_inside(b, static_cast<int>(face), a, depth)) return true;
  return false;
}

Result<void> check_pieces(const std::vector<Polytope>& pieces, double volume, double noise,
                          double tolerance) {
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t j = i + 1; j < pieces.size(); ++j)
      if (overlap_deeper(pieces[i], pieces[j], kSureOverlap * noise))
        return Error{"the surface bounds no solid",
                     "a surface that crosses itself near " + place(pieces[j].extent.center),
                     "pieces that do not overlap", ""};
  double sum = 0.0;
  for (const Polytope& piece : pieces) sum += volume_of(piece);
  if (std::abs(sum - volume) > tolerance)
    return Error{"the decomposition is not the solid", fmt::format("pieces of {:.9g} m^3", sum),
                 fmt::format("{:.9g} m^3", volume), ""};
  return {};
}

}  // namespace tactum::inline v0_1::detail
