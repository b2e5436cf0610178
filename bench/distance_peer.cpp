#include "bench/distance_peer.h"

namespace tactum::bench {

std::unique_ptr<DistancePeer> distance_peer([[maybe_unused]] const TriangleMesh& a,
                                            [[maybe_unused]] const TriangleMesh& b) {
#ifdef TACTUM_PEER_FCL
  return make_fcl_distance(a, b);
#else
  return nullptr;
#endif
}

}  // namespace tactum::bench
