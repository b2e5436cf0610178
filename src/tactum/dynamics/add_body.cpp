#include <fmt/format.h>

#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/world.h"

namespace tactum::inline v0_1 {
namespace {

bool not_negative(double value) { return std::isfinite(value) && value >= 0.0; }

bool is_rotation(const Mat3& R) {
  return (R * R.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < tolerances::kRotationNear &&
         R.determinant() > 0.0;
}

Result<void> check_part(const BodySpec& spec) {
  if (!spec.part || spec.part->surface.triangles.empty())
    return Error{"the body has no part", "none", "convex pieces or a surface", spec.name};
  const double off = spec.part->mass.center.norm();
  if (!(off <= tolerances::kCentered * spec.part->size))
    return Error{"the origin of the body's part is not its centre of mass",
                 fmt::format("{:.3g} m between them", off),
                 "a part made with PartOptions::about_center_of_mass", spec.name};
  return {};
}

Result<void> check_place(const BodySpec& spec) {
  if (!spec.X_WP.finite() || !spec.V_WB.finite())
    return Error{"the body's pose or velocity is not finite", "", "numbers", spec.name};
  if (!is_rotation(spec.X_WP.R))
    return Error{"the body's orientation is no rotation",
                 fmt::format("a matrix of determinant {:.6g}", spec.X_WP.R.determinant()),
                 "an orthogonal matrix of determinant 1", spec.name};
  return {};
}

Result<void> check_joint(const Joint& joint, const std::string& name) {
  if (!joint.axis_W.allFinite() || !joint.anchor_W.allFinite() || !std::isfinite(joint.rest))
    return Error{"the joint's axis, anchor or rest position is not finite", "", "numbers", name};
  const bool has_axis = joint.kind == JointKind::kHinge || joint.kind == JointKind::kSlider;
  if (has_axis && !(joint.axis_W.norm() > 0.0))
    return Error{"the joint's axis has no direction", "length 0", "any other length", name};
  if (!not_negative(joint.damping) || !not_negative(joint.friction) || !not_negative(joint.stiffness))
    return Error{"the joint's damping, friction or stiffness is negative or not finite",
                 fmt::format("{}, {}, {}", joint.damping, joint.friction, joint.stiffness), "0 or more",
                 name};
  if (!(joint.lower <= 0.0 && joint.upper >= 0.0 && joint.lower < joint.upper))
    return Error{"the joint's limits leave out its position at the start, 0",
                 fmt::format("{} to {}", joint.lower, joint.upper), "a negative and a positive one, or 0",
                 name};
  return {};
}

Result<void> check_load(const BodySpec& spec) {
  const BodyLoad& load = spec.load;
  if (!load.constant.finite())
    return Error{"the body's constant force or torque is not finite", "", "numbers", spec.name};
  if (!not_negative(load.damping_Ns_per_m) || !not_negative(load.damping_Nms_per_rad))
    return Error{"the body's damping is negative or not finite",
                 fmt::format("{} N s/m, {} N m s/rad", load.damping_Ns_per_m, load.damping_Nms_per_rad),
                 "0 or more", spec.name};
  if (spec.joint.kind == JointKind::kFixed && load.acts())
    return Error{"a fixed body has a load", "a force, a torque or damping", "a body that moves", spec.name};
  return {};
}

/// The factor of the part's mass and inertia.
Result<double> mass_factor(const BodySpec& spec) {
  if (spec.mass_kg && spec.density_kg_per_m3)
    return Error{"the body has two masses", "mass_kg and density_kg_per_m3", "one of them", spec.name};
  if (!spec.mass_kg && !spec.density_kg_per_m3) return 1.0;
  const double given = spec.mass_kg ? *spec.mass_kg : *spec.density_kg_per_m3;
  if (!(std::isfinite(given) && given > 0.0))
    return Error{spec.mass_kg ? "the body's mass is not positive" : "the body's density is not positive",
                 fmt::format("{} {}", given, spec.mass_kg ? "kg" : "kg/m^3"), "more than 0", spec.name};
  return spec.mass_kg ? given / spec.part->mass.mass : given * spec.part->mass.volume / spec.part->mass.mass;
}

}  // namespace

Result<int> World::add(const BodySpec& spec) {
  for (const Body& other : bodies)
    if (!spec.name.empty() && other.name == spec.name)
      return Error{"two bodies of one name", fmt::format("\"{}\"", spec.name), "a name of its own", ""};
  if (Result<void> sound = check_part(spec); !sound) return sound.error();
  if (Result<void> sound = check_place(spec); !sound) return sound.error();
  if (Result<void> sound = check_joint(spec.joint, spec.name); !sound) return sound.error();
  if (Result<void> sound = check_load(spec); !sound) return sound.error();
  const Result<double> factor = mass_factor(spec);
  if (!factor) return factor.error();

  Body body;
  body.name = spec.name;
  body.material = spec.material;
  body.part = spec.part;
  body.mass_kg = *factor * spec.part->mass.mass;
  body.inertia_B = *factor * spec.part->mass.inertia;
  if (body.moves() && !(body.mass_kg > 0.0 && body.inertia_B.allFinite() && body.inertia_B.trace() > 0.0))
    return Error{"the body has no mass or inertia", fmt::format("{} kg", body.mass_kg), "more", spec.name};
  body.X_WB = {spec.X_WP.R, spec.X_WP * spec.part->origin};
  body.V_WB = spec.V_WB;
  body.joint = spec.joint;
  const double length = body.joint.axis_W.norm();
  if (std::abs(length - 1.0) > tolerances::kRotationExact) body.joint.axis_W /= length;
  body.load = spec.load;
  body.field_points = spec.field_points;
  bodies.push_back(std::move(body));
  return static_cast<int>(bodies.size()) - 1;
}

}  // namespace tactum::inline v0_1
