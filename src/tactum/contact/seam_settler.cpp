#include "tactum/contact/seam_settler.h"

#include <algorithm>
#include <tuple>

#include "tactum/base/tolerances.h"
#include "tactum/collision/manifold.h"
#include "tactum/contact/patch_corners.h"
#include "tactum/contact/seams.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// A contact whose depth on the whole part exceeds so many times the depth on its pieces and of the
/// representatives together is searched for again: that depth probably goes through the whole piece.
constexpr double kFarDeeper = 2.0;

/// The candidates of two bodies.
class TwoBodies {
 public:
  TwoBodies(std::span<SeamCandidate*> candidates, const Pose& X_AB,
            std::vector<ContactPatch>& patches) noexcept
      : candidates_(candidates), X_AB_(X_AB), steady_(*candidates.front()->limits), patches_(patches) {}

  void settle() noexcept {
    for (SeamCandidate* candidate : candidates_)
      if (!candidate->settled && !candidate->internal) lead(*candidate);
    for (SeamCandidate* candidate : candidates_)
      if (!candidate->settled && !answered(*candidate)) find_again(*candidate);
    while (SeamCandidate* nearest = shallowest())
      if (!answered(*nearest) && find_beside_representatives(*nearest)) lead(*nearest);
    for (SeamCandidate* candidate : candidates_)
      if (!candidate->settled) *candidate->shown = {};
  }
  bool full() const noexcept { return full_; }

 private:
  /// Whether a representative covers the candidate, which is then settled.
  bool answered(SeamCandidate& candidate) noexcept {
    const PairView pair(candidate.a.polytope(), candidate.b.polytope(), X_AB_);
    for (const SeamCandidate* other : candidates_) {
      if (other->patch < 0) continue;
      const ContactPatch& patch = patches_[Index(other->patch)];
      if (!answered_by(pair, candidate.found, patch.manifold.normal, patch.distance)) continue;
      settle_as(candidate, *other);
      return true;
    }
    return false;
  }

  /// Finds an internal contact again on the whole part. Where there is none it may still be merged.
  void find_again(SeamCandidate& candidate) noexcept {
    candidate.on_pieces = candidate.found;
    const std::optional<PairDistance> depth = on_true_surface(candidate, 0.0);
    if (!depth || depth->distance >= candidate.margin) return;
    candidate.found = *depth;
    candidate.internal = false;
  }

  /// Searches again for a contact whose depth on the true surface is far greater than on its pieces and than
  /// that of the representatives. In a corner of two walls the deepest point of a contact with one lies
  /// inside the other, as deep as the penetration of that one, so the search goes that far beside the covered
  /// place. The depth on the pieces is taken where rounding leaves no true face or edge there, or where the
  /// contact is true in its middle. Returns false when nothing is in contact.
  bool find_beside_representatives(SeamCandidate& candidate) noexcept {
    const PairDistance& on_pieces = candidate.on_pieces;
    const double entered = deepest_representative();
    const double beside = candidate.margin + entered;
    const double likely = kFarDeeper * (beside - std::min(on_pieces.distance, 0.0));
    if (-candidate.found.distance > likely) {
      std::optional<PairDistance> near;
      if (entered > 0.0) near = on_true_surface(candidate, beside);
      if (near && -near->distance <= likely) {
        candidate.found = *near;
      } else if (on_pieces.distance < 0.0 &&
                 ((entered > 0.0 && touches_beside(candidate, beside)) || touches_in_the_middle(candidate))) {
        candidate.found = on_pieces;
      }
    }
    // Apart, and not over the face itself.
    candidate.internal = candidate.found.distance >= candidate.margin ||
                         (on_pieces.distance >= 0.0 && candidate.found.distance < 0.0);
    return !candidate.internal;
  }

  std::optional<PairDistance> on_true_surface(const SeamCandidate& candidate, double beside) const noexcept {
    return depth_on_true_surface(*candidate.a.part, candidate.a.piece, *candidate.b.part, candidate.b.piece,
                                 X_AB_, candidate.on_pieces, candidate.margin, beside);
  }

  /// Whether the answer is a true contact, or would be no farther than `beside` away.
  bool touches_beside(const SeamCandidate& candidate, double beside) const noexcept {
    return is_true_contact(*candidate.a.part, candidate.a.piece, *candidate.b.part, candidate.b.piece, X_AB_,
                           candidate.on_pieces, beside);
  }

