#include "tactum/response/constraint_rows.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "tactum/contact/patch_corners.h"
#include "tactum/response/constraint_trial.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// A curved surface that was put into another one, as one is whose facets were laid on a floor, rises out of
/// it by a skin in this time, too slowly to leave the floor.
constexpr double kRise_s = 1e-3;

/// A name that a row keeps from frame to frame while the pair's patch has as many corners. It is not always
/// the only one: bodies numbered from 64 on may share it with others, and so may the same features of several
/// pairs of bodies that meet by their surfaces. A row that is taken for another one makes a solution
/// begin less well, and may keep a gap below the skin for some frames longer.
std::uint64_t name_of(const ContactPatch& patch, Index corner) {
  if (patch.of_surfaces) return patch.manifold.points[0].id;
  const auto pieces =
      static_cast<std::uint64_t>(patch.piece_a) << 20 ^ static_cast<std::uint64_t>(patch.piece_b);
  const auto bodies =
      static_cast<std::uint64_t>(patch.body_a) << 6 ^ static_cast<std::uint64_t>(patch.body_b);
  return (bodies << 40 ^ pieces) << 8 ^ corner;
}

/// The surfaces that a patch lies on.
SurfacePair surfaces_of(const World& world, const ContactPatch& patch) noexcept {
  const Part& A = *world.bodies[Index(patch.body_a)].part;
  const Part& B = *world.bodies[Index(patch.body_b)].part;
  if (!patch.of_surfaces)
    return {patch.body_a, patch.body_b, A.groups.of_piece[Index(patch.piece_a)],
            B.groups.of_piece[Index(patch.piece_b)]};
  const bool face_a = patch.manifold.a.kind == FeatureKind::kFace;
  const bool face_b = patch.manifold.b.kind == FeatureKind::kFace;
  return {patch.body_a, patch.body_b, face_b && !face_a ? kAnyGroup : A.tree.group_of(patch.piece_a),
          face_a && !face_b ? kAnyGroup : B.tree.group_of(patch.piece_b)};
}

/// Whether a whole face of the body touches: a face beside the edge or corner that touches does not.
bool by_face(const Feature& on, bool beside) { return on.kind == FeatureKind::kFace && !beside; }

/// How the shading of the two bodies' faces bends a normal at a corner, A's frame. A single face decides
/// alone; of two curved faces each counts half, and a flat face against a curved one decides alone. A face
/// beside the edge that touches counts nothing, as the edge does.
Vec3 bend(const ShadingNormals& a, const ShadingNormals& b, const Pose& X_AB, const ContactPatch& patch,
          const PatchCorner& corner) {
  const auto deviation = [&](const ShadingNormals& shading, int piece, const Feature& on, bool beside,
                             const Vec3& p) -> Vec3 {
    if (beside) return Vec3::Zero();
    return patch.of_surfaces ? shading.deviation_on_surface(on, p) : shading.deviation(piece, on, p);
  };
  const Feature& on_a = patch.manifold.a;
  const Feature& on_b = patch.manifold.b;
  const Vec3 p_B = rotated_back(X_AB.R, corner.p_A - X_AB.p);
  const Vec3 by_a = deviation(a, patch.piece_a, on_a, patch.neighbour_face.a, corner.p_A);
  const Vec3 by_b = deviation(b, patch.piece_b, on_b, patch.neighbour_face.b, p_B);
  if (!by_face(on_a, patch.neighbour_face.a) || !by_face(on_b, patch.neighbour_face.b))
    return rotated(X_AB.R, by_b) - by_a;
  if (by_a.isZero(0.0) || by_b.isZero(0.0)) return Vec3::Zero();
  return 0.5 * (rotated(X_AB.R, by_b) - by_a);
}

/// Makes the rows of a patch: one per corner. `number` is that of the patch, `own` whether it belongs to the
/// grasped part's island.
struct RowMaker {
  ConstraintStep& step;

