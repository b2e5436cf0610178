#pragma once
/// Another library's distance of two triangle surfaces, for comparison in `tactum-bench clearance`.

#include <memory>

#include "tactum/geometry/triangle_mesh.h"
#include "tactum/math/pose.h"

namespace tactum::bench {

class DistancePeer {
 public:
  DistancePeer() = default;
  DistancePeer(const DistancePeer&) = delete;
  DistancePeer& operator=(const DistancePeer&) = delete;
  virtual ~DistancePeer() = default;
  /// Smallest distance with B at X_AB; zero or less when they touch or cross [m].
  virtual double distance(const Pose& X_AB) = 0;
};

/// FCL's distance of two BVHModel<OBBRSS>.
std::unique_ptr<DistancePeer> make_fcl_distance(const TriangleMesh& a, const TriangleMesh& b);

/// The same where this build has FCL; null elsewhere.
std::unique_ptr<DistancePeer> distance_peer(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace tactum::bench
