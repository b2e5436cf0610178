#pragma once
/// Two scenes with the same bits in everything a frame is made of.

#include <gtest/gtest.h>

#include "tactum/haptics/setting_table.h"
#include "tactum/scene/scene.h"

namespace tactum::testing {

inline void expect_equal_body(const Body& x, const Body& y) {
  SCOPED_TRACE(x.name);
  EXPECT_EQ(x.name, y.name);
  EXPECT_EQ(x.material, y.material);
  EXPECT_EQ(x.mass_kg, y.mass_kg);
  EXPECT_EQ(x.inertia_B, y.inertia_B);
  EXPECT_EQ(x.X_WB.p, y.X_WB.p);
  EXPECT_EQ(x.X_WB.R, y.X_WB.R);
  EXPECT_EQ(x.joint.kind, y.joint.kind);
  EXPECT_EQ(x.joint.axis_W, y.joint.axis_W);
  EXPECT_EQ(x.joint.anchor_W, y.joint.anchor_W);
  EXPECT_EQ(x.joint.lower, y.joint.lower);
  EXPECT_EQ(x.joint.upper, y.joint.upper);
  EXPECT_EQ(x.load.constant.f, y.load.constant.f);
  EXPECT_EQ(x.load.constant.t, y.load.constant.t);
  EXPECT_EQ(x.load.damping_Ns_per_m, y.load.damping_Ns_per_m);
  EXPECT_EQ(x.load.damping_Nms_per_rad, y.load.damping_Nms_per_rad);
  EXPECT_EQ(x.field_points.size(), y.field_points.size());
  EXPECT_EQ(x.part->surface.vertices, y.part->surface.vertices);
  ASSERT_EQ(x.part->pieces.size(), y.part->pieces.size());
  for (std::size_t p = 0; p < x.part->pieces.size(); ++p)
    EXPECT_EQ(x.part->pieces[p].vertices, y.part->pieces[p].vertices);
}

inline void expect_equal(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.world.bodies.size(), b.world.bodies.size());
  for (std::size_t i = 0; i < a.world.bodies.size(); ++i)
    expect_equal_body(a.world.bodies[i], b.world.bodies[i]);
  EXPECT_EQ(a.world.gravity_W, b.world.gravity_W);
  EXPECT_EQ(a.world.fields.size(), b.world.fields.size());
  for (const SettingInfo& info : setting_table())
    EXPECT_EQ(info.get(a.settings, a.safety), info.get(b.settings, b.safety)) << info.key;
  EXPECT_EQ(a.coupling_by_device, b.coupling_by_device);
  EXPECT_EQ(a.settings.friction.coefficients, b.settings.friction.coefficients);
  EXPECT_EQ(a.settings.impacts.restitution.coefficients, b.settings.impacts.restitution.coefficients);
  EXPECT_EQ(a.settings.tool.body, b.settings.tool.body);
  EXPECT_EQ(a.settings.tool.X_BH.p, b.settings.tool.X_BH.p);
  EXPECT_EQ(a.settings.tool.centre_fraction, b.settings.tool.centre_fraction);
  EXPECT_EQ(a.settings.workspace.X_WD.p, b.settings.workspace.X_WD.p);
  for (double t = 0.0; t < a.hand->duration_s(); t += 0.37) {
    EXPECT_EQ(a.hand->at(t).X_DH.p, b.hand->at(t).X_DH.p);
    EXPECT_EQ(a.hand->at(t).X_DH.R, b.hand->at(t).X_DH.R);
  }
  EXPECT_EQ(a.hand->duration_s(), b.hand->duration_s());
  EXPECT_EQ(a.goals.size(), b.goals.size());
}

}  // namespace tactum::testing
