#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include "tactum/base/tolerances.h"
#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {
namespace {

constexpr int kMostFieldPoints = 10'000;  // of a body

/// Limits that keep the joint as it is at the start; `unit` as in ItemVisitor::interval.
void visit_limits(ItemVisitor& visitor, const char* key, std::optional<Interval>& limits, double unit) {
  visitor.optional(key, limits, [&](Interval& ends) {
    visitor.interval(key, ends, unit);
    if (!(ends.lower <= 0.0 && ends.upper >= 0.0 && ends.lower < ends.upper))
      visitor.fail(key, "the limits do not hold the joint as it stands, at 0",
                   fmt::format("{:.9g} to {:.9g}", ends.lower / unit, ends.upper / unit),
                   "a negative and a positive one, or 0");
  });
}

void visit_parent(ItemVisitor& visitor, JointParent& to) {
  visitor.text("parent", to.parent);
  visitor.flag("contact", to.contact);
  if (to.contact && to.parent.empty())
    visitor.fail("contact", "contact with a parent in a joint that has none", "contact = true",
                 "the name of a body as parent");
}

}  // namespace

void visit_items(ItemVisitor&, FreeJoint&) {}
void visit_items(ItemVisitor& visitor, FixedJoint& joint) { visit_parent(visitor, joint.to); }

void visit_items(ItemVisitor& visitor, HingeJoint& joint) {
  visitor.direction("axis", joint.axis, Need::kRequired);
  visitor.vector("anchor_m", joint.anchor_m);
  visitor.number("damping_Nms", joint.damping_Nms, kNotNegative);
  visitor.number("friction_Nm", joint.friction_Nm, kNotNegative);
  visitor.number("stiffness_Nm_per_rad", joint.stiffness_Nm_per_rad, kNotNegative);
  visitor.angle("rest_deg", joint.rest_rad);
  visit_limits(visitor, "limits_deg", joint.limits_rad, radians(1.0));
  visit_parent(visitor, joint.to);
}

void visit_items(ItemVisitor& visitor, SliderJoint& joint) {
  visitor.direction("axis", joint.axis, Need::kRequired);
  visitor.number("damping_Ns_per_m", joint.damping_Ns_per_m, kNotNegative);
  visitor.number("friction_N", joint.friction_N, kNotNegative);
  visitor.number("stiffness_N_per_m", joint.stiffness_N_per_m, kNotNegative);
  visitor.number("rest_m", joint.rest_m);
  visit_limits(visitor, "limits_m", joint.limits_m, 1.0);
  visit_parent(visitor, joint.to);
}

void visit_items(ItemVisitor& visitor, BallJoint& joint) {
  visitor.vector("anchor_m", joint.anchor_m);
  visitor.number("damping_Nms", joint.damping_Nms, kNotNegative);
  visitor.angle("swing_deg", joint.swing_rad, {0.0, 180.0});
  visit_parent(visitor, joint.to);
}

void visit_items(ItemVisitor& visitor, JointDescription& joint) {
  visitor.kinds("kind", "joint", joint, Need::kRequired);
}

void visit_items(ItemVisitor& visitor, ComponentDescription& component) {
  visitor.text("name", component.name);
  visitor.text("on", component.on);
  visitor.pose(component.X_OC);
  visitor.optional("part", component.part, [&](PartDescription& part) { visitor.table("part", part); });
  if (!component.part) visitor.missing("part", "a table such as { box = {...} }");
}

void visit_items(ItemVisitor& visitor, SamplePoint& point) {
  visitor.vector("pos_m", point.pos_m, Need::kRequired);
  visitor.number("weight", point.weight);
}

void visit_items(ItemVisitor& visitor, InertialDescription& inertial) {
  visitor.number("mass_kg", inertial.mass_kg, kPositive, Need::kRequired);
  visitor.vector("center_m", inertial.center_m);
  visitor.vector("inertia_kg_m2", inertial.inertia_kg_m2, Need::kRequired);
  visitor.vector("products_kg_m2", inertial.products_kg_m2);
  if (!inertial.tensor().allFinite()) return;  // an error of its own
  // Of a plate the largest moment is the sum of the others, to rounding.
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(inertial.tensor()).eigenvalues();
  if (!(moments[0] > 0.0 && moments[2] <= (moments[0] + moments[1]) * (1.0 + tolerances::kCentered)))
    visitor.fail("inertia_kg_m2", "no body has this inertia",
                 fmt::format("principal moments of {:.6g}, {:.6g} and {:.6g} kg m^2", moments[0], moments[1],
                             moments[2]),
                 "moments above 0, none larger than the sum of the others");
}

void visit_items(ItemVisitor& visitor, BodyDescription& body) {
  visitor.text("name", body.name, Need::kRequired);
  if (body.name.empty())
    visitor.fail("name", "a body without a name in " + visitor.section(), "\"\"", "a text");
  visitor.text("on", body.on);
  visitor.pose(body.X_OP);
  visitor.vector("velocity_m_per_s", body.V_WB.v);
  visitor.vector("angular_velocity_rad_per_s", body.V_WB.w);
  if (visitor.present("joint", true)) visitor.table("joint", body.joint);
  visitor.vector("force_N", body.load.constant.f);
  visitor.vector("torque_Nm", body.load.constant.t);
  visitor.number("damping_Ns_per_m", body.load.damping_Ns_per_m, kNotNegative);
  visitor.number("angular_damping_Nms_per_rad", body.load.damping_Nms_per_rad, kNotNegative);
  visitor.text("material", body.material);

  visitor.optional("part", body.part, [&](PartDescription& part) { visitor.table("part", part); });
  visitor.tables("component", body.components);
  if (body.part && !body.components.empty())
    visitor.fail("part", "two ways to make " + visitor.section(), "part and component", "one of them");
  if (!body.part && body.components.empty()) visitor.missing("part", "a table such as { box = {...} }");
  visitor.number("mass_kg", body.mass.mass_kg, kPositive);
  visitor.number("density_kg_per_m3", body.density_kg_per_m3, kPositive);
  if (body.mass.mass_kg && body.density_kg_per_m3)
    visitor.fail("mass_kg", "two masses in " + visitor.section(), "mass_kg and density_kg_per_m3",
                 "one of them");
  visitor.optional("inertial", body.mass.inertial,
                   [&](InertialDescription& inertial) { visitor.table("inertial", inertial); });
  if (body.mass.inertial && (body.mass.mass_kg || body.density_kg_per_m3))
    visitor.fail("inertial", "two masses in " + visitor.section(), "inertial beside a mass or density",
                 "one of them");

  visitor.tables("field_point", body.field_points.listed);
  visitor.optional("field_points", body.field_points.count,
                   [&](int& count) { visitor.integer("field_points", count, 1, kMostFieldPoints); });
  if (body.field_points.count && !body.field_points.listed.empty())
    visitor.fail("field_points", "two sets of sample points in " + visitor.section(),
                 "field_points and field_point", "one of them");
}

}  // namespace tactum::inline v0_1
