/// The axes of engines. A map M from W to the engine's axes permutes axes and turns one around; lengths are
/// scaled beside it. Since M mirrors, a rotation R becomes M R M^T, and a vector about which something turns
/// becomes det(M) M v.

#include "tactum/embedding/c_values.h"

using namespace tactum;  // the C interface stands outside the namespace
using namespace tactum::c_calls;

namespace {

struct EngineAxes {
  Mat3 M = Mat3::Identity();  // orthogonal
  double lengths = 1.0;       // units of the engine a metre
  double sign = 1.0;          // det(M)
};

EngineAxes axes_of(tactum_axes axes) {
  EngineAxes out;
  if (axes == TACTUM_AXES_UNITY) {
    out.M << 1, 0, 0, 0, 0, 1, 0, 1, 0;
    out.sign = -1.0;
  } else if (axes == TACTUM_AXES_UNREAL) {
    out.M << 1, 0, 0, 0, -1, 0, 0, 0, 1;
    out.sign = -1.0;
    out.lengths = 100.0;
  }
  return out;
}

void put_where_wanted(const Vec3& v, double* out) {
  if (out != nullptr) put(v, out);
}

}  // namespace

void tactum_point_to_engine(tactum_axes axes, const double p_W[3], double point[3]) {
  const EngineAxes engine = axes_of(axes);
  put_where_wanted(engine.lengths * (engine.M * vector_of(p_W)), point);
}

void tactum_point_from_engine(tactum_axes axes, const double point[3], double p_W[3]) {
  const EngineAxes engine = axes_of(axes);
  put_where_wanted(engine.M.transpose() * vector_of(point) / engine.lengths, p_W);
}

void tactum_direction_to_engine(tactum_axes axes, const double n_W[3], double direction[3]) {
  put_where_wanted(axes_of(axes).M * vector_of(n_W), direction);
}

void tactum_direction_from_engine(tactum_axes axes, const double direction[3], double n_W[3]) {
  put_where_wanted(axes_of(axes).M.transpose() * vector_of(direction), n_W);
}

void tactum_pose_to_engine(tactum_axes axes, const tactum_pose* X, double position[3],
                           double quaternion_xyzw[4]) {
  const EngineAxes engine = axes_of(axes);
  tactum_point_to_engine(axes, X->p, position);
  if (quaternion_xyzw == nullptr) return;
  const Quat q(Mat3(engine.M * pose_of(*X).R * engine.M.transpose()));
  put(q.vec(), quaternion_xyzw);
  quaternion_xyzw[3] = q.w();
}

void tactum_pose_from_engine(tactum_axes axes, const double position[3], const double quaternion_xyzw[4],
                             tactum_pose* X) {
  const EngineAxes engine = axes_of(axes);
  const Quat q(quaternion_xyzw[3], quaternion_xyzw[0], quaternion_xyzw[1], quaternion_xyzw[2]);
  const Mat3 R = engine.M.transpose() * q.normalized().toRotationMatrix() * engine.M;
  tactum_point_from_engine(axes, position, X->p);
  put_rows(R, X->R);
}

void tactum_wrench_to_engine(tactum_axes axes, const tactum_wrench* F, double force[3], double torque[3]) {
  const EngineAxes engine = axes_of(axes);
  put_where_wanted(engine.lengths * (engine.M * vector_of(F->f)), force);
  put_where_wanted(engine.lengths * engine.lengths * engine.sign * (engine.M * vector_of(F->t)), torque);
}

void tactum_wrench_from_engine(tactum_axes axes, const double force[3], const double torque[3],
                               tactum_wrench* F) {
  const EngineAxes engine = axes_of(axes);
  put(engine.M.transpose() * vector_of(force) / engine.lengths, F->f);
  put(engine.sign / (engine.lengths * engine.lengths) * (engine.M.transpose() * vector_of(torque)), F->t);
}
