#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/collision/patch_work.h"

namespace tactum::inline v0_1::detail {
namespace {

/// Intervals of a line, apart from each other: one, except where the stretches of an edge leave a gap.
class Intervals {
 public:
  Intervals() noexcept = default;
  explicit Intervals(const PatchInterval& only) noexcept { add(only); }

  /// An interval that touches or overlaps others is merged with them. Beyond the room the last one is
  /// extended.
  void add(PatchInterval next) noexcept {
    if (next.empty()) return;
    std::size_t kept = 0;
    for (const PatchInterval& old : intervals_) {
      const bool apart = old.low > next.high + kTouch || next.low > old.high + kTouch;
      if (apart)
        intervals_[kept++] = old;
      else
        next = {std::min(next.low, old.low), std::max(next.high, old.high)};
    }
    while (intervals_.size() > kept) intervals_.pop_back();
    if (intervals_.push_back(next)) return;
    PatchInterval& last = intervals_.back();
    last = {std::min(next.low, last.low), std::max(next.high, last.high)};
  }
  void keep_below(double at0, double at1, double limit) noexcept {
    std::size_t kept = 0;
    for (PatchInterval interval : intervals_) {
      interval.keep_below(at0, at1, limit);
      if (!interval.empty()) intervals_[kept++] = interval;
    }
    while (intervals_.size() > kept) intervals_.pop_back();
  }
  bool empty() const noexcept { return intervals_.empty(); }
  const PatchInterval* begin() const noexcept { return intervals_.begin(); }
  const PatchInterval* end() const noexcept { return intervals_.end(); }

 private:
  static constexpr double kTouch = tolerances::kCoplanar;  // in lengths of the edge
  StaticVector<PatchInterval, 8> intervals_;
};

/// The cut that a leaning face makes: only this fraction of its rise is kept. Stated by the rise at a strip's
/// ends.
struct StripCut {
  double at0 = 0.0, at1 = 0.0, share = 1.0;
};

/// The part of `v` square to unit `n`.
Vec3 across(const Vec3& v, const Vec3& n) noexcept { return v - n * n.dot(v); }

/// The least value of a linear function over `kept`, or with a negative sign the largest.
double least_of(const Intervals& kept, double at0, double at1, double sign = 1.0) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const PatchInterval& interval : kept)
    for (double s : {interval.low, interval.high}) least = std::min(least, sign * (at0 + (at1 - at0) * s));
  return sign * least;
}

/// Two points with the length's moments: the Gauss points where it is one interval.
std::pair<double, double> quadrature(const Intervals& kept) noexcept {
  double length = 0.0;
  double middle = 0.0;
  for (const PatchInterval& interval : kept) {
    length += interval.high - interval.low;
    middle += (interval.high - interval.low) * 0.5 * (interval.high + interval.low);
  }
  if (!(length > 0.0)) return {kept.begin()->low, kept.begin()->low};
  middle /= length;
  double spread = 0.0;
  for (const PatchInterval& interval : kept) {
    const double own = interval.high - interval.low;
    const double off = 0.5 * (interval.high + interval.low) - middle;
    spread += own * (own * own / 12.0 + off * off);
  }
  const double half_length = std::sqrt(spread / length);
  return {middle - half_length, middle + half_length};
}

/// Two points on the kept part of a strip.
void interval_contact(const PatchWork& w, const Strip& strip, Intervals kept,
                      const StripCut& cut = {}) noexcept {
  const Vec3& n = w.closest.normal;
  const double gap0 = n.dot(strip.a0 - strip.b0);
  const double gap1 = n.dot(strip.a1 - strip.b1);
  if (kept.empty()) return point_contact(w);
  const double least = least_of(kept, gap0, gap1);
  if (least >= w.tolerance) return point_contact(w);
  kept.keep_below(gap0, gap1, cut_level(w, least));
  if (kept.empty()) return point_contact(w);
  if (cut.share < 1.0) {
    const double highest = std::max(0.0, least_of(kept, cut.at0, cut.at1, -1.0));
    kept.keep_below(cut.at0, cut.at1, highest * cut.share);
    if (kept.empty()) return point_contact(w);
  }
  const auto [first, second] = quadrature(kept);
  std::uint64_t name = w.name(4);
  for (double s : {first, second})
    w.out.points.push_back({strip.a0 + (strip.a1 - strip.a0) * s, strip.b0 + (strip.b1 - strip.b0) * s,
                            gap0 + (gap1 - gap0) * s, 0.5, name++});
}

