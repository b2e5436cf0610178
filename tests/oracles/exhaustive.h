#pragma once
/// Referees for the contact core that share no code with it: every pair of features and every separating
/// axis, in long double, from nothing but the vertices and the loops of the faces.

#include <string>

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum::oracle {

/// Smallest distance between any two features (all corner-face and side-side pairs), of pieces that do not
/// overlap [m].
long double feature_distance(const Polytope& A, const Polytope& B, const Pose& X_AB);

/// The largest gap between support planes over all axes a pair can need: face normals, sides crossed with
/// sides, and the normals of sides in their faces. Positive: separated (a lower bound on the distance); else
/// minus the depth [m].
long double axes_separation(const Polytope& A, const Polytope& B, const Pose& X_AB);

/// distance when separated, minus the smallest depth when not [m].
long double signed_distance(const Polytope& A, const Polytope& B, const Pose& X_AB);

/// The gap between the support planes across unit `n` (from B to A), over all corners: a lower bound on the
/// signed distance [m].
long double support_gap(const Polytope& A, const Polytope& B, const Pose& X_AB, const Vec3& n);

/// Whether the solids share a point: a corner of one inside the other, or a side of one through a face of the
/// other? `margin` [m] is how deep it must be, so that the answer is sure.
bool surely_overlap(const Polytope& A, const Polytope& B, const Pose& X_AB, long double margin);

/// Holds an answer against contact.h by brute force: unit normal, p_a = p_b + n distance, the points on their
/// pieces, and no corner of either piece across its support plane. For a positive distance this proves it,
/// from both sides. Returns what is wrong, or nothing. `tolerance` in metres.
std::string complaint(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& answer,
                      double tolerance);

}  // namespace tactum::oracle
