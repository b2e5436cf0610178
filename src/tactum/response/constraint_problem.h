#pragma once
/// The contact problem of the `constraint` response: which displacements of the bodies over one frame are
/// nearest to the wanted ones while no contact closes beyond its skin.
///
///     least  sum over bodies |x - x*|^2_M / 2     with   n . (x_a(p) - x_b(p)) >= skin - distance
///
/// x is a body's displacement over the frame at its origin, axes of W: (translation [m], turn [rad]). Its
/// metric M is what resists it: for the held part the coupling itself, spring and damper over one frame,
/// told at the handle; for a free body its inertia over the square of the frame's time. So the
/// multipliers are the contact forces in newtons, and M (x - x*) is their sum: what the hand feels, and
/// nothing else.
///
/// With x = x* + B z and M^-1 = B B^T it is the nearest point to the origin in a polyhedron (small_qp.h): six
/// unknowns for a free body, one for a hinged or sliding one, three for one on a ball. A joint with dry
/// friction has one more unknown t, that may not be less than the displacement a of its position, in either
/// sense, and that the friction pulls down:
///
///     t >= a,  t >= -a,   energy  T t + e t^2 / 2      so |T_a| <= T + e t, with e t a thousandth of T
///
/// A joint's spring and damper are part of its body's metric, its limits are rows.

#include <vector>

#include "tactum/base/reserved_vector.h"
#include "tactum/dynamics/joint.h"
#include "tactum/math/small_qp.h"
#include "tactum/response/settings.h"

namespace tactum {

/// The coupling as the proxy feels it over one frame: F = M (x - x*) at the handle, diagonal.
struct GraspMetric {
  double stiffness_N_per_m = 0.0;     ///< k_t + b_t / dt [N/m]
  double stiffness_Nm_per_rad = 0.0;  ///< k_r + b_r / dt [N m/rad]
};

GraspMetric grasp_metric(const Coupling& coupling, double dt_s) noexcept;

/// The displacement of the handle, (m, rad), at which the coupling's spring and damper are in balance.
Vec6 balanced_step(const Coupling& coupling, double dt_s, const Pose& X_WH_proxy, const Pose& X_WH,
                   const Twist& V_WH) noexcept;

/// How many unknowns a body needs, with the one for its joint's friction.
std::size_t unknowns_of(const Joint& joint) noexcept;

/// A body whose displacement is unknown. Its six unknowns are the translation of `centre`, each times
/// `per_translation`, and the turn, the columns of `turns`; or the fewer ones of a jointed body are the
/// columns of `motions`.
struct ProblemBody {
  int body = -1;
  std::size_t first = 0, rank = 0;  ///< its unknowns
  Vec3 origin = Vec3::Zero();       ///< of the body, in W [m]
  Vec3 centre = Vec3::Zero();       ///< in W: the handle of the held body, the origin of others [m]
  Vec6 wanted = Vec6::Zero();       ///< x* at the centre [m, rad]
  double per_translation = 0.0;
  Mat3 turns = Mat3::Zero();
  JointMotions motions;
};

/// What a row pushes with, per unit of its multiplier: a force at a point, and a torque beside it.
struct Push {
  Vec3 p_W = Vec3::Zero();     ///< [m]
  Vec3 force = Vec3::Zero();   ///< [-]
  Vec3 torque = Vec3::Zero();  ///< [m]
};

class ConstraintProblem {
 public:
  static constexpr std::size_t kMostCones = 16;
  /// Room for `most_rows` rows beside those of joint friction and cones.
  explicit ConstraintProblem(std::size_t most_rows);