  void add(const ContactPatch& patch, int number, bool own) const noexcept {
    if (patch.manifold.points.empty() &&
        (patch.round || patch.manifold.a.index < 0 || patch.manifold.b.index < 0))
      return;  // only watched
    ConstraintState& c = step.own.constraint;
    ContactRows& out = step.own.contact_rows;
    const bool a_grasped = is_grasped(step, Index(patch.body_a));
    const bool b_grasped = is_grasped(step, Index(patch.body_b));
    const int other = a_grasped ? patch.body_b : b_grasped ? patch.body_a : -1;
    const Pose& X_WA = step.bodies.X_WB[Index(patch.body_a)];
    const Pose X_AB = relative_pose(X_WA, step.bodies.X_WB[Index(patch.body_b)]);
    PatchCorners corners;
    find_corners(patch, X_AB, other >= 0, corners);
    const Vec3 normal_W = X_WA.R * patch.manifold.normal;
    SurfacePair surfaces = surfaces_of(step.world, patch);
    surfaces.fixed_a = !step.world.bodies[Index(patch.body_a)].moves();
    surfaces.fixed_b = !step.world.bodies[Index(patch.body_b)].moves();
    // A grasped part has no impacts with bodies that are fixed, jointed or grasped too: there its coupling is
    // what bounces.
    const Islands& islands = step.own.free.islands;
    const bool struck = !patch.implied && (islands.moves(patch.body_a) || islands.moves(patch.body_b)) &&
                        (other < 0 || (step.world.bodies[Index(other)].joint.kind == JointKind::kFree &&
                                       !(a_grasped && b_grasped)));
    ContactRow row;  // what all corners have alike; the rest is set below
    static_cast<SurfacePair&>(row) = surfaces;
    row.patch = number;
    row.n_BA_W = normal_W;
    row.margin = patch.tolerance;
    row.skin_m = c.skin_of(patch);
    row.idle = patch.implied;
    row.rolls = patch.round && !patch.implied;
    row.friction = step.settings.friction.between(patch.body_a, patch.body_b);
    row.impact.restitution = step.settings.impacts.restitution.between(patch.body_a, patch.body_b);
    row.impact.enabled = struck;
    for (Index i = 0; i < corners.size(); ++i) {
      if (out.rows.size() == out.rows.capacity()) {
        out.full = true;
        return;
      }
      row.p_W = X_WA * corners[i].p_A;
      row.distance = corners[i].distance;
      row.asked = asked_of(row, c.opening_share);
      if (patch.round) row.asked = std::min(row.asked, row.skin_m * step.dt_s / kRise_s);
      row.state = c.rows.memory.recall(name_of(patch, i));
      out.rows.push_back(row);
      if (!own || step.shading.empty()) continue;
      if (patch.round) {
        c.rows.shaded.push_back(normal_W);
        continue;
      }
      const Vec3 bent =
          bend(step.shading[Index(patch.body_a)], step.shading[Index(patch.body_b)], X_AB, patch, corners[i]);
      c.rows.bent |= !bent.isZero(0.0);
      c.rows.shaded.push_back(bent.isZero(0.0) ? normal_W : Vec3((normal_W + X_WA.R * bent).normalized()));
    }
  }

 private:
  void find_corners(const ContactPatch& patch, const Pose& X_AB, bool of_grasped,
                    PatchCorners& corners) const noexcept {
    if (patch.of_surfaces || patch.implied || patch.round) {
      for (const ContactPoint& point : patch.manifold.points)
        corners.push_back({0.5 * (point.p_a + point.p_b), point.distance});
    } else {
      const Polytope& A = step.world.bodies[Index(patch.body_a)].part->pieces[Index(patch.piece_a)];
      const Polytope& B = step.world.bodies[Index(patch.body_b)].part->pieces[Index(patch.piece_b)];
      if (!of_grasped) {
        step.own.constraint.corner_memory.corners_of(A, B, X_AB, patch, corners);
      } else {  // a grasped part hardly ever lies still to the bit
        patch_corners(A, B, X_AB, patch.manifold, patch.distance, patch.tolerance, corners);
      }
    }
  }
};

/// The body of a row that moves where the other one is fixed; -1: both move.
int alone_moving(const ContactRow& row) noexcept {
  return row.fixed_a ? row.body_b : row.fixed_b ? row.body_a : -1;
}

/// Where fixed bodies leave a body less room than two skins, it is to stand in the middle: rows that both ask
/// for a skin would push against each other without end, and shoot the body out where their normals lean.
void share_room(std::span<ContactRow> rows, double opening_share) noexcept {
  constexpr double kTight = 0.5;      // of the skin
  constexpr double kOpposite = -0.9;  // cosine of two normals
  StaticVector<Index, 32> tight;
  for (Index r = 0; r < rows.size() && tight.size() < 32; ++r)
    if (!rows[r].idle && rows[r].distance < kTight * rows[r].skin_m && alone_moving(rows[r]) >= 0)
      tight.push_back(r);
  for (Index i = 0; i < tight.size(); ++i) {
    for (Index k = 0; k < i; ++k) {
      const ContactRow& p = rows[tight[i]];
      const ContactRow& q = rows[tight[k]];
      if (alone_moving(p) != alone_moving(q)) continue;
      const double cosine = p.n_BA_W.dot(q.n_BA_W) * (p.fixed_a == q.fixed_a ? 1.0 : -1.0);
      if (!(cosine < kOpposite)) continue;
      const double skin_m = std::max(0.5 * (p.distance + q.distance), 0.0);
      for (const Index r : {tight[i], tight[k]}) {
        rows[r].skin_m = std::min(rows[r].skin_m, skin_m);
        rows[r].asked = std::min(rows[r].asked, asked_of(rows[r], opening_share));
      }
    }
  }
}

}  // namespace