  /// Whether a contact that is internal by its closest points, which of a flat contact may be any, is a true
  /// contact in the middle: in a corner that is penetrated in both directions each wall is covered by the
  /// other at its edge.
  bool touches_in_the_middle(const SeamCandidate& candidate) const noexcept {
    Manifold manifold;
    contact_manifold(candidate.a.polytope(), candidate.b.polytope(), X_AB_, candidate.on_pieces,
                     candidate.margin, manifold);
    const bool flat = manifold.a.kind == FeatureKind::kFace && manifold.b.kind == FeatureKind::kFace;
    return flat && is_true_stretch(candidate, manifold);
  }

  /// The depth of the deepest representative; 0 when none overlaps.
  double deepest_representative() const noexcept {
    double deepest = 0.0;
    for (const SeamCandidate* other : candidates_)
      if (other->patch >= 0) deepest = std::max(deepest, -patches_[Index(other->patch)].distance);
    return deepest;
  }

  SeamCandidate* shallowest() noexcept {
    SeamCandidate* best = nullptr;
    for (SeamCandidate* candidate : candidates_)
      if (!candidate->settled && !candidate->internal &&
          (best == nullptr || candidate->found.distance > best->found.distance))
        best = candidate;
    return best;
  }

  static void settle_as(SeamCandidate& candidate, const SeamCandidate& representative) noexcept {
    candidate.settled = true;
    *candidate.shown = *representative.shown;
  }

  ContactPatch* new_patch(const SeamCandidate& candidate) noexcept {
    if (patches_.size() == patches_.capacity()) {
      full_ = true;
      return nullptr;
    }
    ContactPatch& patch = patches_.emplace_back();
    patch.body_a = candidate.a.body;
    patch.body_b = candidate.b.body;
    patch.piece_a = candidate.a.piece;
    patch.piece_b = candidate.b.piece;
    patch.pair = candidate.pair;
    patch.tolerance = candidate.margin;
    return &patch;
  }

  /// Makes the patch of a true contact: its own stretch and those of the contacts merged with it, as one.
  void lead(SeamCandidate& nearest) noexcept {
    PairDistance shown = steady_depth(nearest.a.polytope(), nearest.b.polytope(), X_AB_, nearest.found,
                                      steady_, *nearest.shown);
    shown.a = true_feature(*nearest.a.part, nearest.a.piece, shown.a, shown.p_a, -shown.normal);
    shown.b = true_feature(*nearest.b.part, nearest.b.piece, shown.b,
                           rotated_back(X_AB_.R, shown.p_b - X_AB_.p), rotated_back(X_AB_.R, shown.normal));
    ContactPatch* patch = new_patch(nearest);
    if (patch == nullptr) {
      nearest.settled = true;
      return;
    }
    contact_manifold(nearest.a.polytope(), nearest.b.polytope(), X_AB_, shown, nearest.margin,
                     patch->manifold);
    patch->distance = shown.distance;
    PairDistance led = shown;
    SeamCandidate& representative = widest(nearest, shown, *patch, led);
    *representative.shown = *nearest.shown;
    patch->facets = {representative.a.part->groups.of_piece[Index(representative.a.piece)],
                     representative.b.part->groups.of_piece[Index(representative.b.piece)]};
    representative.patch = static_cast<int>(patches_.size()) - 1;
    for (SeamCandidate* own : {&nearest, &representative}) {
      own->settled = true;
      own->led_by = representative.patch;
    }
    stretches_.clear();
    for (SeamCandidate* other : candidates_)
      if (!other->settled && !follow(*other, representative, shown, *patch))
        share(*other, nearest, representative, patch->manifold);
    if (!stretches_.empty())
      contact_manifold_over(representative.a.polytope(), representative.b.polytope(), X_AB_, led,
                            representative.margin, {stretches_.begin(), stretches_.size()}, patch->manifold);
    steady_centroid(X_AB_, patch->manifold, steady_, *representative.shown);
    for (SeamCandidate* other : candidates_)
      if (other != &representative && other->led_by == representative.patch)
        remember(*other, representative, shown);
  }

  /// Gives `other` the representative's memory, unless the displayed depth would go through another wall for
  /// it.
  void remember(SeamCandidate& other, const SeamCandidate& representative,
                const PairDistance& shown) const noexcept {
    const PairView pair(other.a.polytope(), other.b.polytope(), X_AB_);
    int a = vertex_of(pair.A, other.found.a);
    int b = vertex_of(pair.B, other.found.b);
    const double likely = other.margin - std::min(shown.distance, 0.0);
    const bool through = -pair.separation(shown.normal, a, b) > kFarDeeper * likely;
    *other.shown = through ? SteadyContact{} : *representative.shown;
  }

