#pragma once
/// The contact problem of one island of bodies over one step of h seconds: it finds the displacements that
/// are nearest to the targets among those that satisfy every row.
///
///     least  sum over bodies |x - x*|^2_M / 2     with   n . (x_a(p) - x_b(p)) >= offset
///
/// x is a body's displacement over the step at its origin, axes of W: (displacement [m], turn [rad]); x* is
/// its target, the displacement without contact. M is its metric: for a body that moves by itself its inertia
/// over h^2; for one that a coupling pulls, the stiffness of that coupling. So the multipliers are the
/// contact forces in newtons, and M (x - x*) is their sum. With h = 1 s the same rows are the problem of an
/// impact: displacements are velocities then, and forces are impulses.
///
/// With x = x* + B z and M^-1 = B B^T it is the nearest point to the origin in a polyhedron (small_qp.h): six
/// unknowns for a free body, one for a hinged or sliding one, three for one on a ball. A joint's spring and
/// damper are part of its body's metric, its limits are rows, its dry friction is a force of bounded size.
///
/// A body that is jointed to another one has its six unknowns, and the joint is rows of both that hold with
/// equality. Spring and damper act on an unknown of their own, the joint's travel, that one more such row
/// keeps at the travel of the two bodies: the unknowns of a joint stand beside the six, so a row reaches
/// both in one run.
///
/// Four solvers work on it: solve_exactly.h (active set, few bodies), solve_by_sweeps.h, solve_by_newton.h
/// (any number), solve_penalty.h (rows that yield). solver_choice.h selects one.

#include <limits>
#include <vector>

#include "tactum/base/reserved_vector.h"
#include "tactum/dynamics/contact_row.h"
#include "tactum/dynamics/joint_forces.h"
#include "tactum/dynamics/pair_joint.h"
#include "tactum/math/small_qp.h"

namespace tactum::inline v0_1 {

/// The bound of a force or a displacement that has none.
inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// How a body resists a displacement from its target, stated at a point of it.
struct BodyMetric {
  double linear = 0.0;          ///< [N/m]
  Mat3 angular = Mat3::Zero();  ///< symmetric positive, axes of W [N m/rad]
  bool has_momentum = false;    ///< it is an inertia over h^2
};

/// Mass and inertia over h^2, at the origin.
BodyMetric inertial_metric(const Body& body, const Pose& X_WB, double h) noexcept;

/// A body of the problem. Its six unknowns z [sqrt(N m)] give the displacement of `centre` from the target,
/// per_displacement * z_0..2, and the turn from it, turns * z_3..5; those of a jointed body, which has fewer,
/// give both by the columns of `motions`.
struct ProblemBody {
  // Not filled: next_body() and add_body() write what is read.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init,modernize-use-equals-default)
  ProblemBody() noexcept {}

  int body = -1;                        ///< index into World::bodies
  std::size_t first = 0, rank = 0;      ///< its unknowns
  Vec3 origin;                          ///< of the body, in W [m]
  Vec3 centre;                          ///< where its metric is stated, in W [m]
  Vec6 target;                          ///< x* at the centre [m, rad]
  double per_displacement = 0.0;        ///< 1 / sqrt(linear metric) [sqrt(m/N)]
  Mat3 turns;                           ///< U^-1 of the angular metric U^T U, axes of W; of a free body
  Eigen::Matrix<double, 6, 3> motions;  ///< the first `rank` columns, of a jointed body
};

/// That of a contact row.
inline Push push_of(const ContactRow& row) { return {row.p_W, row.n_BA_W, Vec3::Zero()}; }

/// How many unknowns a joint leaves.
std::size_t freedom_of(const Joint& joint) noexcept;
/// The same, and one more for the joint's dry friction, as the exact solver needs it; with those of the pair
/// joint that the body has.
std::size_t exact_unknowns_of(const World& world, const Body& body) noexcept;

/// The displacement along a row, as the row measures it, for a unit force along it: |g|^2 [m/N].
inline double mobility(const QpRow& row) noexcept {
  double sum = 0.0;
  for (const QpRow::Run& run : row.runs)
    for (std::size_t i = 0; i < run.count; ++i) sum += run.g[i] * run.g[i];
  return sum;
}

/// Adds to the unknowns their change by a force along a row.
inline void push(const QpRow& row, double force, double* z) noexcept {
  for (const QpRow::Run& run : row.runs)
    for (std::size_t i = 0; i < run.count; ++i) z[run.first + i] += run.g[i] * force;
}

/// A body of the world as a step begins.
struct PlacedBody {
  int number = -1;  ///< index into World::bodies
  const Body& body;
  const Pose& X_WB;
  JointPosition joint = {};
};

inline PlacedBody placed(const World& world, const WorldState& state, int number) noexcept {
  const auto i = static_cast<std::size_t>(number);
  return {number, world.bodies[i], state.X_WB[i], state.joints[i]};
}

class ContactProblem {
 public:
  static constexpr std::size_t kMostCones = 32;
  /// Rows of the joints of each body: six locks, three of a damper, two limits, two of dry friction.
  static constexpr std::size_t kJointRows = 13;
  /// Unknowns of a body with its joint, at most, and the numbers behind the last unknown that runs of rows
  /// read: these are read in whole lanes.
  static constexpr std::size_t kMostOfBody = 9, kRoomBehind = 8;
  /// Room for `most_rows` rows beside those of joints and for `most_bodies` of the world's bodies.
  ContactProblem(std::size_t most_rows, std::size_t world_bodies, std::size_t most_bodies);
  /// Room for all of the world's bodies.
  ContactProblem(std::size_t most_rows, std::size_t world_bodies)
      : ContactProblem(most_rows, world_bodies, world_bodies) {}

