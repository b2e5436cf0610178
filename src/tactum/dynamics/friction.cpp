#include "tactum/dynamics/friction.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/even_loads.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// A patch that moved from one piece of a surface to the next is in the same plane within so many skins.
constexpr double kAnchorPlaneSkins = 20.0;

bool has_friction(const ContactRow& row) { return row.friction > 0.0; }

/// By how much the anchor's displacement relaxes a row beyond the gap.
double allowance(const FrictionPatch& patch, Index k) {
  if (k >= Friction::kDirections || patch.anchor.apart_W.isZero(0.0)) return 0.0;
  return (cone_edge(patch, k).force - patch.place.n_BA_W).dot(patch.anchor.apart_W);
}

/// The displacement between the patch's two anchor points in the surface.
Vec3 apart(const FrictionPatch& patch, const Pose& X_WA, const Pose& X_W_B) {
  const Vec3 difference = X_WA * patch.anchor.on_A - X_W_B * patch.anchor.on_B;
  return difference - patch.place.n_BA_W * patch.place.n_BA_W.dot(difference);
}

/// Sets the displacement between the anchors; zero where it is too small to count.
void set_apart(const Pose& X_WA, const Pose& X_W_B, FrictionPatch& patch) {
  patch.anchor.apart_W = apart(patch, X_WA, X_W_B);
  if (patch.anchor.apart_W.norm() <= settled_length(patch.place.skin_m)) patch.anchor.apart_W.setZero();
}

/// The point of one body in the frame of another.
Vec3 carried(const Vec3& p, const Pose& X_W_from, const Pose& X_W_to) {
  return &X_W_from == &X_W_to ? p : Vec3(X_W_to.inverse() * (X_W_from * p));
}

/// How far a distance is beyond the skin; zero where that is too little to count.
double gap_beyond(double distance_m, double skin_m) {
  return distance_m - skin_m > settled_length(skin_m) ? distance_m - skin_m : 0.0;
}

}  // namespace

const FrictionAnchor* take_anchor(const FrictionAnchors& anchors, std::span<const Pose> X_WB,
                                  FrictionPatch& patch) noexcept {
  const Pose& X_WA = X_WB[Index(patch.surfaces.body_a)];
  const Pose& X_W_B = X_WB[Index(patch.surfaces.body_b)];
  const FrictionAnchor* const last = anchors.find(patch, X_WB, kAnchorPlaneSkins * patch.place.skin_m);
  if (last == nullptr || patch.rolls) {
    // The points that touched have turned away, and how far apart they are is no measure of a slide.
    const Vec3 slid = last != nullptr && !last->slid ? last->apart_W : Vec3::Zero();
    patch.anchor.on_A = X_WA.inverse() * (patch.place.centre_W + slid);
    patch.anchor.on_B = X_W_B.inverse() * patch.place.centre_W;
    set_apart(X_WA, X_W_B, patch);
    return last;
  }
  const Pose& X_WA_last = X_WB[Index(last->surfaces.body_a)];
  const Vec3 centre = X_WA_last * last->centre_A;
  patch.place.centre_W = centre + patch.place.n_BA_W * patch.place.n_BA_W.dot(patch.place.centre_W - centre);
  if (last->slid) {
    patch.anchor.on_A = carried(last->centre_A, X_WA_last, X_WA);
    patch.anchor.on_B = X_W_B.inverse() * centre;
    return last;
  }
  patch.anchor.on_A = carried(last->on_A, X_WA_last, X_WA);
  patch.anchor.on_B = carried(last->on_B, X_WB[Index(last->surfaces.body_b)], X_W_B);
  set_apart(X_WA, X_W_B, patch);
  return last;
}

