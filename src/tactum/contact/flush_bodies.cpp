#include "tactum/contact/flush_bodies.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "tactum/contact/patch_corners.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Two contacts whose normals differ by less than the angle with this cosine carry the part together: neither
/// implies the other. About three degrees.
constexpr double kSameNormal = 0.9987;
/// A part may be so many times as deep beside the body it rests on as in it.
constexpr double kDeeperBeside = 2.0;
/// Of the planes on which surfaces rest on each other, so many of a body are looked at.
constexpr std::size_t kMostPlanes = 16;

int other_body(const ContactPatch& patch, int body) {
  return patch.body_a == body ? patch.body_b : patch.body_a;
}

/// A patch, seen from one of its two bodies, which rests on the other.
struct Resting {
  Resting(const ContactPatch& patch, int body, std::span<const Pose> X_WB)
      : is_a(patch.body_a == body), other(other_body(patch, body)) {
    const Pose& X_WA = X_WB[Index(patch.body_a)];
    const ContactPoint& point = patch.manifold.points[0];
    const Feature& on_other = is_a ? patch.manifold.b : patch.manifold.a;
    on_face = on_other.kind == FeatureKind::kFace;
    rolls_over = patch.round && !on_face;
    normal_W = is_a ? Vec3(X_WA.R * patch.manifold.normal) : Vec3(-(X_WA.R * patch.manifold.normal));
    p_W = X_WA * (is_a ? point.p_a : point.p_b);
    p_other_W = X_WA * (is_a ? point.p_b : point.p_a);
  }

  bool is_a;
  int other;        ///< the body it rests on
  bool on_face;     ///< it rests on a face of the other one
  bool rolls_over;  ///< a curved surface is near an edge or corner of the other one
  Vec3 normal_W;    ///< toward the body
  Vec3 p_W;         ///< the contact point on the body [m]
  Vec3 p_other_W;   ///< ... and on the other one [m]
};

/// The shape of a body at a contact: the whole piece, or, of a surface, the triangles at the feature.
struct TouchedShape {
  const Part& part;
  const Pose& X_WB;
  int piece;        ///< -1: of a surface
  Feature feature;  ///< of the surface

  /// Calls visit(vertex, body's frame) for each.
  template <class Visit>
  void for_each_vertex(const Visit& visit) const {
    if (piece >= 0) {
      for (const Vec3& vertex : part.pieces[Index(piece)].vertices) visit(vertex);
      return;
    }
    const SurfaceTree& tree = part.tree;
    const auto visit_number = [&](int vertex) {
      if (vertex >= 0) visit(tree.vertex(vertex));  // else the wall behind a rim
    };
    if (feature.kind == FeatureKind::kVertex) {
      visit_number(feature.index);
      for (const std::int32_t vertex : tree.around(feature.index)) visit_number(vertex);
      return;
    }
    const bool edge = feature.kind == FeatureKind::kEdge;
    for (const int vertex : tree.triangle(edge ? feature.index / 3 : feature.index)) visit_number(vertex);
    if (edge) visit_number(tree.beyond(feature.index));
  }
  /// The greatest n . p of its points [m].
  double highest(const Vec3& n_W) const {
    const Vec3 n_B = rotated_back(X_WB.R, n_W);
    double most = -std::numeric_limits<double>::infinity();
    if (piece >= 0) {
      const Polytope& convex = part.pieces[Index(piece)];
      most = n_B.dot(convex.vertices[Index(support_vertex(convex, n_B))]);
    } else {
      for_each_vertex([&](const Vec3& vertex) { most = std::max(most, n_B.dot(vertex)); });
    }
    return most + n_W.dot(X_WB.p);
  }
};

/// Whether the contact can be one of those that imply or are implied.
bool counts(const ContactPatch& patch) {
  const bool ball_on_surface = patch.round && patch.of_surfaces;  // the ball has no feature there
  return !patch.implied && !ball_on_surface && !patch.manifold.points.empty();
}

/// A plane  normal_W . p = height, with the normal toward the body that rests on it.
struct Plane {
  Vec3 normal_W;        ///< [-]
  double height = 0.0;  ///< [m]
};

