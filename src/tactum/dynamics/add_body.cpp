#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

/// A body that a joint makes fixed.
Result<void> check_rest(const Body& body) {
  if (!body.load.acts() && body.V_WB.v.isZero(0.0) && body.V_WB.w.isZero(0.0)) return {};
  return Error{"a fixed body has a velocity or a load", "one of them", "a parent that moves", body.name};
}

/// Whether a body is jointed to another one, or to one that is, and so on.
bool hangs_on(const World& world, int body, int other) {
  for (int at = body; at != other;) {
    const int pair = world.bodies[static_cast<std::size_t>(at)].pair_joint;
    if (pair < 0) return false;
    at = world.pair_joints[static_cast<std::size_t>(pair)].parent;
  }
  return true;
}

/// The number of joints between a body and the end of its chain.
int depth_of(const World& world, int body) {
  int depth = 0;
  for (int pair = world.bodies[static_cast<std::size_t>(body)].pair_joint; pair >= 0; ++depth)
    pair = world.bodies[static_cast<std::size_t>(world.pair_joints[static_cast<std::size_t>(pair)].parent)]
               .pair_joint;
  return depth;
}

/// A joint to a body that does not move is one to the world. The others: that of a parent before those on it,
/// else in the order of their bodies; each body knows its own.
void place_on_joints(World& world) {
  std::vector<PairJoint>& pairs = world.pair_joints;
  for (std::size_t i = 0; i < pairs.size();) {
    if (world.bodies[static_cast<std::size_t>(pairs[i].parent)].moves()) {
      ++i;
      continue;
    }
    world.bodies[static_cast<std::size_t>(pairs[i].body)].joint = pairs[i].joint;
    pairs.erase(pairs.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;  // what hangs on that body may stand before it
  }
  for (Body& body : world.bodies) body.pair_joint = -1;
  const auto number = [&] {
    for (std::size_t i = 0; i < pairs.size(); ++i)
      world.bodies[static_cast<std::size_t>(pairs[i].body)].pair_joint = static_cast<int>(i);
  };
  number();
  std::vector<int> depth;
  for (const Body& body : world.bodies)
    depth.push_back(depth_of(world, static_cast<int>(&body - world.bodies.data())));
  std::sort(pairs.begin(), pairs.end(), [&](const PairJoint& a, const PairJoint& b) {
    const auto key = [&](const PairJoint& pair) {
      return std::pair(depth[static_cast<std::size_t>(pair.body)], pair.body);
    };
    return key(a) < key(b);
  });
  number();
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

Result<void> World::join(int body, int parent, const Joint& joint, bool contact) {
  const int count = static_cast<int>(bodies.size());
  if (body < 0 || body >= count || parent < 0 || parent >= count)
    return Error{"a joint of bodies that are not there", fmt::format("{} and {}", body, parent),
                 fmt::format("0 to {}", count - 1), ""};
  Body& child = bodies[static_cast<std::size_t>(body)];
  const Body& above = bodies[static_cast<std::size_t>(parent)];
  if (child.joint.kind != JointKind::kFree || child.pair_joint >= 0)
    return Error{"the body has a joint already", "two joints", "one", child.name};
  if (joint.kind == JointKind::kFree)
    return Error{"the joint to another body joins nothing", "free", "fixed, hinge, slider or ball",
                 child.name};
  if (body == parent)
    return Error{"the body is joined to itself", fmt::format("\"{}\"", child.name), "another body",
                 child.name};
  if (hangs_on(*this, parent, body))
    return Error{"the joints form a circle", fmt::format("\"{}\" hangs on \"{}\"", above.name, child.name),
                 "a parent that does not hang on the body", child.name};
  if (Result<void> sound = check_joint(joint, child.name); !sound) return sound.error();
  if (!above.moves() && joint.kind == JointKind::kFixed) {
    if (Result<void> sound = check_rest(child); !sound) return sound.error();
  }
  Joint unit = joint;
  const double length = unit.axis_W.norm();
  if (std::abs(length - 1.0) > tolerances::kRotationExact) unit.axis_W /= length;
  if (!contact) child.no_contact_with = parent;
  if (!above.moves()) {
    child.joint = unit;
    place_on_joints(*this);
    return {};
  }
  pair_joints.push_back({body, parent, unit});
  place_on_joints(*this);
  return {};
}

}  // namespace tactum::inline v0_1