FrictionAnchor next_anchor(const FrictionPatch& patch, const Vec3& centre_W, bool pushed,
                           std::span<const Pose> X_WB, const ContactProblem& problem) noexcept {
  const Pose& X_WA = X_WB[Index(patch.surfaces.body_a)];
  const Pose& X_W_B = X_WB[Index(patch.surfaces.body_b)];
  const bool slid = patch.sliding.acts ? !patch.sliding.sticks : patch.slip.displacement_m > 0.0;
  const Vec3 apart_W = patch.anchor.used && !slid ? apart(patch, X_WA, X_W_B) : Vec3::Zero();
  const Vec3 on_A_W = centre_W + apart_W;
  Vec3 rolled_W = Vec3::Zero();
  if (patch.rolls && patch.anchor.used && !slid)
    rolled_W = apart_W + slide_of(patch, problem).displacement - patch.anchor.apart_W;
  return {.surfaces = patch.surfaces,
          .n_A = rotated_back(X_WA.R, patch.place.n_BA_W),
          .on_A = X_WA.inverse() * on_A_W,
          .on_B = X_W_B.inverse() * centre_W,
          .centre_A = X_WA.inverse() * centre_W,
          .apart_W = rolled_W,
          .radius_m = patch.place.radius_m,
          .sticking = patch.rows.sticking,
          .pushed = pushed,
          .slid = slid};
}

FrictionPatch* Friction::patch_of(const SurfacePair& surfaces) noexcept {
  const auto found = std::find_if(patches_.begin(), patches_.end(),
                                  [&](const FrictionPatch& other) { return other.surfaces == surfaces; });
  return found == patches_.end() ? nullptr : found;
}

/// Finds the patches that push in the last answer.
void Friction::find_pushing(const RowsInProblem& contacts, const ContactProblem& problem) noexcept {
  EvenLoads loads;
  find_even_loads(contacts, problem, {}, loads);
  const auto for_pushing_rows = [&](const auto& visit) {
    for (Index i = 0; i < loads.rows.size(); ++i) {
      const ContactRow& row = contacts.rows[Index(loads.rows[i])];
      if (!(loads.force_N[i] > 0.0) || !has_friction(row)) continue;
      FrictionPatch* found = patch_of(row.friction_surfaces());
      if (found == nullptr) {
        FrictionPatch next;
        next.surfaces = row.friction_surfaces();
        next.source_patch = row.patch;
        next.coefficient = row.friction;
        next.place.skin_m = row.skin_m;
        if (!patches_.push_back(next)) {
          no_room_ = true;
          continue;
        }
        found = &patches_.back();
      }
      visit(*found, row, loads.force_N[i]);
    }
  };
  std::array<double, kMostPatches> opening{};  // by how much the rows have to open
  for_pushing_rows([&](FrictionPatch& patch, const ContactRow& row, double force) {
    patch.load_N += force;
    patch.rolls |= row.rolls;
    patch.place.centre_W += force * row.p_W;
    patch.place.n_BA_W += force * row.n_BA_W;
    patch.place.gap_m += force * row.distance;
    opening[static_cast<Index>(&patch - patches_.begin())] += force * std::max(0.0, row.asked);
  });
  for (FrictionPatch& patch : patches_) {
    patch.place.centre_W /= patch.load_N;
    const double opens = opening[static_cast<Index>(&patch - patches_.begin())] / patch.load_N;
    patch.place.gap_m =
        opens > 0.0 ? -opens : gap_beyond(patch.place.gap_m / patch.load_N, patch.place.skin_m);
    patch.place.n_BA_W.normalize();
  }
  for_pushing_rows([](FrictionPatch& patch, const ContactRow& row, double force) {
    patch.place.radius_m += force / patch.load_N * (row.p_W - patch.place.centre_W).norm();
  });
}