/// The plane of the face on which the body rests; where it rests on an edge or corner, that of the contact.
/// The face is taken because the contact's normal may be that of the body's own face, which leans.
Plane plane_of(const ContactPatch& patch, const Resting& r, const TouchedShape& others) {
  const Plane of_contact{r.normal_W, r.normal_W.dot(r.p_other_W)};
  if (others.piece < 0) return of_contact;
  const Polytope& convex = others.part.pieces[Index(others.piece)];
  const Vec3 outward = rotated_back(others.X_WB.R, r.normal_W);
  const int face = reference_face(convex, r.is_a ? patch.manifold.b : patch.manifold.a, outward);
  if (!(convex.faces[face].normal.dot(outward) > kSameNormal)) return of_contact;
  const Vec3 normal_W = others.X_WB.R * convex.faces[face].normal;
  return {normal_W, convex.faces[face].offset + normal_W.dot(others.X_WB.p)};
}

/// The step that the piece of another body makes with the plane on which a body rests.
struct Step {
  Vec3 normal_W;          ///< of the plane
  double lowest = 0.0;    ///< of the resting body's piece along the normal [m]
  double top = 0.0;       ///< of the other body's piece [m]
  double ridden_m = 0.0;  ///< a step as high as this is ridden over [m]
};

/// Gives an implied contact the normal of the plane, and the points at which its body would meet the step:
/// where it is nearest, the lowest vertices that are no farther from there than the motion may lead, and
/// where the lines from the lowest of these to the others are as far.
void take_step(const Resting& implied, const Step& step, const TouchedShape& own, const Pose& X_WA,
               ContactPatch& patch) {
  const Vec3& n = step.normal_W;
  const auto add = [&](const Vec3& p_W) {
    const double distance = n.dot(p_W) - step.top;
    const Vec3 on_body = X_WA.inverse() * p_W;
    const Vec3 on_other = X_WA.inverse() * (p_W - distance * n);
    patch.manifold.points.push_back(
        {implied.is_a ? on_body : on_other, implied.is_a ? on_other : on_body, distance, 1.0, 0});
  };
  patch.manifold.normal = rotated_back(X_WA.R, implied.is_a ? n : Vec3(-n));
  // The features of surfaces stay: by them a gap is known again.
  if (!patch.of_surfaces) patch.manifold.a.kind = patch.manifold.b.kind = FeatureKind::kVertex;
  patch.manifold.points.clear();
  add(implied.p_W);
  const Vec3 away = (implied.normal_W - n * n.dot(implied.normal_W)).normalized();
  const auto farther = [&](const Vec3& p_W) { return away.dot(p_W - implied.p_W); };
  Vec3 lowest_W = implied.p_W;
  own.for_each_vertex([&](const Vec3& vertex) {
    const Vec3 p_W = own.X_WB * vertex;
    if (farther(p_W) > patch.tolerance || n.dot(p_W) > step.lowest + step.ridden_m) return;
    if (n.dot(p_W) < n.dot(lowest_W)) lowest_W = p_W;
    if (patch.manifold.points.size() < Manifold::kMostPoints) add(p_W);
  });
  // Of what is farther away the motion may lead so much over the step.
  own.for_each_vertex([&](const Vec3& vertex) {
    const Vec3 p_W = own.X_WB * vertex;
    if (!(farther(p_W) > patch.tolerance) || n.dot(p_W) > step.lowest + step.ridden_m) return;
    const double part = (patch.tolerance - farther(lowest_W)) / (farther(p_W) - farther(lowest_W));
    if (patch.manifold.points.size() < Manifold::kMostPoints) add(lowest_W + part * (p_W - lowest_W));
  });
}

/// Whether all patches are of one pair of bodies.
bool one_pair(std::span<const ContactPatch> patches) {
  return std::all_of(patches.begin(), patches.end(), [&](const ContactPatch& patch) {
    return patch.body_a == patches[0].body_a && patch.body_b == patches[0].body_b;
  });
}

