#ifdef TACTUM_TEST_MUJOCO
#include "import/mujoco_reading.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <memory>

namespace tactum::import_test {
namespace {

Vec3 vec(const mjtNum* v) { return {v[0], v[1], v[2]}; }
Mat3 mat(const mjtNum* m) {
  Mat3 R;
  R << m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8];
  return R;
}

/// Stands every limited joint within its limits.
void stand_within_limits(const mjModel& m, mjData& d) {
  for (int j = 0; j < m.njnt; ++j) {
    const bool single = m.jnt_type[j] == mjJNT_HINGE || m.jnt_type[j] == mjJNT_SLIDE;
    mjtNum& q = d.qpos[m.jnt_qposadr[j]];
    if (single && m.jnt_limited[j] != 0) q = std::clamp(q, m.jnt_range[2 * j], m.jnt_range[2 * j + 1]);
  }
}

Joint joint_of(const mjModel& m, const mjData& d, int j) {
  Joint joint;
  const int type = m.jnt_type[j];
  if (type == mjJNT_FREE) return joint;
  joint.kind = type == mjJNT_HINGE   ? JointKind::kHinge
               : type == mjJNT_SLIDE ? JointKind::kSlider
                                     : JointKind::kBall;
  joint.anchor_W = vec(d.xanchor + 3 * j);
  joint.damping = m.dof_damping[m.jnt_dofadr[j]];
  if (joint.kind == JointKind::kBall) {
    if (m.jnt_limited[j] != 0) joint.upper = m.jnt_range[2 * j + 1];
    return joint;
  }
  joint.axis_W = vec(d.xaxis + 3 * j);
  joint.friction = m.dof_frictionloss[m.jnt_dofadr[j]];
  joint.stiffness = m.jnt_stiffness[j];
  const int q = m.jnt_qposadr[j];
  joint.rest = m.qpos_spring[q] - d.qpos[q];
  if (m.jnt_limited[j] != 0) {
    joint.lower = m.jnt_range[2 * j] - d.qpos[q];
    joint.upper = m.jnt_range[2 * j + 1] - d.qpos[q];
  }
  return joint;
}

/// The bodies that are welded to `root`, together.
ReadBody body_of(const mjModel& m, const mjData& d, int root) {
  ReadBody read;
  if (const char* name = mj_id2name(&m, mjOBJ_BODY, root)) read.name = name;
  for (int b = 0; b < m.nbody; ++b) {
    if (m.body_weldid[b] != root) continue;
    read.alone = read.alone && b == root;
    read.mass_kg += m.body_mass[b];
    read.center_W += m.body_mass[b] * vec(d.xipos + 3 * b);
  }
  read.center_W /= read.mass_kg;
  for (int b = 0; b < m.nbody; ++b) {
    if (m.body_weldid[b] != root) continue;
    const Mat3 R = mat(d.ximat + 9 * b);
    const Vec3 r = vec(d.xipos + 3 * b) - read.center_W;
    read.inertia_W += R * vec(m.body_inertia + 3 * b).asDiagonal() * R.transpose() +
                      m.body_mass[b] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  read.joint = joint_of(m, d, m.body_jntadr[root]);
  return read;
}

}  // namespace

Reading read_by_mujoco(const std::string& path) {
  Reading reading;
  std::array<char, 1000> error{};
  const std::unique_ptr<mjModel, void (*)(mjModel*)> m(
      mj_loadXML(path.c_str(), nullptr, error.data(), static_cast<int>(error.size())), mj_deleteModel);
  if (!m) {
    reading.error = error.data();
    return reading;
  }
  const std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(m.get()), mj_deleteData);
  stand_within_limits(*m, *d);
  mj_forward(m.get(), d.get());
  reading.gravity_W = vec(m->opt.gravity);
  for (int b = 1; b < m->nbody; ++b)
    if (m->body_weldid[b] == b) reading.bodies.push_back(body_of(*m, *d, b));
  for (int g = 0; g < m->ngeom; ++g)
    if (m->geom_contype[g] != 0 || m->geom_conaffinity[g] != 0)
      reading.geoms.push_back(
          {m->geom_type[g] == mjGEOM_MESH, {mat(d->geom_xmat + 9 * g), vec(d->geom_xpos + 3 * g)}});
  return reading;
}

}  // namespace tactum::import_test
#endif