  /// Removes everything; then the bodies are added, then the rows of their joints, then other rows.
  void clear() noexcept;
  /// `centre_W` is where the metric and the target are stated. The joint acts for `h` seconds; with 0, as in
  /// an impact, it leaves its free motions alone. A fixed body needs no entry: a body that was not added does
  /// not move.
  void add_body(const PlacedBody& placed, const Vec3& centre_W, const BodyMetric& metric, const Vec6& target,
                double h) noexcept;
  /// The same for a body that may have a pair joint, with the unknowns of that.
  void add_body_and_joint(const World& world, const PlacedBody& placed, const Vec3& centre_W,
                          const BodyMetric& metric, const Vec6& target, double h) noexcept;
  /// Adds a body whose displacement is given: nothing in this problem changes it.
  void add_given(int body, const Vec3& origin_W, const Vec6& displacement) noexcept;
  /// Takes the same bodies, each with the other problem's answer as its target, and the rows of their joints'
  /// limits. Joint friction is not added: that answer contains it. This problem should have been made with
  /// room for as many bodies as the other one: with less, the limits allocate.
  void follow(const ContactProblem& led) noexcept;
  /// Adds the rows of the pair joints between bodies that were added, which come before all others. The
  /// joints act for `h` seconds.
  void add_pair_joints(const World& world, const WorldState& state, double h) noexcept;
  /// Corrects the locks of pair joints by the errors that the last answer has left in the poses X_WB; returns
  /// the largest of them, lengths as fractions of the body's size [- or rad].
  double correct_pair_joints(const World& world, std::span<const Pose> X_WB) noexcept;
  /// The first so many rows hold with equality.
  std::size_t equalities() const noexcept { return equalities_; }
  /// Adds the rows of joints. `exact`: dry friction becomes an unknown of its own with two rows, as long as
  /// there is room for it.
  void add_joint_rows(bool exact) noexcept;

  /// The row  push . (x_a - x_b) >= 0. A body that was not added does not move.
  QpRow row_of(int body_a, int body_b, const Push& push) const noexcept;
  /// The left side of that row in the last answer [m].
  double opening(const QpRow& row) const noexcept { return dot(row, z()) - row.offset; }
  /// Adds the row  push . (x_a - x_b) >= offset. False when full: the row is then missing, and the caller's
  /// numbers of later rows are off, so it reserves the room for all of its rows.
  bool add_row(int body_a, int body_b, const Push& push, double offset) noexcept;
  /// The number of rows; those of cones are not counted.
  std::size_t rows() const noexcept { return rows_.size(); }
  /// Increases what a row has to open by; for a cone's edges see set_cone().
  void tighten(std::size_t row, double by) noexcept { rows_[row].offset += by; }

  /// Adds the edges of a cone as rows of the exact solver, after all others; returns the number of the first.
  /// At most kMostCones.
  std::size_t add_cone(const QpCone& cone) noexcept;
  void forget_cones() noexcept { cones_.clear(); }
  /// Exchanges the cone whose first edge has this number for another one on the same rows.
  void set_cone(std::size_t first_edge, const QpCone& cone) noexcept;
  /// Loads the bodies with a force along the direction of a row, beside the forces of the rows [N].
  void add_load(const QpRow& along, double force_N) noexcept;

