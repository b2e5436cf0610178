#include "tactum/dynamics/impacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tactum/base/static_vector.h"
#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

constexpr int kMostIterations = 200;

/// What bodies at rest approach with: a frame begins with half a frame's weight, and a body that was let down
/// in the last one may have that of a whole one; half as much again is the margin.
constexpr double kRestFrames = 1.5;
/// ... and what solvers leave of a rest without weight, a hundred times (kRestingVelocity).
constexpr double kRest_m_per_s = 100.0 * tolerances::kRestingVelocity;

/// A contact carries a body where the push of all the body's contacts is at an angle of less than that with
/// this cosine to its normal.
constexpr double kCarries = 0.5;

/// The corners of one impact, which are solved together, each with its least normal velocity after it [m/s]:
/// those of the two bodies that meet, all fixed bodies counting as one, the world, and those that carry them.
using Corners = StaticVector<ContactRow, ImpactScratch::kMostCorners>;

/// The velocity at which a motion of the bodies opens a row.
double opening(const ContactRow& row, const ImpactBodies& bodies, std::span<const Twist> motion) {
  const Index a = Index(row.body_a);
  const Index b = Index(row.body_b);
  return row.n_BA_W.dot(velocity_at(motion[a], row.p_W - bodies.X_WB[a].p) -
                        velocity_at(motion[b], row.p_W - bodies.X_WB[b].p));
}

/// A row's gap beyond the skin, and the speed at which it closes, `t` seconds after the start of the frame.
struct Gap {
  double beyond_skin = 0.0;  // [m]
  double closing = 0.0;      // [m/s]
  double faster = 0.0;       // [m/s^2]
};
Gap gap_at(const ContactRow& row, const ImpactBodies& bodies, double t) {
  const double closing = -opening(row, bodies, bodies.V_WB);
  const double faster = -opening(row, bodies, bodies.A_WB);
  const double start = row.distance - row.skin_m + opening(row, bodies, bodies.detour);
  return {start - t * (closing + 0.5 * t * faster), closing + t * faster, faster};
}

constexpr int kWorld = -1;

/// The two bodies that meet at a row, the fixed ones as the world, the smaller number first.
std::pair<int, int> met_at(const ContactRow& row, const World& world) {
  const auto who = [&](int body) { return world.bodies[Index(body)].moves() ? body : kWorld; };
  return std::minmax({who(row.body_a), who(row.body_b)});
}

/// Reports the fraction `share` of an answer's impulses to the observer.
void report(const RowsInProblem& contacts, const Friction& friction, const ContactProblem& problem,
            double share, ImpactObserver* observer) {
  if (observer == nullptr || !(share > 0.0)) return;
  for (const QpActive& active : problem.answer().active)
    if (const ContactRow* const row = contacts.row(active.row))
      observer->hit(row->body_a, row->body_b, share * active.multiplier * row->n_BA_W, Vec3::Zero(),
                    row->p_W);
  friction.for_each_force(problem, [&](Index patch, const Push& push, double multiplier) {
    const SurfacePair& on = friction.patches()[patch].surfaces;
    observer->hit(on.body_a, on.body_b, share * multiplier * push.force, share * multiplier * push.torque,
                  push.p_W);
  });
}

/// Whether a contact carried one of its two bodies in the last frame, and touches `t` seconds after the start
/// of this one.
bool carries(const ContactRow& row, const ImpactBodies& bodies, double t) {
  const Vec3& of_a = bodies.A_contacts[Index(row.body_a)].v;
  const Vec3& of_b = bodies.A_contacts[Index(row.body_b)].v;
  const bool pushes =
      row.n_BA_W.dot(of_a) > kCarries * of_a.norm() || -row.n_BA_W.dot(of_b) > kCarries * of_b.norm();
  return pushes && !row.idle && gap_at(row, bodies, t).beyond_skin <= row.skin_m;
}

/// Twists of the bodies of one impact, in the order of its list.
using Twists = std::array<Twist, ImpactScratch::kMostBodies>;

