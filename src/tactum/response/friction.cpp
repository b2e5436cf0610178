#include "tactum/response/friction.h"

#include <algorithm>
#include <cmath>

namespace tactum {
namespace {

using Index = std::size_t;

/// How much less than the gap a row asks for, by the anchor's distance.
double allowance(const FrictionPatch& patch, Index k) {
  if (k >= Friction::kDirections || patch.apart_W.isZero(0.0)) return 0.0;
  return (cone_edge(patch, k).force - patch.n_BA_W).dot(patch.apart_W);
}

/// A lift, or a gap, of less than this share of the skin is none. What slides without lifting (on the way to
/// a wall that it has not reached) needs no leave: of a wedged part, every leave would lead to another. And
/// what a wedged part could move by in such gaps would grow without bound near the limit.
constexpr double kSettled = 0.25;

/// How far the patch's anchor has come apart in the surface.
Vec3 apart(const FrictionPatch& patch, const Pose& X_WA, const Pose& X_W_B) {
  const Vec3 offset = X_WA * patch.on_A - X_W_B * patch.on_B;
  return offset - patch.n_BA_W * patch.n_BA_W.dot(offset);
}

/// How far beyond the skin a patch is.
double gap_beyond(double distance_m, double skin_m) {
  return distance_m - skin_m > kSettled * skin_m ? distance_m - skin_m : 0.0;
}

}  // namespace

FrictionPatch* Friction::patch_of(const PatchKey& key) noexcept {
  const auto found = std::find_if(patches_.begin(), patches_.end(),
                                  [&](const FrictionPatch& other) { return other.key == key; });
  return found == patches_.end() ? nullptr : found;
}

/// The patches that push in the last answer.
void Friction::find_pushing(const World& world, const PairCoefficients& settings,
                            std::span<const ContactRow> rows, std::span<const ContactPatch> patches,
                            double skin_m, Index first_row, const ConstraintProblem& problem) noexcept {
  const auto for_pushing_rows = [&](const auto& visit) {
    for (const QpActive& active : problem.answer().active) {
      const Index i = Index(active.row) - first_row;
      if (Index(active.row) < first_row || i >= rows.size() || !(active.multiplier > 0.0)) continue;
      const PatchKey key = key_of(world, patches[Index(rows[i].patch)]);
      FrictionPatch* found = patch_of(key);
      if (found == nullptr) {
        FrictionPatch next;
        next.key = key;
        next.finder_patch = rows[i].patch;
        next.coefficient = settings.between(key.body_a, key.body_b);
        if (!(next.coefficient > 0.0) || !patches_.push_back(next)) continue;
        found = &patches_.back();
      }
      visit(*found, rows[i], active.multiplier);
    }
  };
  for_pushing_rows([](FrictionPatch& patch, const ContactRow& row, double force) {
    patch.load_N += force;
    patch.centre_W += force * row.p_W;
    patch.n_BA_W += force * row.n_BA_W;
    patch.gap_m += force * row.distance;
  });
  for (FrictionPatch& patch : patches_) {
    patch.centre_W /= patch.load_N;
    patch.gap_m = gap_beyond(patch.gap_m / patch.load_N, skin_m);
    patch.n_BA_W.normalize();
  }
  for_pushing_rows([](FrictionPatch& patch, const ContactRow& row, double force) {
    patch.radius_m += force / patch.load_N * (row.p_W - patch.centre_W).norm();
  });
}

/// The patches that held in the last frame, do not push by themselves, and touch.
void Friction::find_holding(const World& world, const PairCoefficients& settings,
                            std::span<const ContactRow> rows, std::span<const ContactPatch> patches,
                            std::span<const Pose> X_WB, double skin_m) noexcept {
  for (const Anchor& last : anchors_) {
    if (!last.pushed || patch_of(last.key) != nullptr) continue;
    FrictionPatch patch;
    patch.key = last.key;
    patch.coefficient = settings.between(last.key.body_a, last.key.body_b);
    patch.centre_W = X_WB[Index(last.key.body_a)] * last.centre_A;
    patch.radius_m = last.radius_m;
    for (const ContactRow& row : rows) {
      if (gap_beyond(row.distance, skin_m) > 0.0 || !(key_of(world, patches[Index(row.patch)]) == last.key))
        continue;
      patch.finder_patch = row.patch;
      patch.n_BA_W += row.n_BA_W;
    }
    if (patch.finder_patch < 0) continue;
    patch.n_BA_W.normalize();
    if (!patches_.push_back(patch)) return;
  }
}

/// How fast the turning that the bodies want takes the patch off, about the middle of all patches on the
/// body; negative: it squeezes it.
double Friction::taken_off(const FrictionPatch& patch, const ConstraintProblem& problem) const noexcept {
  double off = 0.0;
  for (const int body : {patch.key.body_a, patch.key.body_b}) {
    const Vec3 turn = problem.wanted_turn(body);
    if (turn.isZero(0.0)) continue;
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const FrictionPatch& other : patches_) {
      if (other.key.body_a != body && other.key.body_b != body) continue;
      sum += other.centre_W;
      ++count;
    }
    const double rate = patch.n_BA_W.dot(turn.cross(patch.centre_W - sum / count));
    off += body == patch.key.body_a ? rate : -rate;
  }
  return off;
}

