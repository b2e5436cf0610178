#include "tactum/contact/flush_bodies.h"

#include <algorithm>

#include "tactum/contact/patch_corners.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Two contacts whose normals differ by less than the angle with this cosine carry the part together: neither
/// implies the other. About three degrees.
constexpr double kSameNormal = 0.9987;
/// A part may be so many times as deep beside the body it rests on as in it.
constexpr double kDeeperBeside = 2.0;

/// A patch, seen from one of its two bodies, which rests on the other.
struct Resting {
  Resting(const ContactPatch& patch, int body, std::span<const Pose> X_WB)
      : is_a(patch.body_a == body),
        other(is_a ? patch.body_b : patch.body_a),
        piece(is_a ? patch.piece_a : patch.piece_b),
        other_piece(is_a ? patch.piece_b : patch.piece_a) {
    const Pose& X_WA = X_WB[Index(patch.body_a)];
    const ContactPoint& point = patch.manifold.points[0];
    normal_W = is_a ? Vec3(X_WA.R * patch.manifold.normal) : Vec3(-(X_WA.R * patch.manifold.normal));
    p_W = X_WA * (is_a ? point.p_a : point.p_b);
    p_other_W = X_WA * (is_a ? point.p_b : point.p_a);
  }

  bool is_a;
  int other;        ///< the body it rests on
  int piece;        ///< of the body
  int other_piece;  ///< of the other one
  Vec3 normal_W;    ///< toward the body
  Vec3 p_W;         ///< the contact point on the body [m]
  Vec3 p_other_W;   ///< ... and on the other one [m]
};

/// The greatest n . p of the points of a piece [m].
double highest(const Polytope& piece, const Pose& X_WB, const Vec3& n_W) {
  const Vec3 n_B = rotated_back(X_WB.R, n_W);
  return n_B.dot(piece.vertices[Index(support_vertex(piece, n_B))]) + n_W.dot(X_WB.p);
}

/// Whether the contact can be one of those that imply or are implied.
bool counts(const ContactPatch& patch) {
  return !patch.of_surfaces && !patch.implied && !patch.manifold.points.empty();
}

/// The plane of the face on which the body rests; where it rests on an edge or corner, that of the contact.
/// The face is taken because the contact's normal may be that of the body's own face, which leans.
void plane_of(const ContactPatch& patch, const Resting& r, const Polytope& others, const Pose& X_WO,
              Vec3& normal_W, double& height) {
  normal_W = r.normal_W;
  height = normal_W.dot(r.p_other_W);
  const Vec3 outward = rotated_back(X_WO.R, r.normal_W);
  const int face = reference_face(others, r.is_a ? patch.manifold.b : patch.manifold.a, outward);
  if (!(others.faces[face].normal.dot(outward) > kSameNormal)) return;
  normal_W = X_WO.R * others.faces[face].normal;
  height = others.faces[face].offset + normal_W.dot(X_WO.p);
}

/// The plane of a contact, and the step that the other body's piece makes with it.
struct Plane {
  Vec3 normal_W;        ///< toward the body that rests
  double lowest = 0.0;  ///< of the body's piece along the normal [m]
  double top = 0.0;     ///< of the other body's piece [m]
  double step_m = 0.0;  ///< the step that is ridden over [m]
};

/// Gives an implied contact the normal of the plane, and the points at which its body would meet the step:
/// where it is nearest, and the lowest vertices that are no farther from there than the motion may lead.
void take_plane(const Resting& implied, const Plane& plane, const Polytope& own, const Pose& X_WS,
                const Pose& X_WA, ContactPatch& patch) {
  const Vec3& n = plane.normal_W;
  const auto add = [&](const Vec3& p_W) {
    const double distance = n.dot(p_W) - plane.top;
    const Vec3 on_body = X_WA.inverse() * p_W;
    const Vec3 on_other = X_WA.inverse() * (p_W - distance * n);
    patch.manifold.points.push_back(
        {implied.is_a ? on_body : on_other, implied.is_a ? on_other : on_body, distance, 1.0, 0});
  };
  patch.implied = true;
  patch.manifold.normal = rotated_back(X_WA.R, implied.is_a ? n : Vec3(-n));
  patch.manifold.a.kind = patch.manifold.b.kind = FeatureKind::kVertex;
  patch.manifold.points.clear();
  add(implied.p_W);
  const Vec3 away = implied.normal_W - n * n.dot(implied.normal_W);
  for (const Vec3& vertex : own.vertices) {
    const Vec3 p_W = X_WS * vertex;
    if (n.dot(p_W) > plane.lowest + plane.step_m) continue;
    if (away.dot(p_W - implied.p_W) > patch.tolerance * away.norm()) continue;
    if (patch.manifold.points.size() == Manifold::kMostPoints) break;
    add(p_W);
  }
}

/// Whether all patches are of one pair of bodies.
bool one_pair(std::span<const ContactPatch> patches) {
  return std::all_of(patches.begin(), patches.end(), [&](const ContactPatch& patch) {
    return patch.body_a == patches[0].body_a && patch.body_b == patches[0].body_b;
  });
}

}  // namespace

void FlushBodies::mark_implied(std::span<const CollisionBody> bodies, std::span<const Pose> X_WB,
                               std::span<ContactPatch> patches) noexcept {
  if (one_pair(patches)) return;
  of_body_.set(bodies.size(), 2 * patches.size(), [&](Index i) {
    const ContactPatch& patch = patches[i / 2];
    const int body = i % 2 == 0 ? patch.body_a : patch.body_b;
    return bodies[Index(body)].moves ? body : -1;
  });
  for (Index body = 0; body < bodies.size(); ++body) {
    const double step_m = kRiddenStep * bodies[body].part->size;
    for (const int item : of_body_[body]) {
      ContactPatch& patch = patches[Index(item / 2)];
      if (!counts(patch)) continue;
      const Resting p(patch, static_cast<int>(body), X_WB);
      const Polytope& own = bodies[body].part->pieces[Index(p.piece)];
      const Polytope& others = bodies[Index(p.other)].part->pieces[Index(p.other_piece)];
      for (const int by : of_body_[body]) {
        const ContactPatch& resting = patches[Index(by / 2)];
        if (!counts(resting)) continue;
        const Resting r(resting, static_cast<int>(body), X_WB);
        if (r.other == p.other || r.normal_W.dot(p.normal_W) > kSameNormal) continue;
        const Polytope& under = bodies[Index(r.other)].part->pieces[Index(r.other_piece)];
        Vec3 n_W;
        double height = 0.0;
        plane_of(resting, r, under, X_WB[Index(r.other)], n_W, height);
        const Plane plane{n_W, -highest(own, X_WB[body], -n_W), highest(others, X_WB[Index(p.other)], n_W),
                          step_m};
        if (plane.top > height + step_m) continue;
        // A part that has entered the body it rests on may lean, and is then deeper beside it.
        if (plane.lowest < height + kDeeperBeside * std::min(0.0, resting.distance) - step_m) continue;
        take_plane(p, plane, own, X_WB[body], X_WB[Index(patch.body_a)], patch);
        break;
      }
    }
  }
}

}  // namespace tactum::inline v0_1