  // Of the exact solver.
  /// Chooses the rows to begin the next solution with.
  void begin(std::span<const int> first) noexcept;
  /// Solves from there, or from the active set of the last answer, after rows were tightened, or added or
  /// removed at the end. The answer stays valid until the next call.
  const QpAnswer& solve_on(int max_iterations) noexcept;
  const QpAnswer& answer() const noexcept { return qp_.answer(); }

  // Of the other solvers: they work on the rows and the unknowns themselves.
  struct JointFriction {
    double friction = 0.0;  ///< [N m or N]
    /// opening(travel) is the joint's travel in the step. That of a joint to the world has one run, of one
    /// unknown [rad or m].
    QpRow travel;
    /// Where the unknown of a pair joint's friction stands in the first run of `travel`; -1: it has none yet.
    int own = -1;
  };
  std::span<const QpRow> row_list() const noexcept { return rows_; }
  std::span<const JointFriction> joint_frictions() const noexcept {
    return {joint_frictions_.data(), joint_frictions_.size()};
  }
  std::size_t unknowns() const noexcept { return unknowns_; }
  /// Sets the unknowns to zero, for a solver to change; the answer is read from them from now on.
  void begin_values() noexcept;
  /// The unknowns, followed by zeros that runs of rows may read.
  double* values() noexcept { return z_.data(); }
  const double* values() const noexcept { return z_.data(); }

  std::span<const ProblemBody> bodies() const noexcept { return bodies_; }
  /// Displacement of a body's origin in the last answer; zero when it was not added [m, rad].
  Vec6 displacement(int body) const noexcept;
  /// Displacement of a point of a body that was added [m, rad].
  Vec6 displacement_at(int body, const Vec3& p_W) const noexcept;
  /// The turn of a body's target; zero when it was not added [rad].
  Vec3 target_turn(int body) const noexcept;
  /// The displacement at the body's centre.
  Vec6 displacement_at_centre(const ProblemBody& body) const noexcept;

 private:
  struct Limit {
    int body = -1, parent = -1;
    Push push;            // along the joint's coordinate
    double travel = 0.0;  // that is left, not negative [rad or m]
  };
  QpProblem nearest_point() const noexcept;
  const double* z() const noexcept { return z_.data(); }
  QpCone loaded(const QpCone& cone) const noexcept;
  const ProblemBody* find(int body) const noexcept {
    const int at = index_of_[static_cast<std::size_t>(body)];
    return at < 0 ? nullptr : &bodies_[static_cast<std::size_t>(at)];
  }
  ProblemBody& next_body(int body, std::size_t rank, const Vec3& origin, const Vec3& centre) noexcept;
  void project(int body_a, int body_b, const Push& push, QpRow& row) const noexcept;
  void set_motions(ProblemBody& body, const PlacedBody& placed, const BodyMetric& metric, const Vec6& target,
                   double h) noexcept;
  void add_friction_unknown(const JointFriction& friction) noexcept;
  void add_friction_rows(const JointFriction& friction) noexcept;
  QpRow travel_of(const PairJoint& pair, const Push& along, std::size_t own) const noexcept;
  double inertia_along(QpRow travel, std::size_t locks) const noexcept;
  void add_drag(const PairJoint& pair, const Push& along, std::size_t own, double drag,
                double travel) noexcept;
  void add_pair_joint(const World& world, const PairJoint& pair, const WorldState& state, double h) noexcept;

  ReservedVector<ProblemBody> bodies_;
  std::vector<int> index_of_;  // of a body of the world in bodies_; -1: none
  std::size_t unknowns_ = 0;
  ReservedVector<JointFriction> joint_frictions_;
  ReservedVector<Limit> limits_;
  struct Lock {
    const PairJoint* pair = nullptr;
    Push push;
    std::size_t row = 0;
  };
  ReservedVector<Lock> locks_;
  std::size_t equalities_ = 0;
  ReservedVector<QpRow> rows_;
  StaticVector<QpCone, kMostCones> cones_;
  // The change of the unknowns by loads: with z = z' + load the rows of qp_ are those of z'.
  std::array<double, columns::kColumn> load_{};
  bool is_loaded_ = false;
  ReservedVector<double> z_;  // the answer
  SmallQp qp_;
};

}  // namespace tactum::inline v0_1