/// Takes those out that only held and that no turning squeezes.
void Friction::drop_unsqueezed(const ConstraintProblem& problem) noexcept {
  std::array<bool, kMostPatches> stays{};
  for (Index i = 0; i < patches_.size(); ++i)
    stays[i] = patches_[i].load_N > 0.0 || !(taken_off(patches_[i], problem) > 0.0);
  Index kept = 0;
  for (Index i = 0; i < patches_.size(); ++i)
    if (stays[i]) patches_[kept++] = patches_[i];
  while (patches_.size() > kept) patches_.pop_back();
}

bool Friction::begin(const World& world, const PairCoefficients& settings, std::span<const ContactRow> rows,
                     std::span<const ContactPatch> patches, std::span<const Pose> X_WB, double skin_m,
                     std::size_t first_row, ConstraintProblem& problem) noexcept {
  patches_.clear();
  if (settings.coefficients.empty()) return false;
  find_pushing(world, settings, rows, patches, skin_m, first_row, problem);
  find_holding(world, settings, rows, patches, X_WB, skin_m);
  drop_unsqueezed(problem);
  for (FrictionPatch& patch : patches_) {
    anchor(patch, X_WB, kSettled * skin_m);
    patch.motion = motion_of(patch, any_orthogonal(patch.n_BA_W), problem);
    const Vec3 displacement = slide_of(patch, problem).displacement;
    if (const double length = displacement.norm(); length > 0.0)
      turn_directions(displacement / length, patch.motion);
    add_cone(patch, problem);
  }
  return acts();
}

/// The anchor and the centre of the patch's last frame; if it had none, it is anchored here.
void Friction::anchor(FrictionPatch& patch, std::span<const Pose> X_WB, double settled_m) noexcept {
  const Pose& X_WA = X_WB[Index(patch.key.body_a)];
  const Pose& X_W_B = X_WB[Index(patch.key.body_b)];
  const auto last = std::find_if(anchors_.begin(), anchors_.end(),
                                 [&](const Anchor& other) { return other.key == patch.key; });
  if (last == anchors_.end()) {
    patch.on_A = X_WA.inverse() * patch.centre_W;
    patch.on_B = X_W_B.inverse() * patch.centre_W;
    return;
  }
  patch.on_A = last->on_A;
  patch.on_B = last->on_B;
  patch.sticks_by = last->sticks_by;
  patch.apart_W = apart(patch, X_WA, X_W_B);
  if (patch.apart_W.norm() <= settled_m) patch.apart_W.setZero();
  const Vec3 centre = X_WA * last->centre_A;
  patch.centre_W = centre + patch.n_BA_W * patch.n_BA_W.dot(patch.centre_W - centre);
}

void Friction::add_cone(FrictionPatch& patch, ConstraintProblem& problem) noexcept {
  QpCone cone = cone_of(patch);
  for (Index k = 0; k < kRowsAPatch; ++k) cone.more[k] = -patch.gap_m - allowance(patch, k);
  patch.first_row = problem.add_cone(cone);
}

FrictionPatch* Friction::patch_of_row(Index row) noexcept {
  const auto found = std::find_if(patches_.begin(), patches_.end(), [&](const FrictionPatch& patch) {
    return row >= patch.first_row && row < patch.first_row + kRowsAPatch;
  });
  return found == patches_.end() ? nullptr : found;
}

void Friction::rows_that_stuck(StaticVector<int, kMostUnknowns>& rows) const noexcept {
  for (const FrictionPatch& patch : patches_)
    for (Index k = 0; k < kRowsAPatch; ++k)
      if ((patch.sticks_by >> k & 1u) != 0) rows.push_back(static_cast<int>(patch.first_row + k));
}

void Friction::note_sticking(const ConstraintProblem& problem) noexcept {
  for (FrictionPatch& patch : patches_) patch.sticks_by = 0;
  for (const QpActive& active : problem.answer().active) {
    const Index row = Index(active.row);
    if (FrictionPatch* const patch = patch_of_row(row)) patch->sticks_by |= 1u << (row - patch->first_row);
  }
}