/// Looks for contacts of one body that imply others of it.
struct OfBody {
  std::span<const CollisionBody> bodies;
  std::span<const Pose> X_WB;
  int body;

  /// What a body has at a contact, of which `is_a` states which side is the body's.
  TouchedShape touched_shape(int of, const ContactPatch& patch, bool is_a) const {
    return {*bodies[Index(of)].part, X_WB[Index(of)],
            patch.of_surfaces ? -1 : (is_a ? patch.piece_a : patch.piece_b),
            is_a ? patch.manifold.a : patch.manifold.b};
  }

  /// Makes the patch an implied one if the body, as it rests in `resting`, does not meet it.
  bool implies(const ContactPatch& resting, const Resting& r, const Resting& p, ContactPatch& patch) const {
    // A ball rolls over the edge of the next body without a step, however alike the normals are.
    const bool alike = r.normal_W.dot(p.normal_W) > kSameNormal;
    if (alike && !(r.on_face && p.rolls_over)) return false;
    const Plane plane = plane_of(resting, r, touched_shape(r.other, resting, !r.is_a));
    const TouchedShape own = touched_shape(body, patch, p.is_a);
    const Step step{plane.normal_W, -own.highest(-plane.normal_W),
                    touched_shape(p.other, patch, !p.is_a).highest(plane.normal_W),
                    kRiddenStep * bodies[Index(body)].part->size};
    if (step.top > plane.height + step.ridden_m) return false;
    // A part that has entered the body it rests on may lean, and is then deeper beside it.
    const double entered = kDeeperBeside * std::min(0.0, resting.distance);
    if (step.lowest < plane.height + entered - step.ridden_m) return false;
    take_step(p, step, own, X_WB[Index(patch.body_a)], patch);
    return true;
  }
};

}  // namespace

void FlushBodies::list_planes(std::span<const int> items, std::span<const ContactPatch> patches) noexcept {
  planes_.clear();
  Index of_surfaces = 0;
  const auto same = [&](const ContactPatch& patch, int item) {
    const ContactPatch& other = patches[Index(item / 2)];
    return other.of_surfaces && other.body_a == patch.body_a && other.body_b == patch.body_b &&
           other.facets.a == patch.facets.a && other.facets.b == patch.facets.b;
  };
  for (const int item : items) {
    const ContactPatch& patch = patches[Index(item / 2)];
    if (!counts(patch)) continue;
    if (patch.of_surfaces) {
      if (of_surfaces == kMostPlanes) continue;
      if (std::any_of(planes_.begin(), planes_.end(), [&](int j) { return same(patch, j); })) continue;
      ++of_surfaces;
    }
    planes_.push_back(item);
  }
}

void FlushBodies::mark_implied(std::span<const CollisionBody> bodies, std::span<const Pose> X_WB,
                               std::span<ContactPatch> patches) noexcept {
  if (one_pair(patches)) return;
  of_body_.set(bodies.size(), 2 * patches.size(), [&](Index i) {
    const ContactPatch& patch = patches[i / 2];
    const int body = i % 2 == 0 ? patch.body_a : patch.body_b;
    return bodies[Index(body)].moves ? body : -1;
  });
  for (Index i = 0; i < bodies.size(); ++i) {
    const int body = static_cast<int>(i);
    const std::span<const int> items = of_body_[i];
    const auto other_of = [&](int item) { return other_body(patches[Index(item / 2)], body); };
    if (std::all_of(items.begin(), items.end(), [&](int j) { return other_of(j) == other_of(items[0]); }))
      continue;
    const OfBody of_body{bodies, X_WB, body};
    list_planes(items, patches);
    for (const int item : items) {
      ContactPatch& patch = patches[Index(item / 2)];
      if (!counts(patch)) continue;
      const Resting p(patch, body, X_WB);
      patch.implied = std::any_of(planes_.begin(), planes_.end(), [&](int by) {
        const ContactPatch& resting = patches[Index(by / 2)];
        return other_of(by) != p.other && counts(resting) &&
               of_body.implies(resting, Resting(resting, body, X_WB), p, patch);
      });
    }
  }
}

}  // namespace tactum::inline v0_1
