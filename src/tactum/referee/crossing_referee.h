#pragma once
/// Judges the poses of a world's bodies from frame to frame: whether surfaces cross, whether a part has got
/// into another one, and whether parts that hang in each other still do, and no others.

#include <array>
#include <map>
#include <span>
#include <vector>

#include "tactum/math/pose.h"
#include "tactum/referee/crossing.h"
#include "tactum/referee/mesh_loops.h"

namespace tactum::inline v0_1 {

/// A body as the referee sees it.
struct RefereedBody {
  const TriangleMesh* surface = nullptr;  ///< whose equal corners are one; must outlive the referee
  bool moves = true;                      ///< two bodies that do not move are never judged
  int no_contact_with = -1;               ///< nor is this one with the body of this number; -1: none
};

/// What is wrong with two bodies in a frame.
struct Crossing {
  int body_a = -1, body_b = -1;
  bool surfaces_cross = false;  ///< the triangles named cross
  bool inside = false;          ///< a piece of one got inside the other, or out of it, since the start
  bool links_changed = false;  ///< the loops of one go through those of the other otherwise than at the start
  std::array<int, 2> triangles{-1, -1};
};

class CrossingReferee {
 public:
  /// With the bodies where they start. A pair that crosses there is not judged.
  CrossingReferee(std::span<const RefereedBody> bodies, std::span<const Pose> X_WB);

  /// The faults at these poses. Costs the triangles near others, and for bodies with holes the product of
  /// their loops' sides.
  std::vector<Crossing> judge(std::span<const Pose> X_WB) const;
  /// Pairs of bodies that cross at the start.
  int crossing_at_start() const noexcept { return crossing_at_start_; }

 private:
  struct Judged {
    RefereedBody body;
    CrossingMesh mesh;
    bool encloses = false;        // closed and wound alike: it has an inside
    std::vector<Vec3> witnesses;  // a corner of every connected piece
    std::vector<ClosedLine> loops;
    Vec3 center = Vec3::Zero();
    double radius = 0.0;
  };
  /// What cannot change unless surfaces cross: for every witness whether it is inside, and how often loops go
  /// through each other.
  struct Topology {
    std::vector<char> inside;
    std::vector<int> links;
  };

  bool judges(std::size_t a, std::size_t b) const;
  bool near(std::size_t a, std::size_t b, std::span<const Pose> X_WB) const;
  Topology topology(std::size_t a, std::size_t b, const Pose& X_AB) const;

  std::vector<Judged> bodies_;
  std::map<std::array<std::size_t, 2>, Topology> at_start_;
  std::map<std::array<std::size_t, 2>, bool> crossed_at_start_;
  int crossing_at_start_ = 0;
};

}  // namespace tactum::inline v0_1