/// An edge in the projection along the normal `n`: points along it and beside it, in fractions of its length.
class EdgeView {
 public:
  EdgeView(const Vec3& tail, const Vec3& head, const Vec3& n) noexcept
      : tail_(tail), flat_(across(head - tail, n)), per_length_sq_(1.0 / flat_.squaredNorm()) {}
  double along(const Vec3& p) const noexcept { return flat_.dot(p - tail_) * per_length_sq_; }
  double beside(const Vec3& p, const Vec3& n) const noexcept {
    return n.dot(flat_.cross(p - tail_)) * per_length_sq_;
  }
  double length() const noexcept { return flat_.norm(); }

 private:
  Vec3 tail_, flat_;
  double per_length_sq_;
};

/// Both ends of an edge, in A's frame.
struct EdgeEnds {
  Vec3 tail, head;
};

EdgeEnds ends_of_a(const Polytope& A, int edge) noexcept {
  return {A.vertices[A.edges[edge].tail], A.vertices[A.edges[edge].head]};
}
EdgeEnds ends_of_b(const PatchWork& w, const Polytope& B, int edge) noexcept {
  return {w.X_AB * B.vertices[B.edges[edge].tail], w.X_AB * B.vertices[B.edges[edge].head]};
}

/// The part of a stretch, along the line of the contact's edge.
PatchInterval on_line(const EdgeView& line, const EdgeEnds& stretch, const PatchInterval& kept) noexcept {
  if (kept.empty()) return kept;
  const double from = line.along(stretch.tail);
  const double per_part = line.along(stretch.head) - from;
  const double low = from + per_part * kept.low;
  const double high = from + per_part * kept.high;
  return {std::min(low, high), std::max(low, high)};
}

/// A face of piece F, of A or of B, in the projection along the normal `n`, in F's frame.
struct FaceView {
  const Polytope& F;
  const Polytope::Face& face;
  const Vec3& n;
  double per_up;

  FaceView(const Polytope& piece, int index, const Vec3& normal) noexcept
      : F(piece), face(piece.faces[index]), n(normal), per_up(1.0 / face.normal.dot(normal)) {}
  /// From a point along the normal to the face's plane [m].
  double up(const Vec3& p) const noexcept { return (face.offset - face.normal.dot(p)) * per_up; }
  /// The part of a segment in the face's plane that is inside the face.
  PatchInterval inside(const Vec3& q0, const Vec3& q1) const noexcept {
    PatchInterval kept;
    for (int slot = face.first; slot < face.first + face.count; ++slot) {
      const Polytope::Side& side = F.sides[slot];
      const double at0 = side.normal.dot(q0) - side.offset;
      const double at1 = side.normal.dot(q1) - side.offset;
      if (at0 <= 0.0 && at1 <= 0.0) continue;  // as for most: no quotient is needed
      kept.keep_below(at0, at1, 0.0);
    }
    return kept;
  }
  /// How far the plane rises along the normal from the line of one of the face's edges, for each metre.
  Vec3 rise_from(const Vec3& tail, const Vec3& head) const noexcept {
    const Vec3 along = across(head - tail, n).normalized();
    const Vec3 slope = across(face.normal, n) * -per_up;
    return slope - along * along.dot(slope);
  }
};

/// An edge and the face over or under it: the two points at the edge's ends, on the face and on the edge.
struct EdgeAndFace {
  EdgeEnds edge, face;  // A's frame
  Vec3 face_0, face_1;  // on the face, in its piece's frame
  PatchInterval inside;

  /// `to_face`: from A's frame to the face's.
  template <class ToFace>
  EdgeAndFace(const EdgeEnds& ends, const FaceView& view, const Vec3& n_A, const ToFace& to_face) noexcept
      : edge(ends) {
    const Vec3 p0 = to_face(ends.tail);
    const Vec3 p1 = to_face(ends.head);
    const double up0 = view.up(p0);
    const double up1 = view.up(p1);
    face_0 = p0 + view.n * up0;
    face_1 = p1 + view.n * up1;
    face = {ends.tail + n_A * up0, ends.head + n_A * up1};
    inside = view.inside(face_0, face_1);
  }
};

