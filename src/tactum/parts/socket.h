#pragma once
/// A hexagonal socket and its key, as convex pieces that share faces and overlap nowhere.
///
///         ___________ long arm        The key's short arm stands on z = 0, its long arm lies along +x; the
///        /___________|                socket's floor, where it has one, lies below z = 0: equal poses put
///   ____| |____                       the key into the socket, on its floor. Both have two flats across y.
///  |    | |    | z = depth            The arms are hexagonal prisms that meet on the plane halfway between.
///  |    |_|    |
///  |___________| z = 0
///      floor

#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// An L-shaped hexagon key [ISO 2014b, 2936].
struct HexKey {
  double across_flats_m = 0.006;  ///< [m]
  double long_m = 0.09;           ///< along x, from the corner's outside to the end [m]
  double short_m = 0.032;         ///< along z, from the tip to the corner's outside [m]
};

/// The short arm, then the long one.
Result<std::vector<Polytope>> hex_key_pieces(const HexKey& key);

/// A round head with a hexagonal hole that leaves `clearance_m` between it and a key.
struct HexSocket {
  double across_flats_m = 0.006;  ///< of the key it is for [m]
  double clearance_m = 0.0001;    ///< hole less key, across flats [m]
  double diameter_m = 0.013;      ///< of the circle the head's corners lie on [m]
  double depth_m = 0.004;         ///< of the hole [m]
  double floor_m = 0.004;         ///< material under the hole; 0: the hole goes through [m]
  int facets_per_side = 4;        ///< sides of the head for each of the hole's, 1 to 32 [-]
};

/// Six walls, then the floor if there is one.
Result<std::vector<Polytope>> hex_socket_pieces(const HexSocket& socket);

}  // namespace tactum::inline v0_1
