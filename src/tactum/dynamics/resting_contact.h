#pragma once
/// Contact forces of any number of bodies that rest, slide and roll on each other: the least change of their
/// motion, in the metric of their inertia, after which no contact closes beyond its gap within the step,
///
///     vn + gap / h >= 0,   lambda_n >= 0,   |lambda_t| <= mu lambda_n against the sliding,
///
/// by projected Gauss-Seidel from the last frame's impulses [Stewart 1996], with momentum from sweep to sweep
/// [Nesterov 1983; Mazhar 2015]: plain sweeps carry a load through a stack of ten boxes too slowly. An
/// impulse acts on both bodies, so momentum is kept to rounding however few sweeps there were; what sweeps
/// are for is that no contact closes too far. A heap at rest begins at its answer and stays there.
///
/// Contacts that overlap get a velocity of separation. If a body is wedged, that makes the rows infeasible,
/// and each sweep would add as much to the impulses as the one before. An island whose sweeps have not
/// converged after a third of their number is therefore set back to the impulses it began with; from then on,
/// and for some time after, its contacts are only kept from closing further. Impulses that friction makes
/// grow from sweep to sweep are bounded in the last sweeps, in which friction may not exceed what it was.
///
/// Springs, damping, friction and limits of joints are rows of the same kind.

#include <cstdint>
#include <span>
#include <vector>

#include "tactum/base/frame_rate.h"
#include "tactum/base/reserved_vector.h"
#include "tactum/dynamics/friction_row.h"

namespace tactum {

class RestingContact {
 public:
  RestingContact(std::size_t most_rows, std::size_t bodies) {
    rows_.reserve(most_rows);
    last_.reserve(most_rows);
    now_.reserve(most_rows);
    joints_.reserve(bodies * kMostJointRows);
    order_.reserve(most_rows);
    joint_order_.reserve(bodies * kMostJointRows);
    islands_.resize(bodies);
    joint_left_shut_.resize(bodies, 0);
  }

  /// Forgets the rows, not the last frame's impulses.
  void begin() noexcept {
    rows_.clear();
    joints_.clear();
    now_.clear();
    next_ = 0;
    started_ = false;
  }
  /// A contact whose gap may close to nothing within h. `name` is the row's from frame to frame; `index` is
  /// the caller's, and rises.
  void add(const ContactRow& row, int index, int island, std::uint64_t name, double gap_m,
           std::span<const Pose> X_WB, std::span<const Mobility> W, double h) noexcept;
  /// A contact that does nothing but keep the last frame's impulse, which is returned, for the next.
  Vec3 keep(std::uint64_t name) noexcept;
  /// A body's joint, when it does anything to its motion.
  void add_joint(int body, int island, const Body& what, const Pose& X_WB, const Mobility& W,
                 double h) noexcept;
  /// Asks of the contact that was added as `index` to close by `by_m` less.
  void tighten(int index, double by_m, double h) noexcept;

  /// Changes the twists of the islands that are not settled, each by at most so many sweeps; may be called
  /// again after tighten(). They have converged when the last sweep changed no velocity by more than
  /// `harmless` [m/s], with friction as the last sweeps have it; sweeps go on to far less. The result's
  /// iterations are those of the island that took most.
  SolverResult solve(int max_sweeps, double harmless, std::span<const char> settled,
                     std::span<Twist> V) noexcept;
  /// The impulses that act on body_a of the contact added as `index`, world axes, the normal one's size.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Row& row : rows_) visit(row.index, row.contact.impulse[0], row.contact.impulse_W());
  }
  /// Keeps the impulses for the next frame.
  void end() noexcept;

 private:
  static constexpr std::size_t kMostJointRows = 4;  // of a body

  struct Row {
    int body_a = -1, body_b = -1, index = -1, island = -1;
    std::size_t last = 0;  // in now_
    double wanted = 0.0;   // least normal velocity [m/s]
    double opening = 0.0;  // how much of it is to open a gap
    FrictionRow contact;
    Vec3 before = Vec3::Zero(), swept = Vec3::Zero();  // impulses before the last sweep; after the one before
    Vec3 begun = Vec3::Zero();                         // before the first
  };
  struct Last {
    std::uint64_t name = 0;
    Vec3 impulse_W = Vec3::Zero();
    int left_shut = 0;  // in so many frames it is not asked to open
  };
  /// rate + softness impulse -> wanted, lower <= impulse <= upper.
  struct JointRow {
    int body, island;
    Vec6 along, response;
    double mobility, wanted, opening, softness, lower, upper;
    double impulse = 0.0, before = 0.0, swept = 0.0, begun = 0.0;
  };
  /// Where an island's rows stand in order_ and joint_order_.
  struct Range {
    int first = 0, count = 0, joint_first = 0, joint_count = 0;
  };
  /// How far an island's sweeps have come since they began anew.
  struct Pace {
    double sweeps = 0.0;
    double last_change = 0.0;  // of the impulses, squared
  };
  Last last(std::uint64_t name) noexcept;
  static void push(const Row& row, const Vec3& impulse, std::span<Twist> V) noexcept;
  void arrange(std::span<Twist> V) noexcept;
  double sweep(const Range& island, std::span<Twist> V) noexcept;
  bool open_nothing(const Range& island, std::span<Twist> V) noexcept;
  void limit_friction(const Range& island) noexcept;
  void accelerate(const Range& island, Pace& pace, std::span<Twist> V) noexcept;
  SolverResult solve_island(const Range& island, int max_sweeps, double harmless,
                            std::span<Twist> V) noexcept;

  ReservedVector<Row> rows_;
  ReservedVector<Last> last_, now_;  // of the last frame, and of this one
  ReservedVector<JointRow> joints_;
  ReservedVector<int> order_, joint_order_;  // rows, island by island
  std::vector<Range> islands_;               // by the island's number
  std::vector<int> joint_left_shut_;         // as Last::left_shut, by body
  std::size_t next_ = 0;                     // in last_: names come in the same order from frame to frame
  double h_ = kReferenceStep_s;              // of the rows [s]
  bool started_ = false;
};

}  // namespace tactum
