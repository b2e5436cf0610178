#pragma once
/// The one convention of contact, and its numbers. Everything is in A's frame; A and B are convex pieces,
/// X_AB is B's pose in A.
///
///            A   /                     n (= n_BA_A): unit, from B to A
///          -----*  p_a                 distance = n . (p_a - p_b), negative when they overlap
///               ^                      p_a = p_b + n distance
///               | n
///          -----*  p_b                 moving A by  +n max(0, -distance)  just separates an overlapping pair
///            B   \.                    a force  +n f, f >= 0,  acts on A at p_a, its opposite on B at p_b
///
/// Swapping A and B keeps the distance, turns the normal around and swaps the points. Tested for every query.

#include <array>
#include <cstdint>

#include "tactum/base/static_vector.h"
#include "tactum/geometry/feature.h"
#include "tactum/math/pose.h"

namespace tactum::inline v0_1 {

/// A feature of A and one of B.
struct FeaturePair {
  Feature a, b;
  bool empty() const noexcept { return a.index < 0 || b.index < 0; }
};

/// Four pairs of vertices of A and B. While the tetrahedron of their differences holds the origin the pieces
/// share a point; all zero when none were needed. Pieces have at most 65 535 vertices.
struct OverlapProof {
  std::array<std::uint16_t, 4> a{}, b{};
  bool known = false;
};

/// The closest features of a pair in the last frame, from which the tracker begins. Value-initialised means
/// none.
struct PairCache {
  Feature a, b;
  Vec3 normal_A = Vec3::Zero();  ///< last normal from B to A, unit, or zero when there was none [-]
  OverlapProof overlap;          ///< known when they overlapped in the last frame
  // Of an overlapping pair: the next smaller minima of depth, and the explorer (penetration.h).
  std::array<FeaturePair, 2> candidate_minima{};
  FeaturePair explorer;
  std::uint32_t turn = 0;             ///< frames tracked inside
  std::uint32_t explorer_starts = 0;  ///< directions tried as starts of an explorer
  std::uint32_t explorer_turns = 0;   ///< frames in which the explorer has walked
};

/// Why a query stopped.
enum class Stop : std::uint8_t {
  kCertified,  ///< the answer's own support planes prove it
  kFallback,   ///< the walk did not end certified; a slower method answered, and its answer is certified
  kBounded,    ///< out of steps: the value is usable but not proved; NaN for a pose that is not finite
};

/// Answer of the distance and penetration queries; see the picture above.
struct PairDistance {
  double distance = 0.0;       ///< signed [m]
  Vec3 p_a = Vec3::Zero();     ///< witness point on A, A's frame [m]
  Vec3 p_b = Vec3::Zero();     ///< witness point on B, A's frame [m]
  Vec3 normal = Vec3::Zero();  ///< n_BA_A, unit [-]
  Feature a, b;                ///< the features the witness points lie on
  /// How much less than `distance` the signed distance can be at most [m]: below 1e-9 of the size when
  /// certified, infinite when nothing is known.
  double error_bound = 0.0;
  Stop stop = Stop::kBounded;
  int steps = 0;  ///< feature pairs visited
  bool certified() const { return stop != Stop::kBounded; }
};

/// One point of a contact patch. The points of a patch represent an integral over its area: their weights add
/// up to one.
struct ContactPoint {
  Vec3 p_a = Vec3::Zero();  ///< on A, A's frame [m]
  Vec3 p_b = Vec3::Zero();  ///< on B, A's frame [m]
  double distance = 0.0;    ///< normal . (p_a - p_b) [m]
  double weight = 0.0;      ///< fraction of the patch's stiffness [-]
  std::uint64_t id = 0;  ///< the same from frame to frame while the features of the patch and its kind stay
};

/// The identity of a point: its two features, and its place (below eight) among the points they can have.
constexpr std::uint64_t point_id(const Feature& a, const Feature& b, std::uint64_t place) noexcept {
  const auto name = [](const Feature& f) {
    return static_cast<std::uint64_t>(f.kind) | static_cast<std::uint64_t>(f.index) << 2;
  };
  return name(a) << 33 | name(b) << 3 | place;
}

/// Where two convex pieces touch or nearly touch: one normal and up to four points (quadrature of the clipped
/// area).
struct Manifold {
  Vec3 normal = Vec3::Zero();  ///< n_BA_A, unit [-]
  Feature a, b;                ///< features the patch lies on
  double area = 0.0;           ///< of the clipped polygon, zero for points and segments [m^2]
  static constexpr std::size_t kMostPoints = 4;
  StaticVector<ContactPoint, kMostPoints> points;
};

}  // namespace tactum::inline v0_1
