#pragma once
/// Spur gears with involute teeth, made of convex pieces: one per tooth and one hub, so that a gear of 18
/// teeth has 19 pieces and about 430 faces [Gregory 2000, 6.2].
///
///          tip            Where a circle of radius R cuts it, half a tooth spans, seen from the axis, the
///        ______           angle
///       /      \              psi(R) = s / (2 r) + inv(alpha) - inv(acos(r_b / R)),   inv(x) = tan(x) - x
///      | tooth  |         with r the pitch radius, r_b = r cos(alpha) the base radius, s the tooth's
///      |________|         thickness on the pitch circle. Below the base circle the flank is radial.
///    --/  hub   \--
///
/// A tooth widens along its radial feet and narrows along its involutes, tangent where they meet: its outline
/// is convex as it stands. Its flat foot is one side of the hub, a prism of 2 N sides, so pieces share a face
/// and overlap nowhere; volumes add up. Corners lie on the true profile and chords inside the tooth, so that
/// facets only ever add play. Axis z, mid-width at z = 0, tooth 0 centred on +x.
///
/// Two such gears of one module and pressure angle turn at the ratio of their teeth with `backlash_m` of
/// play. A profile shift of x modules moves tip and root outward by it and widens the tooth by 2 x tan(alpha)
/// modules on the pitch circle; a shifted pair stands at another distance, where its working pressure angle
/// obeys inv(alpha_w) = inv(alpha) + 2 (x_1 + x_2) tan(alpha) / (z_1 + z_2) [ISO 2007, 21771].
///
/// The same solid is to be had as one closed surface, a twin of gears that come as meshes.

#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

struct Gear {
  int teeth = 18;                         ///< 8 to 400, and enough to need no undercut [-]
  double module_m = 0.004;                ///< pitch diameter per tooth [m]
  double pressure_angle_rad = kPi / 9.0;  ///< 20 degrees [rad]
  double addendum = 1.0;                  ///< tooth above the pitch circle, in modules [-]
  double dedendum = 1.25;                 ///< tooth below the pitch circle, in modules [-]
  double face_width_m = 0.012;            ///< along the axis [m]
  double profile_shift = 0.0;             ///< of the tooth outward, in modules, -0.5 to 1 [-]
  double backlash_m = 0.0003;             ///< play on the pitch circle of a pair of such gears [m]
  int flank_facets = 8;                   ///< chords along each involute, 2 to 256 [-]

  double pitch_radius_m() const { return 0.5 * module_m * teeth; }
  double base_radius_m() const;
  double tip_radius_m() const { return pitch_radius_m() + (addendum + profile_shift) * module_m; }
  double root_radius_m() const { return pitch_radius_m() - (dedendum - profile_shift) * module_m; }
};

/// A convex polygon, corners counter-clockwise [m].
using Polygon = std::vector<Vec2>;

/// The gear seen along its axis: the teeth in order, then the hub. An error names the number of the gear that
/// is impossible.
Result<std::vector<Polygon>> gear_outlines(const Gear& gear);

/// The same with its width: the teeth, then the hub.
Result<std::vector<Polytope>> gear_pieces(const Gear& gear);

/// The same as one closed mesh: 4 (flank_facets + 2) triangles a tooth on its rim and as many on the two
/// faces (flank_facets + 1 where there is no radial foot).
Result<TriangleMesh> gear_surface(const Gear& gear);

/// Distance of the axes at which the pair has the play `backlash_m` (half of it from each). Base circles are
/// not brought closer than touching [m].
double centre_distance(const Gear& a, const Gear& b);

/// Rotation of b at a + (centre_distance, 0, 0) that puts a gap of b before tooth 0 of an unturned a [rad].
double meshing_angle(const Gear& b);

}  // namespace tactum::inline v0_1