  /// Where the nearest touches at a true edge or corner that other pieces have too, returns the candidate
  /// with the largest features square to the normal; puts its patch in place, and in `led` the contact on
  /// its features.
  SeamCandidate& widest(SeamCandidate& nearest, const PairDistance& shown, ContactPatch& patch,
                        PairDistance& led) noexcept {
    const auto size_of = [](const Manifold& manifold) {
      return static_cast<int>(manifold.a.kind) + static_cast<int>(manifold.b.kind);
    };
    SeamCandidate* best = &nearest;
    if (shown.a.kind == FeatureKind::kFace && shown.b.kind == FeatureKind::kFace) return *best;
    for (SeamCandidate* other : candidates_) {
      FeaturePair same;
      if (other->settled || other == &nearest || !same_features(shown.a, shown.b, nearest, *other, same))
        continue;
      const PairDistance mapped = on_features(shown, same);
      Manifold manifold;
      contact_manifold(other->a.polytope(), other->b.polytope(), X_AB_, mapped, other->margin, manifold);
      if (size_of(manifold) <= size_of(patch.manifold) || !is_true_stretch(*other, manifold)) continue;
      patch.manifold = manifold;
      patch.piece_a = other->a.piece;
      patch.piece_b = other->b.piece;
      patch.pair = other->pair;
      led = mapped;
      best = other;
    }
    return *best;
  }

  /// Finds the stretches that `other` has of features of `of`; false when it has none.
  static bool same_features(const Feature& a, const Feature& b, const SeamCandidate& of,
                            const SeamCandidate& other, FeaturePair& out) noexcept {
    out.a = same_feature(*other.a.part, of.a.piece, a, other.a.piece);
    if (out.a.index < 0) return false;
    out.b = same_feature(*other.b.part, of.b.piece, b, other.b.piece);
    return out.b.index >= 0;
  }
  static PairDistance on_features(const PairDistance& contact, const FeaturePair& features) noexcept {
    PairDistance out = contact;
    out.a = features.a;
    out.b = features.b;
    return out;
  }

  /// Whether a feature is the other one, or at its rim.
  static bool is_of(const Polytope& P, const Feature& feature, const Feature& whole) noexcept {
    if (feature == whole) return true;
    if (whole.kind == FeatureKind::kEdge) {
      const Polytope::Edge& edge = P.edges[whole.index];
      return feature.kind == FeatureKind::kVertex &&
             (feature.index == edge.tail || feature.index == edge.head);
    }
    if (whole.kind != FeatureKind::kFace || feature.kind == FeatureKind::kFace) return false;
    if (feature.kind == FeatureKind::kEdge)
      return P.edges[feature.index].left == whole.index || P.edges[feature.index].right == whole.index;
    const Polytope::Face& loop = P.faces[whole.index];
    const auto corners = P.face_vertices.begin() + loop.first;
    return std::find(corners, corners + loop.count, feature.index) != corners + loop.count;
  }

  /// Settles `other` when it touches where the nearest does and has nothing to add: on the same features,
  /// at a corner that both have, or at a corner of what the representative touches with.
  static void share(SeamCandidate& other, const SeamCandidate& nearest, const SeamCandidate& representative,
                    const Manifold& patch) noexcept {
    const double noise = tolerances::kCoplanarMeshOffset *
                         std::max(nearest.a.polytope().extent.size, nearest.b.polytope().extent.size);
    const bool same_place =
        (other.found.p_a - nearest.found.p_a).norm() <= noise &&
        (other.found.p_b - nearest.found.p_b).norm() <= noise &&
        (other.found.normal - nearest.found.normal).norm() <= tolerances::kCoplanarMeshSine;
    const auto on_same_features = [&] {
      FeaturePair same;
      return same_features(nearest.found.a, nearest.found.b, nearest, other, same) &&
             same.a == other.found.a && same.b == other.found.b;
    };
    const auto at_a_corner = [&] {
      FeaturePair same;
      return same_features(other.found.a, other.found.b, other, representative, same) &&
             is_of(representative.a.polytope(), same.a, patch.a) &&
             is_of(representative.b.polytope(), same.b, patch.b);
    };
    if (!same_place && !on_same_features() && !at_a_corner()) return;
    other.settled = true;
    other.led_by = representative.patch;
  }

  /// Merges the stretch that `other` has of the representative's contact; false when it has none.
  bool follow(SeamCandidate& other, const SeamCandidate& representative, const PairDistance& shown,
              const ContactPatch& patch) noexcept {
    FeaturePair same;
    if (!same_features(patch.manifold.a, patch.manifold.b, representative, other, same)) return false;
    other.settled = true;
    other.led_by = representative.patch;
    const PairDistance mapped = on_features(shown, same);
    Manifold own;
    contact_manifold(other.a.polytope(), other.b.polytope(), X_AB_, mapped, other.margin, own);
    if (own.points.size() > 1 && is_true_stretch(other, own) &&
        !stretches_.push_back({&other.a.polytope(), &other.b.polytope(), mapped.a, mapped.b}))
      full_ = true;
    return true;
  }