/// Its rows ask for nothing that a part could miss.
void Friction::drop_cone(FrictionPatch& patch, ConstraintProblem& problem) noexcept {
  constexpr double kAnywhere_m = 1e3;  // [m]
  for (double& more : problem.cone(patch.first_row).more) more -= kAnywhere_m;
  patch.acts = false;
}

bool Friction::let_slip(double skin_m, ConstraintProblem& problem) noexcept {
  const double settled = kSettled * skin_m;
  bool changed = false;
  for (FrictionPatch& patch : patches_) {
    if (!patch.acts) continue;
    const Slide slide = slide_of(patch, problem);
    const double arm = patch.coefficient * patch.radius_m;
    double further = std::min(slide.lift, patch.coefficient * (slide.displacement.norm() - patch.slip_m));
    double turned = std::min(slide.lift, arm * (std::abs(slide.turn) - patch.slip_rad));
    if (further <= settled) further = 0.0;
    if (turned <= settled) turned = 0.0;
    if (further == 0.0 && turned == 0.0) continue;
    changed = true;
    if (patch.load_N == 0.0) {
      drop_cone(patch, problem);
      continue;
    }
    QpCone& cone = problem.cone(patch.first_row);
    for (Index k = 0; k < kRowsAPatch; ++k) cone.more[k] -= k < kDirections ? further : turned;
    patch.slip_m += further / patch.coefficient;
    if (turned > 0.0) patch.slip_rad += turned / arm;
  }
  return changed;
}

void Friction::forget_anchors(ConstraintProblem& problem) noexcept {
  for (FrictionPatch& patch : patches_) {
    if (!patch.acts) continue;
    QpCone& cone = problem.cone(patch.first_row);
    for (Index k = 0; k < kRowsAPatch; ++k) cone.more[k] += allowance(patch, k);
    patch.apart_W.setZero();
    patch.anchored = false;
  }
}

void Friction::end(const World& world, std::span<const ContactRow> rows,
                   std::span<const ContactPatch> patches, std::size_t first_row,
                   const ConstraintProblem& problem, std::span<const Pose> X_WB) noexcept {
  anchors_.clear();
  for (const FrictionPatch& patch : patches_) {
    if (!patch.acts) continue;
    // The centre of all forces of the patch: its corners', and the cone's at the centre so far.
    double load = 0.0;
    Vec3 moment = Vec3::Zero();
    bool pushed = false;
    for (const QpActive& active : problem.answer().active) {
      const Index row = Index(active.row);
      if (row >= patch.first_row && row < patch.first_row + kRowsAPatch) {
        load += active.multiplier;
        moment += active.multiplier * patch.centre_W;
        pushed |= active.multiplier > 0.0;
      } else if (row >= first_row && row - first_row < rows.size() &&
                 key_of(world, patches[Index(rows[row - first_row].patch)]) == patch.key) {
        load += active.multiplier;
        moment += active.multiplier * rows[row - first_row].p_W;
      }
    }
    const Vec3 centre = load > 0.0 ? Vec3(moment / load) : patch.centre_W;
    const Pose& X_WA = X_WB[Index(patch.key.body_a)];
    const Pose& X_W_B = X_WB[Index(patch.key.body_b)];
    // By where the bodies are: the answer, being of first order, has never come apart.
    Vec3 on_A_W = centre;
    if (patch.anchored && patch.slip_m == 0.0) on_A_W += apart(patch, X_WA, X_W_B);
    anchors_.push_back({patch.key, X_WA.inverse() * on_A_W, X_W_B.inverse() * centre, X_WA.inverse() * centre,
                        patch.radius_m, patch.sticks_by, pushed});
  }
}

Vec3 Friction::add_forces(int body, double dt_s, const ConstraintProblem& problem,
                          std::vector<ContactRow>& rows) const noexcept {
  Vec3 torque = Vec3::Zero();
  for (const QpActive& active : problem.answer().active)
    for (const FrictionPatch& patch : patches_) {
      const Index row = Index(active.row);
      if (row < patch.first_row || row >= patch.first_row + kRowsAPatch || !patch.acts) continue;
      const Push push = cone_edge(patch, row - patch.first_row);
      if (patch.key.body_a == body) torque += active.multiplier * push.torque;
      if (patch.key.body_b == body) torque -= active.multiplier * push.torque;
      if (rows.size() == rows.capacity()) continue;
      ContactRow& force = rows.emplace_back();
      force.body_a = patch.key.body_a;
      force.body_b = patch.key.body_b;
      force.patch = patch.finder_patch;
      force.grip = static_cast<int>(&patch - patches_.begin());
      force.p_W = patch.centre_W;
      force.n_BA_W = push.force.normalized();
      force.distance = patch.gap_m;
      force.impulse = active.multiplier * push.force.norm() * dt_s;
    }
  return torque;
}

}  // namespace tactum
