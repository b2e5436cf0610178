#include "tactum/dynamics/impacts.h"

#include <algorithm>

#include "tactum/base/static_vector.h"
#include "tactum/base/tolerances.h"
#include "tactum/dynamics/friction_row.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// Corners of one pair that are hit together; of more, the first ones.
constexpr Index kMostCorners = 32;
constexpr int kSweeps = 50;

double approach(const ContactRow& row, std::span<const Pose> X_WB, std::span<const Twist> V) {
  const Index a = Index(row.body_a);
  const Index b = Index(row.body_b);
  return -row.n_BA_W.dot(velocity_at(V[a], row.p_W - X_WB[a].p) - velocity_at(V[b], row.p_W - X_WB[b].p));
}

struct Corner {
  FrictionRow row;
  Vec3 p_W = Vec3::Zero();
  double wanted = 0.0;  // normal velocity after the impact [m/s]
};

/// All corners of the pair of `first` that close within h.
void hit(std::span<const ContactRow> rows, const ContactRow& first, std::span<const Pose> X_WB,
         std::span<const Mobility> W, double h, std::span<Twist> V, ImpactObserver* observer) {
  StaticVector<Corner, kMostCorners> corners;
  for (const ContactRow& row : rows) {
    if (row.body_a != first.body_a || row.body_b != first.body_b) continue;
    const double speed = approach(row, X_WB, V);
    if (row.distance > std::max(0.0, speed) * h) continue;
    Corner corner;
    corner.row.set(row, X_WB, W);
    corner.p_W = row.p_W;
    corner.wanted = speed > kImpactSpeed ? row.restitution * speed : 0.0;
    if (!corners.push_back(corner)) break;
  }
  Twist& a = V[Index(first.body_a)];
  Twist& b = V[Index(first.body_b)];
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double change = 0.0;
    for (Corner& corner : corners) change = std::max(change, corner.row.relax(corner.wanted, a, b));
    if (change <= tolerances::kContactVelocity * kImpactSpeed) break;
  }
  if (observer == nullptr) return;
  for (const Corner& corner : corners)
    if (corner.row.impulse[0] > 0.0)
      observer->hit(first.body_a, first.body_b, corner.row.impulse_W(), corner.p_W);
}

}  // namespace

int resolve_impacts(std::span<ContactRow> rows, std::span<const Pose> X_WB, std::span<const Mobility> W,
                    double h, int most, std::span<Twist> V, ImpactObserver* observer) noexcept {
  for (int hits = 0; hits < most; ++hits) {
    ContactRow* fastest = nullptr;
    double speed = kImpactSpeed;
    for (ContactRow& row : rows) {
      if (!row.struck) continue;
      const double closing = approach(row, X_WB, V);
      if (!(closing > speed) || row.distance > closing * h) continue;
      fastest = &row;
      speed = closing;
    }
    if (fastest == nullptr) return hits;
    fastest->hit = true;
    hit(rows, *fastest, X_WB, W, h, V, observer);
  }
  return most;
}

}  // namespace tactum