  /// Whether the middle of the patch is on the true surface of both parts.
  bool is_true_stretch(const SeamCandidate& candidate, const Manifold& manifold) const noexcept {
    PairDistance middle;
    middle.normal = manifold.normal;
    middle.a = manifold.a;
    middle.b = manifold.b;
    for (const ContactPoint& point : manifold.points) {
      middle.p_a += point.weight * point.p_a;
      middle.p_b += point.weight * point.p_b;
    }
    return is_true_contact(*candidate.a.part, candidate.a.piece, *candidate.b.part, candidate.b.piece, X_AB_,
                           middle);
  }

  std::span<SeamCandidate*> candidates_;
  const Pose& X_AB_;
  const SteadyLimits& steady_;
  std::vector<ContactPatch>& patches_;
  StaticVector<Stretch, 512> stretches_;  // of the patch being made
  bool full_ = false;
};

/// The stretch that a side has of the feature of `representative` on `of_piece`; where there is none, of the
/// reference face beside it, and then `beside` becomes true.
Feature stretch_of(const SeamCandidate::Side& side, int of_piece, const Feature& feature, const Vec3& outward,
                   bool& beside) noexcept {
  if (feature.kind != FeatureKind::kVertex) {
    const Feature same = same_feature(*side.part, of_piece, feature, side.piece);
    if (same.index >= 0 || feature.kind == FeatureKind::kFace) return same;
  }
  beside = true;
  const int face = reference_face(side.part->pieces[Index(of_piece)], feature, outward);
  return same_feature(*side.part, of_piece, {FeatureKind::kFace, face}, side.piece);
}

/// Gives the patch of an internal contact what its representative has there.
void take_from(const ContactPatch& representative, const SeamCandidate& candidate, const Pose& X_AB,
               ContactPatch& patch) noexcept {
  const Manifold& leading = representative.manifold;
  patch.manifold.points.clear();
  patch.manifold.normal = leading.normal;
  patch.manifold.a =
      stretch_of(candidate.a, representative.piece_a, leading.a, -leading.normal, patch.neighbour_face.a);
  patch.manifold.b = stretch_of(candidate.b, representative.piece_b, leading.b,
                                rotated_back(X_AB.R, leading.normal), patch.neighbour_face.b);
}

}  // namespace

bool settle_seams(std::span<SeamCandidate*> candidates, std::span<const Pose> X_WB,
                  std::vector<ContactPatch>& patches) noexcept {
  std::sort(candidates.begin(), candidates.end(), [](const SeamCandidate* p, const SeamCandidate* q) {
    return std::tie(p->a.body, p->b.body, p->internal, p->found.distance, p->a.piece, p->b.piece) <
           std::tie(q->a.body, q->b.body, q->internal, q->found.distance, q->a.piece, q->b.piece);
  });
  bool complete = true;
  for (auto first = candidates.begin(); first != candidates.end();) {
    const int a = (*first)->a.body;
    const int b = (*first)->b.body;
    const auto last = std::find_if(first, candidates.end(),
                                   [&](const SeamCandidate* c) { return c->a.body != a || c->b.body != b; });
    const Pose X_AB = relative_pose(X_WB[Index(a)], X_WB[Index(b)]);
    TwoBodies bodies({first, last}, X_AB, patches);
    bodies.settle();
    complete = complete && !bodies.full();
    first = last;
  }
  return complete;
}

void settle_closest_points(std::span<const SeamCandidate> candidates, std::span<const Pose> X_WB,
                           std::span<ContactPatch> patches) noexcept {
  for (const SeamCandidate& candidate : candidates) {
    const Pose X_AB = relative_pose(X_WB[Index(candidate.a.body)], X_WB[Index(candidate.b.body)]);
    const PairView pair(candidate.a.polytope(), candidate.b.polytope(), X_AB);
    auto internal = candidates.begin();  // in the order of their patches
    const auto representative = std::find_if(patches.begin(), patches.end(), [&](const ContactPatch& other) {
      if (internal != candidates.end() && &other == &patches[Index(internal->patch)]) {
        ++internal;
        return false;
      }
      return other.body_a == candidate.a.body && other.body_b == candidate.b.body &&
             answered_by(pair, candidate.found, other.manifold.normal, other.distance);
    });
    if (representative != patches.end())
      take_from(*representative, candidate, X_AB, patches[Index(candidate.patch)]);
  }
}

}  // namespace tactum::inline v0_1