/// The impact of two bodies and of those that carry them, at a time t of the frame. A free body has moved
/// until then, but not turned: its angular momentum, which is kept, is stated by the inertia at the start of
/// the frame.
class Impact {
 public:
  Impact(std::span<const ContactRow> rows, const ContactRow& first, double t, const ImpactBodies& bodies,
         ImpactScratch& scratch)
      : met_(met_at(first, bodies.world)),
        t_(t),
        input_{bodies.X_WB, scratch.no_anchors},
        bodies_(bodies),
        scratch_(scratch) {
    list_bodies(rows);
    for_each_body([&](Index i, int number) {
      const Index body = Index(number);
      const Twist& V = bodies.V_WB[body];
      const Twist& A = bodies.A_WB[body];
      X_WB_[i] = bodies.X_WB[body];
      if (bodies.world.bodies[body].joint.kind == JointKind::kFree)
        X_WB_[i].p += bodies.detour[body].v + t * (V.v + 0.5 * t * A.v);
      before_[i] = V + A * t;
    });
  }

  /// Finds all corners of the pair that meet with `first`, as where two faces meet flat, rounding must not
  /// leave corners out; and those of the contacts that carry.
  void find_corners(std::span<const ContactRow> rows, const ContactRow& first, double speed, double h) {
    const double near_m = gap_at(first, bodies_, t_).beyond_skin + first.skin_m;
    for (const ContactRow& row : rows) {
      const bool meets =
          !row.idle && met_at(row, bodies_.world) == met_ && gap_at(row, bodies_, t_).beyond_skin <= near_m;
      if (!meets && !holds(row)) continue;
      if (!corners_.push_back(row)) continue;
      ContactRow& corner = corners_.back();
      corner.p_W += row.rolls ? contact_moved(row)
                              : 0.5 * (moved_by(row.body_a, row.p_W) + moved_by(row.body_b, row.p_W));
      const double closing = approach(corner);
      corner.distance = 0.0;
      corner.skin_m = tolerances::kImpactSettled * speed / kSettledSkins;  // lengths are speeds here
      corner.asked = closing > slowest_impact(row, bodies_, h) ? row.impact.restitution * closing : 0.0;
    }
  }
  /// Solves for the velocities after the impact, each corner leaving with what it asks, or, plastic, with
  /// zero.
  bool solve(bool plastic) {
    corners_now_ = corners_;
    if (plastic)
      for (ContactRow& row : corners_now_) row.asked = 0.0;
    set_problem();
    ExactStart start;
    return solve_exactly(contacts_, input_, kMostIterations, start, scratch_.friction, scratch_.problem)
        .solved;
  }
  Twists answer() const {
    Twists V;
    for_each_body([&](Index i, int body) { V[i] = to_twist(scratch_.problem.displacement(body)); });
    return V;
  }
  const Twists& before() const { return before_; }
  /// Kinetic energy of the bodies that the impact moves [J].
  double energy(const Twists& V) const {
    double energy_J = 0.0;
    for_each_body([&](Index i, int body) {
      if (bodies_.moves[Index(body)] == 0) return;
      const Body& what = bodies_.world.bodies[Index(body)];
      const Vec3 w_B = bodies_.X_WB[Index(body)].R.transpose() * V[i].w;
      energy_J += 0.5 * what.mass_kg * V[i].v.squaredNorm() + 0.5 * w_B.dot(what.inertia_B * w_B);
    });
    return energy_J;
  }
  /// Whether no body with a given velocity does work on the others.
  bool is_closed() const {
    bool closed = true;
    for_each_body([&](Index i, int body) {
      closed &= bodies_.moves[Index(body)] != 0 || (before_[i].v.isZero(0.0) && before_[i].w.isZero(0.0));
    });
    return closed;
  }
  void give(double share, ImpactObserver* observer) const {
    report(contacts_, scratch_.friction, scratch_.problem, share, observer);
  }
  /// Sets the velocities after the impact, and what their change adds to the detours.
  void set(const Twists& V) const {
    for_each_body([&](Index i, int body) {
      if (bodies_.moves[Index(body)] == 0) return;
      const Twist change = V[i] - before_[i];
      bodies_.V_WB[Index(body)] = bodies_.V_WB[Index(body)] + change;
      bodies_.detour[Index(body)] = bodies_.detour[Index(body)] - change * t_;
    });
  }

