#include "tactum/parts/gear.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "tactum/parts/generated_parts.h"
#include "tactum/parts/measure_checks.h"

namespace tactum::inline v0_1 {
namespace {

double involute(double angle) { return std::tan(angle) - angle; }

/// Angle by which half a tooth spans at `radius`, at or above the base circle.
double half_angle(const Gear& gear, double radius) {
  const double thickness = 0.5 * (kPi * gear.module_m - gear.backlash_m) +
                           2.0 * gear.profile_shift * gear.module_m * std::tan(gear.pressure_angle_rad);
  const double slope = std::acos(std::min(1.0, gear.base_radius_m() / radius));
  return 0.5 * thickness / gear.pitch_radius_m() + involute(gear.pressure_angle_rad) - involute(slope);
}

/// Fewest teeth a rack of this addendum does not undercut.
int fewest_teeth(const Gear& gear) {
  const double sine = std::sin(gear.pressure_angle_rad);
  return static_cast<int>(std::ceil(2.0 * (gear.addendum - gear.profile_shift) / (sine * sine)));
}

std::optional<Error> defect(const Gear& gear) {
  const auto bad = [](const char* what, const std::string& found, const std::string& expected) {
    return Error{fmt::format("the gear's {} cannot be", what), found, expected, ""};
  };
  if (!positive(gear.module_m)) return bad("module", fmt::format("{} m", gear.module_m), "more than 0");
  if (!positive(gear.face_width_m))
    return bad("face width", fmt::format("{} m", gear.face_width_m), "more than 0");
  if (!(gear.pressure_angle_rad >= kPi / 18.0 && gear.pressure_angle_rad <= kPi / 6.0))
    return bad("pressure angle", fmt::format("{:.3f} rad", gear.pressure_angle_rad), "10 to 30 degrees");
  if (!(gear.addendum > 0.0 && gear.addendum <= 1.5))
    return bad("addendum", fmt::format("{}", gear.addendum), "0 to 1.5 modules");
  if (!(gear.dedendum > gear.addendum && gear.dedendum <= 2.0))
    return bad("dedendum", fmt::format("{}", gear.dedendum), "more than the addendum, 2 modules at most");
  if (!(gear.profile_shift >= -0.5 && gear.profile_shift <= 1.0))
    return bad("profile shift", fmt::format("{}", gear.profile_shift), "-0.5 to 1 modules");
  if (gear.teeth < std::max(8, fewest_teeth(gear)) || gear.teeth > 400)
    return bad("number of teeth", fmt::format("{}", gear.teeth),
               fmt::format("{} to 400 (fewer would be undercut)", std::max(8, fewest_teeth(gear))));
  if (!(gear.backlash_m >= 0.0 && gear.backlash_m <= 0.5 * gear.module_m))
    return bad("backlash", fmt::format("{} m", gear.backlash_m), "0 to half the module");
  if (gear.flank_facets < 2 || gear.flank_facets > 256)
    return bad("number of flank facets", fmt::format("{}", gear.flank_facets), "2 to 256");
  if (!(half_angle(gear, gear.tip_radius_m()) > 0.0))
    return bad("tip", "a tooth that is pointed below its tip circle",
               "a smaller addendum, profile shift or pressure angle");
  if (!(half_angle(gear, std::max(gear.base_radius_m(), gear.root_radius_m())) < kPi / gear.teeth))
    return bad("foot", "teeth that meet at their feet", "a smaller profile shift or pressure angle");
  return std::nullopt;
}

/// Corners of one flank from the foot up, as (radius, half angle).
std::vector<Vec2> flank(const Gear& gear) {
  const double base = gear.base_radius_m();
  const double root = gear.root_radius_m();
  const auto roll = [base](double radius) {
    return std::sqrt(std::max(0.0, radius * radius / (base * base) - 1.0));
  };
  std::vector<Vec2> corners;
  const double start = std::max(base, root);
  if (root < base) corners.emplace_back(root, half_angle(gear, base));
  const double first = roll(start);
  const double last = roll(gear.tip_radius_m());
  for (int i = 0; i <= gear.flank_facets;
       ++i) {  // equal steps of the roll angle: short chords where it is curved
    const double t = first + (last - first) * i / gear.flank_facets;
    const double radius = i == 0 ? start : base * std::sqrt(1.0 + t * t);
    corners.emplace_back(radius, half_angle(gear, radius));
  }
  return corners;
}

Vec2 polar(double radius, double angle) { return {radius * std::cos(angle), radius * std::sin(angle)}; }

}  // namespace

double Gear::base_radius_m() const { return pitch_radius_m() * std::cos(pressure_angle_rad); }

Result<std::vector<Polygon>> gear_outlines(const Gear& gear) {
  if (const std::optional<Error> error = defect(gear)) return *error;
  const std::vector<Vec2> side = flank(gear);
  std::vector<Polygon> outlines;
  Polygon hub;
  for (int tooth = 0; tooth < gear.teeth; ++tooth) {
    const double middle = 2.0 * kPi * tooth / gear.teeth;
    Polygon outline;
    for (const Vec2& corner : side) outline.push_back(polar(corner.x(), middle - corner.y()));
    for (std::size_t i = side.size(); i-- > 0;) outline.push_back(polar(side[i].x(), middle + side[i].y()));
    hub.push_back(outline.front());
    hub.push_back(outline.back());
    outlines.push_back(std::move(outline));
  }
  outlines.push_back(std::move(hub));
  return outlines;
}

Result<std::vector<Polytope>> gear_pieces(const Gear& gear) {
  const Result<std::vector<Polygon>> outlines = gear_outlines(gear);
  if (!outlines) return outlines.error();
  std::vector<Polytope> pieces;
  for (const Polygon& outline : *outlines) {
    Result<Polytope> piece = extruded(outline, -0.5 * gear.face_width_m, 0.5 * gear.face_width_m);
    if (!piece) return piece.error();
    pieces.push_back(std::move(*piece));
  }
  return pieces;
}

Result<TriangleMesh> gear_surface(const Gear& gear) {
  const Result<std::vector<Polygon>> outlines = gear_outlines(gear);
  if (!outlines) return outlines.error();
  const int corners = static_cast<int>(outlines->front().size());  // of a tooth
  const int rim = corners * gear.teeth;                            // of a face
  TriangleMesh mesh;
  for (const double z : {-0.5 * gear.face_width_m, 0.5 * gear.face_width_m}) {
    for (int tooth = 0; tooth < gear.teeth; ++tooth)
      for (const Vec2& corner : (*outlines)[static_cast<std::size_t>(tooth)])
        mesh.vertices.emplace_back(corner.x(), corner.y(), z);
    mesh.vertices.emplace_back(0.0, 0.0, z);
  }
  const int above = rim + 1;  // from a vertex of the lower face to the upper one's
  const auto add_to_faces = [&](int a, int b, int c) {
    mesh.triangles.push_back({a + above, b + above, c + above});
    mesh.triangles.push_back({a, c, b});
  };
  for (int tooth = 0; tooth < gear.teeth; ++tooth) {
    const int foot = tooth * corners;
    const int end = foot + corners - 1;
    for (int i = 0; 2 * i + 2 < corners; ++i) {  // across the tooth, flank to flank
      add_to_faces(foot + i, foot + i + 1, end - i - 1);
      add_to_faces(foot + i, end - i - 1, end - i);
    }
    add_to_faces(rim, foot, end);
    add_to_faces(rim, end, (end + 1) % rim);
  }
  for (int i = 0; i < rim; ++i) {
    const int next = (i + 1) % rim;
    mesh.triangles.push_back({i, next, next + above});
    mesh.triangles.push_back({i, next + above, i + above});
  }
  return mesh;
}

double centre_distance(const Gear& a, const Gear& b) {
  const double reference = a.pitch_radius_m() + b.pitch_radius_m();
  const double shift = a.profile_shift + b.profile_shift;
  if (shift == 0.0) return reference;
  const double alpha = a.pressure_angle_rad;
  const double wanted = std::max(0.0, involute(alpha) + 2.0 * shift * std::tan(alpha) / (a.teeth + b.teeth));
  // From above the root of a convex function Newton's steps come down to it.
  double working = std::cbrt(3.0 * wanted);
  for (int i = 0; i < 20 && working > 0.0; ++i) {
    const double slope = std::tan(working) * std::tan(working);
    working -= (involute(working) - wanted) / slope;
  }
  return reference * std::cos(alpha) / std::cos(working);
}

double meshing_angle(const Gear& b) { return kPi - kPi / b.teeth; }

}  // namespace tactum::inline v0_1