void make_corner_rows(ConstraintStep& step) noexcept {
  ConstraintState& c = step.own.constraint;
  ContactRows& out = step.own.contact_rows;
  out.rows.clear();
  out.full = false;
  c.rows.memory.begin();
  c.rows.shaded.clear();
  c.rows.shades = c.rows.bent = false;
  const std::span<const ContactPatch> patches = step.patches;
  const RowMaker maker{step};
  for (Index p = 0; p < patches.size() && !out.full && !step.grasped_yields; ++p)
    if (step.own.free.of_grasped(patches[p])) maker.add(patches[p], static_cast<int>(p), true);
  c.rows.own = out.rows.size();
  for (Index p = 0; p < patches.size() && !out.full; ++p)
    if (!step.own.free.of_grasped(patches[p])) maker.add(patches[p], static_cast<int>(p), false);
  c.rows.count = out.rows.size();
  share_room({out.rows.data() + c.rows.own, c.rows.count - c.rows.own}, c.opening_share);
  c.planes.find(out.rows);
}

std::span<ContactRow> own_rows(ConstraintStep& step) noexcept {
  return {step.own.contact_rows.rows.data(), step.own.constraint.rows.own};
}

std::size_t add_contact_rows(bool opening, ContactProblem& problem, ConstraintStep& step) noexcept {
  const Index first = problem.rows();
  for (ContactRow& row : own_rows(step)) {
    const double offset = row.idle ? kAsksNothing_m : row.skin_m - row.distance;
    row.asked = opening ? offset : std::min(0.0, offset);
    problem.add_row(row.body_a, row.body_b, push_of(row), row.asked);
  }
  CornerRows& corners = step.own.constraint.rows;
  corners.feedback.assign(corners.own, 0.0);
  return first;
}

void exchange_normals(ConstraintStep& step) noexcept {
  ConstraintState& c = step.own.constraint;
  for (Index r = 0; r < c.rows.shaded.size(); ++r)
    std::swap(c.rows.shaded[r], step.own.contact_rows.rows[r].n_BA_W);
}

double gap_at_trial(const ContactRow& row, const ConstraintStep& step) noexcept {
  const ConstraintState& c = step.own.constraint;
  const ContactPatch& patch = step.patches[Index(row.patch)];
  const auto carried = [&](int body, const Vec3& p_W) {
    const Pose& before = step.bodies.X_WB[Index(body)];
    return c.trial.X_WB[Index(body)] * rotated_back(before.R, p_W - before.p);
  };
  const bool on_a = by_face(patch.manifold.a, patch.neighbour_face.a);
  const bool on_b = by_face(patch.manifold.b, patch.neighbour_face.b);
  const int owner = on_a && !on_b ? row.body_a : row.body_b;
  const Vec3 half = 0.5 * row.distance * row.n_BA_W;
  const Vec3 normal =
      c.trial.X_WB[Index(owner)].R * rotated_back(step.bodies.X_WB[Index(owner)].R, row.n_BA_W);
  return normal.dot(carried(row.body_a, row.p_W + half) - carried(row.body_b, row.p_W - half));
}

double overstated_at_trial(std::span<const ContactRow> rows_of_patch, const ConstraintStep& step) noexcept {
  if (!known_at_trial(Index(rows_of_patch.front().patch), step)) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const ContactRow& row : rows_of_patch) least = std::min(least, gap_at_trial(row, step));
  return std::max(0.0, least - step.own.constraint.trial.gap[Index(rows_of_patch.front().patch)]);
}

void correct_rows(double share, ConstraintStep& step) noexcept {
  ConstraintState& c = step.own.constraint;
  ContactProblem& problem = c.step_problem();
  const Index first_row = c.rows.shades ? c.rows.first_of_positions : c.rows.first;
  const std::span<const ContactRow> rows = own_rows(step);
  for (Index first = 0, end = 0; first < rows.size(); first = end) {
    for (end = first + 1; end < rows.size() && rows[end].patch == rows[first].patch;) ++end;
    const double too_much = overstated_at_trial(rows.subspan(first, end - first), step);
    for (Index r = first; r < end; ++r) {
      if (rows[r].idle) {
        if (!closed_at_trial(Index(rows[r].patch), step)) continue;
        const double missing = lift_of(rows[r], share) - kAsksNothing_m;
        problem.tighten(first_row + r, missing - c.rows.feedback[r]);
        c.rows.feedback[r] = missing;
        continue;
      }
      const double linear = problem.opening(problem.row_of(rows[r].body_a, rows[r].body_b, push_of(rows[r])));
      const double gap = gap_at_trial(rows[r], step) - too_much;
      const double missing = (rows[r].distance + share * linear - gap) / share;
      problem.tighten(first_row + r, missing - c.rows.feedback[r]);
      c.rows.feedback[r] = missing;
    }
  }
}

}  // namespace tactum::inline v0_1
