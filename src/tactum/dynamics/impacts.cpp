#include "tactum/dynamics/impacts.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tactum/base/static_vector.h"
#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

constexpr int kMostIterations = 200;

/// The corners of one impact, which are solved together, each with its least normal velocity after it [m/s].
/// They are those of two bodies; all fixed bodies count as one, the world.
using Corners = StaticVector<ContactRow, ImpactScratch::kMostCorners>;

double approach(const ContactRow& row, const ImpactBodies& bodies) {
  const Index a = Index(row.body_a);
  const Index b = Index(row.body_b);
  return -row.n_BA_W.dot(velocity_at(bodies.V_WB[a], row.p_W - bodies.X_WB[a].p) -
                         velocity_at(bodies.V_WB[b], row.p_W - bodies.X_WB[b].p));
}

constexpr int kWorld = -1;

/// The two bodies that meet at a row, the fixed ones as the world, the smaller number first.
std::pair<int, int> met_at(const ContactRow& row, const World& world) {
  const auto who = [&](int body) { return world.bodies[Index(body)].moves() ? body : kWorld; };
  return std::minmax({who(row.body_a), who(row.body_b)});
}

/// Finds all corners of the impact of `first` that close within h, or are as near as that one: where two
/// faces meet flat, rounding must not leave corners out.
void find_corners(std::span<const ContactRow> rows, const ContactRow& first, const ImpactBodies& bodies,
                  double fastest, double h, Corners& corners) {
  for (const ContactRow& row : rows) {
    if (row.idle || met_at(row, bodies.world) != met_at(first, bodies.world)) continue;
    const double speed = approach(row, bodies);
    const double closes_m = std::max(std::max(0.0, speed) * h, first.distance + first.skin_m);
    if (row.distance > closes_m || !corners.push_back(row)) continue;
    corners.back().distance = 0.0;
    corners.back().skin_m = tolerances::kImpactSettled * fastest / kSettledSkins;  // lengths are speeds here
    corners.back().asked = speed > kImpactSpeed ? row.impact.restitution * speed : 0.0;
  }
}