/// The strip of an edge and the face over or under it, clipped by the face.
template <bool kFaceIsA>
void edge_over_face(const PatchWork& w) noexcept {
  const Vec3& n = w.closest.normal;
  const SupportingFeature& supporting = kFaceIsA ? w.a : w.b;
  const int edge = (kFaceIsA ? w.b : w.a).feature.index;
  const auto ends_of = [&](const Polytope& A, const Polytope& B, int e) {
    return kFaceIsA ? ends_of_b(w, B, e) : ends_of_a(A, e);
  };
  const auto to_face = [&](const Vec3& p) -> Vec3 {
    return kFaceIsA ? p : rotated_back(w.X_AB.R, p - w.X_AB.p);
  };
  const FaceView view(kFaceIsA ? w.A : w.B, supporting.feature.index, kFaceIsA ? n : w.n_B);
  const EdgeAndFace own(ends_of(w.A, w.B, edge), view, n, to_face);
  Intervals kept(own.inside);
  if (!w.others.empty()) {
    const EdgeView line(own.edge.tail, own.edge.head, n);
    for (const Stretch& other : w.others) {
      const FaceView beside(kFaceIsA ? *other.A : *other.B, (kFaceIsA ? other.a : other.b).index, view.n);
      const EdgeEnds ends = ends_of(*other.A, *other.B, (kFaceIsA ? other.b : other.a).index);
      kept.add(on_line(line, ends, EdgeAndFace(ends, beside, n, to_face).inside));
    }
  }
  StripCut cut;
  if (supporting.face_share < 1.0) {
    const Polytope::Edge& from = view.F.edges[supporting.edge];
    const Vec3& tail = view.F.vertices[from.tail];
    // A's face rises away from the contact along the normal, B's against it.
    const Vec3 rise = view.rise_from(tail, view.F.vertices[from.head]) * (kFaceIsA ? 1.0 : -1.0);
    cut = {rise.dot(own.face_0 - tail), rise.dot(own.face_1 - tail), supporting.face_share};
  }
  const EdgeEnds& a = kFaceIsA ? own.face : own.edge;
  const EdgeEnds& b = kFaceIsA ? own.edge : own.face;
  interval_contact(w, {a.tail, a.head, b.tail, b.head}, kept, cut);
}

}  // namespace

void edge_a_face_b(const PatchWork& w) noexcept { edge_over_face<false>(w); }
void face_a_edge_b(const PatchWork& w) noexcept { edge_over_face<true>(w); }

/// Parallel edges have an interval in common. Of edges that cross at a small angle it is the part about the
/// crossing where they are no farther apart sideways than the tolerance; the larger the angle, the less, down
/// to the crossing.
void edge_edge_contact(const PatchWork& w) noexcept {
  const Vec3& n = w.closest.normal;
  const EdgeEnds a = ends_of_a(w.A, w.a.feature.index);
  const EdgeEnds b = ends_of_b(w, w.B, w.b.feature.index);
  const EdgeView line(a.tail, a.head, n);
  // B's ends, in fractions of A's length along A and across it.
  const double s0 = line.along(b.tail);
  const double s1 = line.along(b.head);
  const double side0 = line.beside(b.tail, n);
  const double side1 = line.beside(b.head, n);
  const double rate = (side1 - side0) / (s1 - s0);  // tangent of the angle between them
  if (!(std::abs(rate) < w.angle)) return point_contact(w);
  PatchInterval about;  // the crossing
  about.low = -std::numeric_limits<double>::infinity();
  about.high = std::numeric_limits<double>::infinity();
  if (std::abs(rate) > tolerances::kSamePlane) {
    const double crossing = s0 - side0 / rate;
    const double apart = std::max(w.tolerance, 0.0) / line.length() * lean_falloff(std::abs(rate), w.angle);
    about = {crossing - apart / std::abs(rate), crossing + apart / std::abs(rate)};
  }
  const auto common = [&](const PatchInterval& of_a, double b0, double b1) -> PatchInterval {
    return {std::max({of_a.low, std::min(b0, b1), about.low}),
            std::min({of_a.high, std::max(b0, b1), about.high})};
  };
  Intervals kept(common({}, s0, s1));
  for (const Stretch& other : w.others) {
    const EdgeEnds of_b = ends_of_b(w, *other.B, other.b.index);
    kept.add(common(on_line(line, ends_of_a(*other.A, other.a.index), {}), line.along(of_b.tail),
                    line.along(of_b.head)));
  }
  const Vec3 b_per_part = (b.head - b.tail) / (s1 - s0);
  const Vec3 b0 = b.tail - b_per_part * s0;
  interval_contact(w, {a.tail, a.head, b0, b0 + b_per_part}, kept);
}

void strip_contact(const PatchWork& w, const Strip& strip) noexcept {
  interval_contact(w, strip, Intervals(PatchInterval()));
}

}  // namespace tactum::inline v0_1::detail
