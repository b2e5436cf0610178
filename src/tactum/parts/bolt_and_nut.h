#pragma once
/// A hexagon bolt and its nut with a real right-hand thread, as closed triangle meshes.
///
///      ___________         z = length     The bolt stands on its head, thread up; the nut's lower face lies
///     /___________/  tip                  on z = 0. Equal poses seat the nut on the head, in the middle of
///     \___________\                       its play; turned by an angle t (counter-clockwise from above) and
///     /___________/  ridge, P a turn      raised by P t / (2 pi) it is in the thread again. Axis z, two
///   __\___________\__      z = 0          corners of the hexagons on the x axis.
///  |      head       |
///  |_________________|                    A thread is a sheet over (angle, z): columns of corners at equal
///                                         angles, joined by strips that follow the helix.
///
///  bolt  a cylinder of the minor diameter with a ridge that rises from it over half a turn and sinks into it
///        over half a turn, half a pitch from either end
///  nut   the groove goes through; the faces cut it where it is
///
/// Facets only ever add play: the bolt's corners lie on the true thread, the nut's facets touch it, and each
/// square of the strips is split along the diagonal that leaves less material. At `facets_per_turn` = n the
/// play grows by at most r (1 - cos(pi / n)) along the flank's normal. Cost: 8 n triangles a turn.

#include <optional>
#include <string>

#include "tactum/geometry/triangle_mesh.h"
#include "tactum/parts/metric_thread.h"

namespace tactum::inline v0_1 {

/// The sizes of bolt and nut; a pair needs equal size and facets.
struct ScrewShape {
  std::string size = "M16";
  std::string tolerance_class = "medium";  ///< metric_thread.h
  std::optional<double> clearance_m = {};  ///< between the flanks, in place of a class [m]
  double length_m = 0.04;                  ///< of a bolt under its head: 3 to 100 pitches [m]
  int facets_per_turn = 64;                ///< a multiple of 16, 16 to 256 [-]
};

/// The fit of the shape. Errors name the value that is unknown or out of range.
Result<ThreadFit> screw_fit(const ScrewShape& shape);

Result<TriangleMesh> bolt_mesh(const ScrewShape& shape);

/// The height is the standard's, rounded to a whole number of n-ths of the pitch, so that the thread's edges
/// leave through the faces at corners. `length_m` is ignored.
Result<TriangleMesh> nut_mesh(const ScrewShape& shape);

}  // namespace tactum::inline v0_1