  /// Forgets everything; then the bodies are added, then the rows.
  void clear() noexcept;
  /// The held part. `wanted` is told at the handle p_WH. False, and the body stays where it is, when there is
  /// no room for its unknowns.
  bool add_grasped(int body, const Body& what, const Pose& X_WB, const Vec3& p_WH, const GraspMetric& metric,
                   const Vec6& wanted) noexcept;
  /// A body that resists with its inertia; `wanted` is where it goes when nothing touches it.
  bool add_free(int body, const Body& what, const Pose& X_WB, const Vec6& wanted, double dt_s) noexcept;
  /// The same bodies, each wanting to go where the other problem's answer has it, and the rows of their
  /// joints' limits; friction has had its say.
  void follow(const ConstraintProblem& led) noexcept;
  /// The rows of the joints' friction and limits: after the bodies, before other rows.
  void add_joint_rows() noexcept;

  /// The row  push . (x_a - x_b) >= 0. A body that was not added does not move.
  QpRow row_of(int body_a, int body_b, const Push& push) const noexcept;
  /// The left side of that row in the last answer [m].
  double opening(const QpRow& row) const noexcept { return -qp_.missing(row); }
  /// Adds a row that asks for `offset` more. False when full.
  bool add_row(const QpRow& row, double offset) noexcept;
  /// Adds the edges of a cone as rows, after all others; returns the number of the first. At most kMostCones.
  std::size_t add_cone(const QpCone& cone) noexcept;
  void forget_cones() noexcept { cones_.clear(); }
  /// Those of cones not counted.
  std::size_t rows() const noexcept { return rows_.size(); }
  /// Makes a row ask for `by` more; of a cone's edges, see cone().
  void tighten(std::size_t row, double by) noexcept { rows_[row].offset += by; }
  /// The cone whose first edge has this number.
  QpCone& cone(std::size_t first_edge) noexcept {
    return *(cones_.begin() + (first_edge - rows_.size()) / QpCone::kEdges);
  }

  /// Chooses the rows to begin the next solution with.
  void begin(std::span<const int> first) noexcept;
  /// Solves from there, or from those that hold now, after rows were tightened, or added or forgotten at the
  /// end. The answer keeps until the next call.
  const QpAnswer& solve_on(int max_iterations) noexcept;

  const QpAnswer& answer() const noexcept { return qp_.answer(); }
  std::span<const ProblemBody> bodies() const noexcept { return {bodies_, body_count_}; }
  /// Displacement of a body's origin in the last answer; zero when it was not added [m, rad].
  Vec6 displacement(int body) const noexcept;
  /// How far a body wants to turn; not at all when it was not added [rad].
  Vec3 wanted_turn(int body) const noexcept;
  /// The displacement at the body's centre.
  Vec6 displacement_at_centre(const ProblemBody& problem_body) const noexcept;

 private:
  QpProblem nearest_point() const noexcept;

  struct JointFriction {
    const ProblemBody* problem_body;
    double friction;     // [N m or N]
    double per_unknown;  // the joint's travel for its body's unknown [rad or m]
    std::size_t unknown;
  };
  struct Limit {
    int body = -1;
    Push push;                 // along the joint's position
    double travel_left = 0.0;  // [rad or m], not negative
  };
  static constexpr std::size_t kMostBodies = kMostUnknowns;

  const ProblemBody* find_body(int body) const noexcept;
  ProblemBody* next_body(int body, std::size_t rank, const Vec3& origin, const Vec3& centre) noexcept;
  void set_motions(ProblemBody& problem_body, const Body& what, const Pose& X_WB, const Mat6& metric,
                   const Vec6& wanted, double spring, double damping) noexcept;
  void add_joint(const ProblemBody& problem_body, const Body& what, const Pose& X_WB) noexcept;

  ProblemBody bodies_[kMostBodies];
  std::size_t body_count_ = 0;
  std::size_t unknowns_ = 0;
  StaticVector<JointFriction, kMostBodies> joint_frictions_;
  StaticVector<Limit, 2 * kMostBodies> limits_;
  ReservedVector<QpRow> rows_;
  StaticVector<QpCone, kMostCones> cones_;
  std::size_t most_rows_;
  SmallQp qp_;
};

}  // namespace tactum