/// Finds the patches whose cone pushed in the last frame, that do not push by themselves, and that touch.
void Friction::find_last_pushing(const RowsInProblem& contacts, const FrictionAnchors& anchors,
                                 std::span<const Pose> X_WB) noexcept {
  const Index pushing = patches_.size();
  std::array<int, kMostPatches> rolling{};  // rows that roll
  for (const ContactRow& row : contacts.rows) {
    if (!(row.friction > 0.0) || gap_beyond(row.distance, row.skin_m) > 0.0) continue;
    FrictionPatch* found = patch_of(row.friction_surfaces());
    if (found == nullptr) {
      const FrictionAnchor* const last = anchors.find(row.friction_surfaces());
      if (last == nullptr || !last->pushed) continue;
      FrictionPatch patch;
      patch.surfaces = row.friction_surfaces();
      patch.coefficient = row.friction;
      patch.place.skin_m = row.skin_m;
      patch.place.centre_W = X_WB[Index(last->surfaces.body_a)] * last->centre_A;
      patch.place.radius_m = last->radius_m;
      if (!patches_.push_back(patch)) {
        no_room_ = true;
        break;
      }
      found = &patches_.back();
    } else if (found < patches_.begin() + pushing) {
      continue;
    }
    if (row.rolls) {  // it is where it touches now
      Vec3& centre = found->place.centre_W;
      const int count = ++rolling[static_cast<Index>(found - patches_.begin())];
      centre = count == 1 ? row.p_W : Vec3(centre + (row.p_W - centre) / count);
      found->rolls = true;
    }
    found->source_patch = row.patch;
    found->place.n_BA_W += row.n_BA_W;
  }
  for (Index i = pushing; i < patches_.size(); ++i) patches_[i].place.n_BA_W.normalize();
}

/// How far the turn in the bodies' targets takes the patch apart over the step, about the middle of all
/// patches on the body [m]; negative: the turn squeezes it.
double Friction::taken_off(const FrictionPatch& patch, const ContactProblem& problem) const noexcept {
  double off = 0.0;
  for (const int body : {patch.surfaces.body_a, patch.surfaces.body_b}) {
    const Vec3 turn = problem.target_turn(body);
    if (turn.isZero(0.0)) continue;
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const FrictionPatch& other : patches_) {
      if (other.surfaces.body_a != body && other.surfaces.body_b != body) continue;
      sum += other.place.centre_W;
      ++count;
    }
    const double rate = patch.place.n_BA_W.dot(turn.cross(patch.place.centre_W - sum / count));
    off += body == patch.surfaces.body_a ? rate : -rate;
  }
  return off;
}

/// Removes the patches that only pushed in the last frame and that the turn in the targets takes apart.
/// Without a turn they stay.
void Friction::drop_unsqueezed(const ContactProblem& problem) noexcept {
  std::array<bool, kMostPatches> stays{};
  for (Index i = 0; i < patches_.size(); ++i)
    stays[i] = patches_[i].load_N > 0.0 || !(taken_off(patches_[i], problem) > 0.0);
  Index kept = 0;
  for (Index i = 0; i < patches_.size(); ++i)
    if (stays[i]) patches_[kept++] = patches_[i];
  while (patches_.size() > kept) patches_.pop_back();
}

bool Friction::begin(const RowsInProblem& contacts, std::span<const Pose> X_WB,
                     const FrictionAnchors& anchors, ContactProblem& problem) noexcept {
  clear();
  if (std::none_of(contacts.rows.begin(), contacts.rows.end(), has_friction)) return false;
  find_pushing(contacts, problem);
  find_last_pushing(contacts, anchors, X_WB);
  drop_unsqueezed(problem);
  for (FrictionPatch& patch : patches_) {
    if (const FrictionAnchor* const last = take_anchor(anchors, X_WB, patch))
      patch.rows.sticking = last->sticking;
    patch.motion = motion_of(patch, any_orthogonal(patch.place.n_BA_W), problem);
    const Vec3 displacement = slide_of(patch, problem).displacement;
    if (const double length = displacement.norm(); length > 0.0)
      turn_directions(displacement / length, patch.motion);
    patch.rows.first = problem.add_cone(cone_now(patch));
  }
  return acts();
}

