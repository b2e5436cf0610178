#pragma once
/// Plain values of the C interface and those of the library, to the bit.

#include "tactum/embedding/tactum_c.h"
#include "tactum/geometry/triangle_mesh.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1::c_calls {

inline void put(const Vec3& v, double* out) noexcept {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}
inline Vec3 vector_of(const double* v) noexcept { return {v[0], v[1], v[2]}; }

inline void put_rows(const Mat3& M, double* out) noexcept {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[3 * i + j] = M(i, j);
}

inline tactum_pose c_pose(const Pose& X) noexcept {
  tactum_pose out{};
  put_rows(X.R, out.R);
  put(X.p, out.p);
  return out;
}
inline Pose pose_of(const tactum_pose& X) noexcept {
  Pose out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.R(i, j) = X.R[3 * i + j];
  out.p = vector_of(X.p);
  return out;
}

inline tactum_wrench c_wrench(const Wrench& F) noexcept {
  tactum_wrench out{};
  put(F.f, out.f);
  put(F.t, out.t);
  return out;
}
inline Wrench wrench_of(const tactum_wrench& F) noexcept { return {vector_of(F.f), vector_of(F.t)}; }

inline tactum_twist c_twist(const Twist& V) noexcept {
  tactum_twist out{};
  put(V.v, out.v);
  put(V.w, out.w);
  return out;
}
inline Twist twist_of(const tactum_twist& V) noexcept { return {vector_of(V.v), vector_of(V.w)}; }

/// A view of the mesh, which must outlive it.
inline tactum_mesh_view c_mesh(const TriangleMesh& mesh) noexcept {
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::int32_t));
  tactum_mesh_view view{};
  view.vertex_count = mesh.vertices.size();
  view.triangle_count = mesh.triangles.size();
  view.vertices = mesh.vertices.empty() ? nullptr : mesh.vertices.front().data();
  view.triangles = mesh.triangles.empty() ? nullptr : mesh.triangles.front().data();
  return view;
}

}  // namespace tactum::inline v0_1::c_calls