 private:
  /// Calls visit(its place in the list, number) for each body.
  template <class Visit>
  void for_each_body(const Visit& visit) const {
    for (Index i = 0; i < list_.size(); ++i) visit(i, list_[i]);
  }
  bool lists(int body) const { return std::find(list_.begin(), list_.end(), body) != list_.end(); }
  /// Lists the two bodies, and those that carry them, and those that carry these. What carries a body with a
  /// given velocity is of no account.
  void list_bodies(std::span<const ContactRow> rows) {
    for (const int body : {met_.first, met_.second})
      if (body != kWorld) list_.push_back(body);
    for (Index i = 0; i < list_.size(); ++i) {
      if (bodies_.moves[Index(list_[i])] == 0) continue;
      for (const ContactRow& row : rows) {
        if ((row.body_a != list_[i] && row.body_b != list_[i]) || !carries(row, bodies_, t_)) continue;
        const int other = row.body_a == list_[i] ? row.body_b : row.body_a;
        if (bodies_.world.bodies[Index(other)].moves() && !lists(other) && !list_.push_back(other)) return;
      }
    }
  }
  /// Whether a contact of the listed bodies and the world carries, and is not that of the two that meet.
  bool holds(const ContactRow& row) const {
    const auto [one, other] = met_at(row, bodies_.world);
    if (std::pair(one, other) == met_ || !lists(other) || (one != kWorld && !lists(one))) return false;
    return carries(row, bodies_, t_);
  }
  /// Sets up the problem of the impact: velocities for displacements, impulses for forces.
  void set_problem() {
    ContactProblem& problem = scratch_.problem;
    problem.clear();
    for_each_body([&](Index i, int body) {
      if (bodies_.moves[Index(body)] == 0) {  // the impact does not change its velocity, but depends on it
        problem.add_given(body, X_WB_[i].p, to_vector(before_[i]));
        return;
      }
      const Body& what = bodies_.world.bodies[Index(body)];
      problem.add_body({body, what, X_WB_[i]}, X_WB_[i].p, inertial_metric(what, X_WB_[i], 1.0),
                       to_vector(before_[i]), 0.0);
    });
    contacts_ = {{corners_now_.begin(), corners_now_.end()}, problem.rows()};
    for (const ContactRow& row : corners_now_)
      problem.add_row(row.body_a, row.body_b, push_of(row), row.asked);
  }
  /// The speed at which a corner closes, which was moved to the time of the impact.
  double approach(const ContactRow& corner) const {
    Vec3 v = Vec3::Zero();
    for_each_body([&](Index i, int body) {
      const Vec3 of_body = velocity_at(before_[i], corner.p_W - X_WB_[i].p);
      if (body == corner.body_a) v += of_body;
      if (body == corner.body_b) v -= of_body;
    });
    return -corner.n_BA_W.dot(v);
  }
  /// How far the contact of curved surfaces has moved until the impact: along with the centre of what moves,
  /// which turns beneath it.
  Vec3 contact_moved(const ContactRow& row) const {
    const auto along = [&](int body) { return moved_by(body, bodies_.X_WB[Index(body)].p); };
    if (row.fixed_a) return along(row.body_b);
    if (row.fixed_b) return along(row.body_a);
    return 0.5 * (along(row.body_a) + along(row.body_b));
  }
  /// How far a point of a body has moved until the impact.
  Vec3 moved_by(int body, const Vec3& p_W) const {
    const Index i = Index(body);
    const Twist moved = bodies_.detour[i] + (bodies_.V_WB[i] + bodies_.A_WB[i] * (0.5 * t_)) * t_;
    return velocity_at(moved, p_W - bodies_.X_WB[i].p);
  }

  std::pair<int, int> met_;
  StaticVector<int, ImpactScratch::kMostBodies> list_;
  double t_;
  std::array<Pose, ImpactScratch::kMostBodies> X_WB_;
  Twists before_;
  Corners corners_, corners_now_;
  RowsInProblem contacts_;
  FrictionInput input_;
  const ImpactBodies& bodies_;
  ImpactScratch& scratch_;
};

Twists mixed(double share, const Twists& one, const Twists& other) {
  Twists V;
  for (Index i = 0; i < V.size(); ++i) V[i] = one[i] * share + other[i] * (1.0 - share);
  return V;
}

