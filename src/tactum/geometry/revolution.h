#pragma once
/// Surfaces of revolution in a triangle mesh: the circles about one axis on which its corners lie.
///
///        .--------.      corners of a turned part, a roller or a tube stand evenly on circles; the facets
///       /          \     between two circles stand for a cylinder or a cone
///      |   axis     |
///       \    +     /     a circle counts where its corners follow each other by less than the crease,
///        '--------'      with a facet outward from the axis beside each of its sides
///
/// Contacts are found by the facets and are then those of the circles (contact/revolved_contact.h). Corners
/// of bores, whose facets face the axis, belong to none.

#include <cstdint>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

struct Revolution {
  struct Circle {
    double along_m = 0.0;   ///< of its plane, from `center` along the axis [m]
    double radius_m = 0.0;  ///< [m]
    double from_m = 0.0;    ///< the cylinder of this radius, to which it belongs, goes along the axis ...
    double to_m = 0.0;      ///< ... from here to here; the plane of the circle where there is none [m]
    std::int32_t first_vertex = -1;
  };
  Vec3 center = Vec3::Zero();  ///< of all corners, on the axis [m]
  Vec3 axis = Vec3::UnitZ();   ///< unit [-]
  std::vector<Circle> circles;
  std::vector<std::int32_t> circle_of;  ///< of each vertex; -1: on none. Empty where there is no circle
  double bulge_m = 0.0;                 ///< greatest distance of a circle from the facets [m]
};

/// The circles of a welded mesh about an axis of symmetry of its corners; without any where it has no such
/// axis. Facets that meet at `crease_rad` or more are no parts of one curved surface. Linear but for sorting;
/// a mesh whose corners are not spread evenly about an axis costs one pass.
Revolution find_revolution(const TriangleMesh& mesh, double crease_rad);

}  // namespace tactum::inline v0_1