/// The cone of a patch, with the offsets of its edges.
QpCone Friction::cone_now(const FrictionPatch& patch) noexcept {
  QpCone cone = cone_of(patch);
  const double slip = patch.coefficient * patch.slip.displacement_m;
  const double turn = patch.coefficient * patch.place.radius_m * patch.slip.turn_rad;
  for (Index k = 0; k < kRowsAPatch; ++k)
    cone.more[k] = -patch.place.gap_m - allowance(patch, k) - (k < kDirections ? slip : turn);
  return cone;
}

FrictionPatch* Friction::patch_of_row(Index row) noexcept {
  const auto found = std::find_if(patches_.begin(), patches_.end(), [&](const FrictionPatch& patch) {
    return row >= patch.rows.first && row < patch.rows.first + kRowsAPatch;
  });
  return found == patches_.end() ? nullptr : found;
}

void Friction::rows_that_stuck(StaticVector<int, kMostUnknowns>& rows) const noexcept {
  for (const FrictionPatch& patch : patches_)
    for (Index k = 0; k < kRowsAPatch; ++k)
      if ((patch.rows.sticking >> k & 1u) != 0) rows.push_back(static_cast<int>(patch.rows.first + k));
}

void Friction::note_sticking(const ContactProblem& problem) noexcept {
  for (FrictionPatch& patch : patches_) patch.rows.sticking = 0;
  for (const QpActive& active : problem.answer().active) {
    const Index row = Index(active.row);
    if (FrictionPatch* const patch = patch_of_row(row))
      patch->rows.sticking |= 1u << (row - patch->rows.first);
  }
}

/// Relaxes the cone's rows so far that every displacement satisfies them.
void Friction::release_cone(const FrictionPatch& patch, ContactProblem& problem) noexcept {
  constexpr double kAnywhere_m = 1e3;  // [m]
  QpCone cone = cone_now(patch);
  for (double& more : cone.more) more -= kAnywhere_m;
  problem.set_cone(patch.rows.first, cone);
}

void Friction::release(FrictionPatch& patch, ContactProblem& problem) noexcept {
  release_cone(patch, problem);
  patch.acts = false;
}

/// The forces of the cone and the corners of a patch in the last answer.
Friction::Loads Friction::loads_of(const FrictionPatch& patch, const RowsInProblem& contacts,
                                   const ContactProblem& problem) noexcept {
  Loads loads;
  for (const QpActive& active : problem.answer().active) {
    const Index row = Index(active.row);
    const ContactRow* const contact = contacts.row(active.row);
    if (row >= patch.rows.first && row < patch.rows.first + kRowsAPatch) {
      const Push push = cone_edge(patch, row - patch.rows.first);
      loads.cone_N += active.multiplier;
      loads.cone_force += active.multiplier * (push.force - patch.place.n_BA_W);
      loads.cone_torque += active.multiplier * push.torque;
    } else if (contact != nullptr && contact->friction_surfaces() == patch.surfaces) {
      loads.corners_N += active.multiplier;
    }
  }
  return loads;
}

/// A patch that slides without lifting (towards a wall that it has not met) needs no slip: in a wedged part,
/// every slip would lead to another, and the room for motion in such gaps would grow without bound near the
/// limit of wedging.
bool Friction::update_slip(ContactProblem& problem) noexcept {
  bool changed = false;
  for (FrictionPatch& patch : patches_) {
    if (!patch.acts || patch.sliding.acts) continue;
    const Slide slide = slide_of(patch, problem);
    const double arm = patch.coefficient * patch.place.radius_m;
    double further =
        std::min(slide.lift, patch.coefficient * (slide.displacement.norm() - patch.slip.displacement_m));
    double turned = std::min(slide.lift, arm * (std::abs(slide.turn) - patch.slip.turn_rad));
    if (further <= settled_length(patch.place.skin_m)) further = 0.0;
    if (turned <= settled_length(patch.place.skin_m)) turned = 0.0;
    if (further == 0.0 && turned == 0.0) continue;
    changed = true;
    if (patch.load_N == 0.0) {
      release(patch, problem);
      continue;
    }
    patch.slip.displacement_m += further / patch.coefficient;
    if (turned > 0.0) patch.slip.turn_rad += turned / arm;
    problem.set_cone(patch.rows.first, cone_now(patch));
  }
  return changed;
}