/// Solves the impact at `first`; false when its impulses are not exact.
///
/// Newton's restitution with friction can increase the energy where friction reverses the slip [Kane 1984].
/// Then the answer is mixed with that of Poisson's restitution, which never does: the plastic impulses and e
/// times these again. Both satisfy the cones and leave no corner approaching, and so does every mixture of
/// them.
bool hit(std::span<const ContactRow> rows, const ContactRow& first, const Meeting& meeting,
         const ImpactBodies& bodies, double h, ImpactScratch& scratch, ImpactObserver* observer) {
  Impact impact(rows, first, meeting.time_s, bodies, scratch);
  impact.find_corners(rows, first, meeting.speed, h);
  const Twists& before = impact.before();
  if (!impact.solve(false)) {  // a body without room to bounce, hit from both sides, stays
    const bool solved = impact.solve(true);
    impact.give(1.0, observer);
    impact.set(impact.answer());
    return solved;
  }
  const Twists newton = impact.answer();
  const double most_J = impact.energy(before);
  // A given velocity does work on the other body: then energy is no criterion.
  const bool closed = impact.is_closed();
  if (!closed || !(impact.energy(newton) > most_J * (1.0 + tolerances::kImpactSettled))) {
    impact.give(1.0, observer);
    impact.set(newton);
    return true;
  }
  const bool plastic_solved = impact.solve(true);
  const double e = first.impact.restitution;
  const Twists plastic = impact.answer();
  const Twists poisson = mixed(1.0 + e, plastic, before);
  double share = 0.0;
  for (double step = 0.5; step > tolerances::kImpactSettled; step *= 0.5)
    if (impact.energy(mixed(share + step, newton, poisson)) <= most_J) share += step;
  impact.give((1.0 - share) * (1.0 + e), observer);
  const bool newton_solved = impact.solve(false);
  impact.give(share, observer);
  impact.set(mixed(share, newton, poisson));
  return plastic_solved && newton_solved;
}

}  // namespace

Meeting meeting_of(const ContactRow& row, const ImpactBodies& bodies, double now) noexcept {
  const Gap gap = gap_at(row, bodies, now);
  if (gap.beyond_skin <= 0.0) return {now, gap.closing};
  const double squared = gap.closing * gap.closing + 2.0 * gap.faster * gap.beyond_skin;
  const double speed = squared > 0.0 ? std::sqrt(squared) : 0.0;
  if (!(gap.closing + speed > 0.0)) return {std::numeric_limits<double>::infinity(), 0.0};
  return {now + 2.0 * gap.beyond_skin / (gap.closing + speed), speed};
}

double slowest_impact(const ContactRow& row, const ImpactBodies& bodies, double h) noexcept {
  const Vec3& n = row.n_BA_W;
  const auto weight = [&](int body) {
    return std::abs(n.dot(bodies.A_WB[Index(body)].v - bodies.A_contacts[Index(body)].v));
  };
  const double falls = std::max(weight(row.body_a), weight(row.body_b));
  return kRestFrames * falls * h + row.skin_m / h + kRest_m_per_s;
}

ImpactResult resolve_impacts(std::span<ContactRow> rows, const ImpactBodies& bodies, double h, int most,
                             ImpactScratch& scratch, ImpactObserver* observer) noexcept {
  ImpactResult result;
  for (double now = 0.0;; ++result.hits) {
    ContactRow* first = nullptr;
    Meeting meeting{h, 0.0};
    for (ContactRow& row : rows) {
      if (!row.impact.enabled) continue;
      const Meeting of_row = meeting_of(row, bodies, now);
      const bool sooner =
          of_row.time_s < meeting.time_s || (of_row.time_s == meeting.time_s && of_row.speed > meeting.speed);
      if (!sooner || !(of_row.speed > slowest_impact(row, bodies, h))) continue;
      first = &row;
      meeting = of_row;
    }
    if (first == nullptr) return result;
    if (result.hits == most) {
      result.converged = false;
      return result;
    }
    now = meeting.time_s;
    first->impact.seen = true;
    result.converged &= hit(rows, *first, meeting, bodies, h, scratch, observer);
  }
}

}  // namespace tactum::inline v0_1
