#include "bench/referee.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "oracles/exhaustive.h"
#include "tactum/collision/penetration.h"

namespace tactum::bench {
namespace {

/// Rounding in sums over parts of 0.1 m, with a wide margin; a proof holds to this.
constexpr double kRounding_m = 1e-13;
/// Pairs of edges up to which the long-double referee checks every frame.
constexpr std::size_t kSmallPair = 400;

std::vector<Vec3> corners_of(const Polytope& P, const Feature& feature) {
  const auto vertex = [&](int v) { return P.vertices[static_cast<std::size_t>(v)]; };
  const auto at = static_cast<std::size_t>(feature.index);
  if (feature.kind == FeatureKind::kVertex) return {vertex(feature.index)};
  if (feature.kind == FeatureKind::kEdge) return {vertex(P.edges[at].tail), vertex(P.edges[at].head)};
  std::vector<Vec3> corners;
  for (int i = 0; i < P.faces[at].count; ++i)
    corners.push_back(vertex(P.face_vertices[static_cast<std::size_t>(P.faces[at].first + i)]));
  return corners;
}

double off_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 u = b - a;
  const double t = std::clamp(u.dot(p - a) / u.squaredNorm(), 0.0, 1.0);
  return (p - a - t * u).norm();
}

/// The distance of `p` from the triangle: zero inside, by barycentric coordinates.
double off_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double nn = n.squaredNorm();
  if (nn > 0.0) {
    const double u = n.dot((c - b).cross(p - b)) / nn;
    const double v = n.dot((a - c).cross(p - c)) / nn;
    const double w = n.dot((b - a).cross(p - a)) / nn;
    if (u >= 0.0 && v >= 0.0 && w >= 0.0) return std::abs(n.dot(p - a)) / std::sqrt(nn);
  }
  return std::min({off_segment(p, a, b), off_segment(p, b, c), off_segment(p, c, a)});
}

/// The largest distance of a point from the feature on which it should lie.
double off_feature(const Polytope& P, const Feature& feature, const Vec3& p) {
  const std::vector<Vec3> c = corners_of(P, feature);
  if (c.size() == 1) return (p - c[0]).norm();
  if (c.size() == 2) return off_segment(p, c[0], c[1]);
  double off = std::numeric_limits<double>::infinity();
  for (std::size_t i = 2; i < c.size(); ++i) off = std::min(off, off_triangle(p, c[0], c[i - 1], c[i]));
  return off;
}

Truth apart(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& answer) {
  Truth truth;
  truth.low = scanned_gap(A, B, X_AB, answer.normal);
  truth.high = (answer.p_a - answer.p_b).norm() + off_feature(A, answer.a, answer.p_a) +
               off_feature(B, answer.b, X_AB.inverse() * answer.p_b);
  truth.proved = truth.high - truth.low <= 1e-9;  // [m]
  if (!truth.proved && A.edges.size() * B.edges.size() <= kSmallPair) {
    truth.low = truth.high = static_cast<double>(oracle::signed_distance(A, B, X_AB));
    truth.proved = true;
  }
  return truth;
}

Truth overlapping(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& answer,
                  bool look_at_all) {
  Truth truth;
  if (A.edges.size() * B.edges.size() <= kSmallPair) {
    truth.low = truth.high = static_cast<double>(oracle::axes_separation(A, B, X_AB));
    truth.proved = true;
    return truth;
  }
  PairCache cold;
  truth.low = std::max(scanned_gap(A, B, X_AB, answer.normal),
                       scanned_gap(A, B, X_AB, penetration_depth(A, B, X_AB, cold).normal));
  if (look_at_all) {
    truth.low = std::max(truth.low, scanned_gap(A, B, X_AB, penetration_exhaustive(A, B, X_AB).normal));
    truth.proved = true;
  }
  truth.high = truth.low;
  return truth;
}

}  // namespace

double Truth::error_of(double distance) const {
  return std::max({0.0, low - kRounding_m - distance, distance - high - kRounding_m});
}

double scanned_gap(const Polytope& A, const Polytope& B, const Pose& X_AB, const Vec3& n_A) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Vec3& v : A.vertices) low = std::min(low, n_A.dot(v));
  const Vec3 n_B = X_AB.R.transpose() * n_A;
  for (const Vec3& v : B.vertices) high = std::max(high, n_B.dot(v));
  return low - (high + n_A.dot(X_AB.p));
}

std::vector<Truth> truths(const Shape& a, const Shape& b, const Recording& recording, double edge_pairs) {
  const Polytope& A = a.polytope;
  const Polytope& B = b.polytope;
  const double work = static_cast<double>(A.edges.size()) * static_cast<double>(B.edges.size());
  const auto frames = recording.poses.size();
  const auto looks = std::min(frames, static_cast<std::size_t>(edge_pairs / work));
  std::vector<Truth> result;
  for (std::size_t i = 0; i < frames; ++i) {
    const PairDistance& answer = recording.answers[i];
    const bool look = looks > 0 && i % (frames / looks) == 0;
    result.push_back(answer.distance > 0.0 ? apart(A, B, recording.poses[i], answer)
                                           : overlapping(A, B, recording.poses[i], answer, look));
  }
  return result;
}

}  // namespace tactum::bench