void Friction::set_load(const SlidingForce& force, FrictionPatch& patch, ContactProblem& problem) noexcept {
  const Vec3 more = force.force_W - patch.sliding.force_W;
  problem.add_load(patch.motion.along, more.dot(patch.motion.along_W));
  problem.add_load(patch.motion.across, more.dot(patch.motion.across_W));
  problem.add_load(patch.motion.about, force.torque_Nm - patch.sliding.torque_Nm);
  patch.sliding = force;
}

/// Removes the load of a patch: it sticks, or slips by what its cone allows, as before.
void Friction::refuse_load(FrictionPatch& patch, ContactProblem& problem) noexcept {
  set_load({}, patch, problem);
  problem.set_cone(patch.rows.first, cone_now(patch));
}

/// How stiffly a patch's bodies resist its friction: the smaller of the stiffnesses along the surface and, at
/// the patch's radius, about its normal [N/m]; zero where nothing gives way. (In the solvers `give` is the
/// inverse of it, a compliance.)
double Friction::give_of(const FrictionPatch& patch) noexcept {
  const double along = std::max(mobility(patch.motion.along), mobility(patch.motion.across));
  const double about = patch.place.radius_m * patch.place.radius_m * mobility(patch.motion.about);
  const double most = std::max(along, about);
  return most > 0.0 ? 1.0 / most : 0.0;
}

/// The next force of sliding friction, from the last one and the slide in its answer: less the slide times
/// the stiffness, then within mu N, which force and torque use up together as on an area all of whose points
/// slide, an ellipse [Howe and Cutkosky 1996]. Where it no longer changes, it is mu N against the slide, or
/// less and nothing slides.
SlidingForce Friction::next_force(const FrictionPatch& patch, const SlidingForce& last, double most_N,
                                  const ContactProblem& problem) const noexcept {
  const double give = give_of(patch);
  const double r = patch.place.radius_m;
  SlidingForce next{.acts = true};
  const Slide slide = slide_of(patch, problem);  // from the anchor: a sticking patch goes back to it
  next.force_W = last.force_W - give * slide.displacement;
  next.torque_Nm = last.torque_Nm - give * r * r * slide.turn;
  const double size = r > 0.0 ? std::hypot(next.force_W.norm(), next.torque_Nm / r) : next.force_W.norm();
  // At the bound the patch may still be coming to rest: a slide too small to count is none.
  next.sticks = size < most_N ||
                slide.displacement.norm() + r * std::abs(slide.turn) <= settled_length(patch.place.skin_m);
  if (size > most_N) {
    const double share = size > 0.0 ? most_N / size : 0.0;
    next.force_W *= share;
    next.torque_Nm *= share;
  }
  return next;
}

bool Friction::update_sliding(const RowsInProblem& contacts, ContactProblem& problem) noexcept {
  bool changed = false;
  for (FrictionPatch& patch : patches_) {
    if (!patch.acts || !patch.slip.any()) continue;
    const Loads loads = loads_of(patch, contacts, problem);
    const double most_N = patch.coefficient * (loads.cone_N + loads.corners_N);
    SlidingForce last = patch.sliding;
    if (!last.acts) {  // the cone's force, which is inside the ellipse
      last.force_W = loads.cone_force;
      last.torque_Nm = loads.cone_torque.dot(patch.place.n_BA_W);
    }
    const SlidingForce next = next_force(patch, last, most_N, problem);
    const double arm = patch.place.radius_m > 0.0 ? 1.0 / patch.place.radius_m : 0.0;
    const double difference =
        (next.force_W - last.force_W).norm() + arm * std::abs(next.torque_Nm - last.torque_Nm);
    if (patch.sliding.acts && difference <= tolerances::kSameFriction * most_N) continue;
    if (!patch.sliding.acts) release_cone(patch, problem);
    set_load(next, patch, problem);
    changed = true;
  }
  return changed;
}