/// Sets up the problem of the impact: velocities for displacements, impulses for forces.
RowsInProblem set_problem(const Corners& corners, const ImpactBodies& bodies, ContactProblem& problem) {
  problem.clear();
  const auto [one, other] = met_at(corners[0], bodies.world);
  for (const int body : {one, other}) {
    if (body == kWorld) continue;
    const Index i = Index(body);
    const Body& what = bodies.world.bodies[i];
    const Pose& X_WB = bodies.X_WB[i];
    if (bodies.moves[i] == 0) {  // the impact does not change its velocity, but depends on it
      problem.add_given(body, X_WB.p, to_vector(bodies.V_WB[i]));
      continue;
    }
    problem.add_body({body, what, X_WB}, X_WB.p, inertial_metric(what, X_WB, 1.0), to_vector(bodies.V_WB[i]),
                     0.0);
  }
  const RowsInProblem contacts{{corners.begin(), corners.end()}, problem.rows()};
  for (const ContactRow& row : corners) problem.add_row(row.body_a, row.body_b, push_of(row), row.asked);
  return contacts;
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

/// Twists of the two bodies that meet; of the world, zero.
using PairTwists = std::array<Twist, 2>;

/// The impact of one pair.
class PairImpact {
 public:
  PairImpact(const Corners& corners, const ImpactBodies& bodies, ImpactScratch& scratch)
      : corners_(corners),
        met_(met_at(corners[0], bodies.world)),
        input_{bodies.X_WB, scratch.no_anchors},
        bodies_(bodies),
        scratch_(scratch) {}

  /// Solves for the velocities after the impact, each corner leaving with `asked`, or, plastic, with zero.
  bool solve(bool plastic) {
    corners_now_ = corners_;
    if (plastic)
      for (ContactRow& row : corners_now_) row.asked = 0.0;
    contacts_ = set_problem(corners_now_, bodies_, scratch_.problem);
    ExactStart start;
    return solve_exactly(contacts_, input_, kMostIterations, start, scratch_.friction, scratch_.problem)
        .solved;
  }
  PairTwists answer() const {
    PairTwists V;
    for_each_body([&](Index i, int body) { V[i] = to_twist(scratch_.problem.displacement(body)); });
    return V;
  }
  PairTwists now() const {
    PairTwists V;
    for_each_body([&](Index i, int body) { V[i] = bodies_.V_WB[Index(body)]; });
    return V;
  }
  /// Kinetic energy of the bodies of the pair that an impact moves [J].
  double energy(const PairTwists& V) const {
    double energy_J = 0.0;
    for_each_body([&](Index i, int body) {
      if (bodies_.moves[Index(body)] == 0) return;
      const Body& what = bodies_.world.bodies[Index(body)];
      const Vec3 w_B = bodies_.X_WB[Index(body)].R.transpose() * V[i].w;
      energy_J += 0.5 * what.mass_kg * V[i].v.squaredNorm() + 0.5 * w_B.dot(what.inertia_B * w_B);
    });
    return energy_J;
  }
  /// Whether no body with a given velocity does work on the pair.
  bool is_closed() const {
    bool closed = true;
    for_each_body([&](Index, int body) {
      const Twist& V = bodies_.V_WB[Index(body)];
      closed &= bodies_.moves[Index(body)] != 0 || (V.v.isZero(0.0) && V.w.isZero(0.0));
    });
    return closed;
  }
  void give(double share, ImpactObserver* observer) const {
    report(contacts_, scratch_.friction, scratch_.problem, share, observer);
  }
  void set(const PairTwists& V) const {
    for_each_body([&](Index i, int body) {
      if (bodies_.moves[Index(body)] != 0) bodies_.V_WB[Index(body)] = V[i];
    });
  }

 private:
  /// Calls visit(0 or 1, number) for those of the two that are bodies, not the world.
  template <class Visit>
  void for_each_body(const Visit& visit) const {
    if (met_.first != kWorld) visit(Index(0), met_.first);
    if (met_.second != kWorld) visit(Index(1), met_.second);
  }

  const Corners& corners_;
  std::pair<int, int> met_;
  Corners corners_now_;
  RowsInProblem contacts_;
  FrictionInput input_;
  const ImpactBodies& bodies_;
  ImpactScratch& scratch_;
};

PairTwists mixed(double share, const PairTwists& one, const PairTwists& other) {
  return {one[0] * share + other[0] * (1.0 - share), one[1] * share + other[1] * (1.0 - share)};
}

/// Solves the impact of the pair of `first`; false when its impulses are not exact.
///
/// Newton's restitution with friction can increase the energy where friction reverses the slip [Kane 1984].
/// Then the answer is mixed with that of Poisson's restitution, which never does: the plastic impulses and e
/// times these again. Both satisfy the cones and leave no corner approaching, and so does every mixture of
/// them.
bool hit(std::span<const ContactRow> rows, const ContactRow& first, const ImpactBodies& bodies, double speed,
         double h, ImpactScratch& scratch, ImpactObserver* observer) {
  Corners corners;
  find_corners(rows, first, bodies, speed, h, corners);
  PairImpact impact(corners, bodies, scratch);
  const PairTwists before = impact.now();
  if (!impact.solve(false)) {  // a body without room to bounce, hit from both sides, stays
    const bool solved = impact.solve(true);
    impact.give(1.0, observer);
    impact.set(impact.answer());
    return solved;
  }
  const PairTwists newton = impact.answer();
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
  const PairTwists plastic = impact.answer();
  const PairTwists poisson = mixed(1.0 + e, plastic, before);
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

ImpactResult resolve_impacts(std::span<ContactRow> rows, const ImpactBodies& bodies, double h, int most,
                             ImpactScratch& scratch, ImpactObserver* observer) noexcept {
  ImpactResult result;
  for (;; ++result.hits) {
    ContactRow* fastest = nullptr;
    double speed = kImpactSpeed;
    for (ContactRow& row : rows) {
      if (!row.impact.enabled) continue;
      const double closing = approach(row, bodies);
      if (!(closing > speed) || row.distance > closing * h) continue;
      fastest = &row;
      speed = closing;
    }
    if (fastest == nullptr) return result;
    if (result.hits == most) {
      result.converged = false;
      return result;
    }
    fastest->impact.seen = true;
    result.converged &= hit(rows, *fastest, bodies, speed, h, scratch, observer);
  }
}

}  // namespace tactum::inline v0_1
