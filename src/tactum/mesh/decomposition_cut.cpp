#include "tactum/mesh/decomposition_cut.h"

#include <algorithm>
#include <map>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1::detail {
namespace {

enum class Where : signed char { kBelow = -1, kOn = 0, kAbove = 1 };

/// Where the corners of the solid are, with the new ones on crossing edges.
class Corners {
 public:
  Corners(std::vector<Vec3>& corners, const Solid& solid, const CutPlane& plane, double noise)
      : corners_(corners), plane_(plane) {
    for (int corner : corners_of(solid)) {
      const double height = plane.normal.dot(corners[corner]) - plane.offset;
      where_[corner] = height > noise ? Where::kAbove : height < -noise ? Where::kBelow : Where::kOn;
    }
  }
  Where at(int corner) const { return where_.at(corner); }
  const Vec3& operator[](int corner) const { return corners_[corner]; }

  /// The sides of a face, those that cross in two.
  std::vector<SolidSide> split(const SolidFace& face) {
    std::vector<SolidSide> sides;
    for (const auto& [tail, head] : face.sides) {
      if (static_cast<int>(at(tail)) * static_cast<int>(at(head)) >= 0) {
        sides.push_back({tail, head});
        continue;
      }
      const int middle = crossing(std::min(tail, head), std::max(tail, head));
      sides.push_back({tail, middle});
      sides.push_back({middle, head});
    }
    return sides;
  }

 private:
  int crossing(int low, int high) {
    const auto [known, fresh] = new_.try_emplace({low, high}, static_cast<int>(corners_.size()));
    if (!fresh) return known->second;
    const Vec3 p = corners_[low];
    const Vec3 q = corners_[high];
    const double below = plane_.normal.dot(p) - plane_.offset;
    const double above = plane_.normal.dot(q) - plane_.offset;
    corners_.emplace_back(p + (q - p) * (below / (below - above)));
    where_[known->second] = Where::kOn;
    return known->second;
  }

  std::vector<Vec3>& corners_;
  const CutPlane& plane_;
  std::map<int, Where> where_;
  std::map<std::pair<int, int>, int> new_;
};

/// A corner on the line of the cut, and the parts of the face that begin (+1) or end (-1) there, going along.
struct LineCorner {
  double along = 0.0;
  int corner = 0;
  int below = 0, above = 0;
};

Error crossed(const Vec3& p) {
  return Error{"a cut went wrong", "a surface that crosses itself or has no thickness near " + place(p),
               "a surface that bounds a solid", ""};
}

/// Cuts one face, whose sides no longer cross.
Result<void> cut_face(const Corners& corners, const CutPlane& plane, const SolidFace& face,
                      const std::vector<SolidSide>& sides, Halves& halves) {
  SolidFace below{face.normal, face.offset, face.error_bound, {}};
  SolidFace above = below;
  std::map<int, LineCorner> on_line;
  const Vec3 direction = plane.normal.cross(face.normal);
  const auto line_corner = [&](int corner) -> LineCorner& {
    LineCorner& known = on_line[corner];
    known.corner = corner;
    known.along = direction.dot(corners[corner]);
    return known;
  };
  for (const auto& [tail, head] : sides) {
    const Where from = corners.at(tail);
    const Where to = corners.at(head);
    if (from == Where::kOn) line_corner(tail);
    if (to == Where::kOn) line_corner(head);
    if (from == Where::kBelow || to == Where::kBelow) {
      below.sides.push_back({tail, head});
      if (from == Where::kOn) ++line_corner(tail).below;  // interior lies left of a side
      if (to == Where::kOn) --line_corner(head).below;
    } else if (from == Where::kAbove || to == Where::kAbove) {
      above.sides.push_back({tail, head});
      if (from == Where::kOn) --line_corner(tail).above;
      if (to == Where::kOn) ++line_corner(head).above;
    }
  }
  if (below.sides.empty() || above.sides.empty()) {  // not cut: whole on one side, or in the plane
    const bool in_plane = below.sides.empty() && above.sides.empty();
    const bool up = in_plane ? face.normal.dot(plane.normal) < 0.0 : below.sides.empty();
    (up ? halves.above : halves.below).push_back({face.normal, face.offset, face.error_bound, sides});
    return {};
  }
  std::vector<LineCorner> line;
  for (const auto& [corner, at] : on_line) line.push_back(at);
  std::stable_sort(line.begin(), line.end(),
                   [](const LineCorner& a, const LineCorner& b) { return a.along < b.along; });
  int is_below = 0;
  int is_above = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    is_below += line[i].below;
    is_above += line[i].above;
    const bool last = i + 1 == line.size();
    if (is_below < 0 || is_above < 0 || is_below > (last ? 0 : 1) || is_above > (last ? 0 : 1))
      return crossed(corners[line[i].corner]);
    if (is_below == 1) below.sides.push_back({line[i + 1].corner, line[i].corner});
    if (is_above == 1) above.sides.push_back({line[i].corner, line[i + 1].corner});
  }
  halves.below.push_back(std::move(below));
  halves.above.push_back(std::move(above));
  return {};
}

/// Closes a half with the sides that have no partner; `normal` is the cap's.
Result<void> close_with_cap(const Corners& corners, const Vec3& normal, double offset, Solid& half) {
  std::map<SolidSide, int> open;  // how many without a partner
  for (const SolidFace& face : half)
    for (const auto& [tail, head] : face.sides) {
      int& partners = open[{head, tail}];
      if (partners > 0) {
        --partners;
      } else {
        ++open[{tail, head}];
      }
    }
  SolidFace cap{normal, offset, tolerances::kCoplanarMeshSine, {}};
  for (const auto& [side, count] : open)
    for (int i = 0; i < count; ++i) {
      if (corners.at(side[0]) != Where::kOn || corners.at(side[1]) != Where::kOn)
        return crossed(corners[side[0]]);
      cap.sides.push_back({side[1], side[0]});
    }
  if (!cap.sides.empty()) half.push_back(std::move(cap));
  return {};
}

}  // namespace

Result<Halves> cut(std::vector<Vec3>& all, const Solid& solid, const CutPlane& plane, double noise) {
  Corners corners(all, solid, plane, noise);
  Halves halves;
  for (const SolidFace& face : solid) {
    const std::vector<SolidSide> sides = corners.split(face);
    if (Result<void> done = cut_face(corners, plane, face, sides, halves); !done) return done.error();
  }
  if (Result<void> done = close_with_cap(corners, plane.normal, plane.offset, halves.below); !done)
    return done.error();
  if (Result<void> done = close_with_cap(corners, -plane.normal, -plane.offset, halves.above); !done)
    return done.error();
  return halves;
}

}  // namespace tactum::inline v0_1::detail
