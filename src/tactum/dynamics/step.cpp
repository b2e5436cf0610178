#include "tactum/dynamics/step.h"

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

double normal_velocity(const ContactRow& row, std::span<const Pose> X_WB, std::span<const Twist> V) {
  const Index a = Index(row.body_a);
  const Index b = Index(row.body_b);
  return row.n_BA_W.dot(velocity_at(V[a], row.p_W - X_WB[a].p) - velocity_at(V[b], row.p_W - X_WB[b].p));
}

}  // namespace

double time_of_closing(const ContactRow& row, std::span<const Pose> X_WB, std::span<const Twist> V,
                       double dt) noexcept {
  if (row.distance <= 0.0) return 0.0;
  const double closing = -normal_velocity(row, X_WB, V);
  return closing * dt > row.distance ? row.distance / closing : dt;
}

void advance_distances(std::span<ContactRow> rows, std::span<const Pose> X_WB, std::span<const Twist> V,
                       double t) noexcept {
  for (ContactRow& row : rows) row.distance += t * normal_velocity(row, X_WB, V);
}

void advance_bodies(const World& world, std::span<const Twist> V, double t, std::span<Pose> X_WB) noexcept {
  for (Index i = 0; i < X_WB.size(); ++i)
    if (world.bodies[i].moves()) X_WB[i] = advanced(X_WB[i], V[i], t);
}

}  // namespace tactum::inline v0_1