void Friction::refuse_loads(ContactProblem& problem) noexcept {
  for (FrictionPatch& patch : patches_)
    if (patch.sliding.acts) refuse_load(patch, problem);
}

void Friction::forget_anchors(ContactProblem& problem) noexcept {
  for (FrictionPatch& patch : patches_) {
    if (!patch.acts) continue;
    patch.anchor.apart_W.setZero();
    patch.anchor.used = false;
    if (!patch.sliding.acts) problem.set_cone(patch.rows.first, cone_now(patch));
  }
}

void Friction::end(const RowsInProblem& contacts, const ContactProblem& problem, std::span<const Pose> X_WB,
                   FrictionAnchors& anchors) const noexcept {
  if (acts()) anchor_patches(contacts, problem, X_WB, anchors);
  note_pressed(contacts, problem, X_WB, anchors);
}

/// Anchors every patch at the centre of its forces.
void Friction::anchor_patches(const RowsInProblem& contacts, const ContactProblem& problem,
                              std::span<const Pose> X_WB, FrictionAnchors& anchors) const noexcept {
  UnknownChange cones{};  // by the normal forces of the cones
  for (const FrictionPatch& patch : patches_)
    push(patch.motion.off, loads_of(patch, contacts, problem).cone_N, cones.data());
  EvenLoads even;
  const bool all = find_even_loads(contacts, problem, cones, even);
  for (const FrictionPatch& patch : patches_) {
    if (!patch.acts) continue;
    // The centre of all forces of the patch: its corners', and the cone's at the centre so far.
    const Loads loads = loads_of(patch, contacts, problem);
    const double load = loads.cone_N + loads.corners_N;
    double sum_N = all ? 0.0 : loads.cone_N;
    Vec3 moment = sum_N * patch.place.centre_W;
    for (Index i = 0; i < even.rows.size(); ++i) {
      const ContactRow& row = contacts.rows[Index(even.rows[i])];
      if (!(row.friction_surfaces() == patch.surfaces)) continue;
      sum_N += even.force_N[i];
      moment += even.force_N[i] * row.p_W;
    }
    const Vec3 centre = sum_N > 0.0 ? Vec3(moment / sum_N) : patch.place.centre_W;
    const bool pushed = loads.cone_N > 0.0 || (patch.sliding.acts && load > 0.0);
    anchors.add(next_anchor(patch, centre, pushed, X_WB, problem));
  }
}

/// Anchors the planes that push in the last answer only because there was friction elsewhere, as a ladder's
/// wall does: they have a patch from the next frame on.
void Friction::note_pressed(const RowsInProblem& contacts, const ContactProblem& problem,
                            std::span<const Pose> X_WB, FrictionAnchors& anchors) const noexcept {
  for (const QpActive& active : problem.answer().active) {
    const ContactRow* const row = contacts.row(active.row);
    if (row == nullptr || !(active.multiplier > 0.0) || !has_friction(*row)) continue;
    const SurfacePair& on = row->friction_surfaces();
    if (std::any_of(patches_.begin(), patches_.end(),
                    [&](const FrictionPatch& patch) { return patch.surfaces == on; }))
      continue;
    const Pose& X_WA = X_WB[Index(on.body_a)];
    const Vec3 at_A = X_WA.inverse() * row->p_W;
    anchors.add({.surfaces = on,
                 .n_A = rotated_back(X_WA.R, row->n_BA_W),
                 .on_A = at_A,
                 .on_B = X_WB[Index(on.body_b)].inverse() * row->p_W,
                 .centre_A = at_A,
                 .pushed = true,
                 .slid = true});
  }
}

}  // namespace tactum::inline v0_1
