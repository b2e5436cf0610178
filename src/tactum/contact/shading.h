#pragma once
/// Force shading: over facets that approximate a curved surface the direction of the force is interpolated
/// from normals at the corners, as light is in Phong shading, so that a faceted cylinder feels round [Gregory
/// 2000, 5.3; Ruspini 1997].
///
/// A corner's normal on a face is the mean of the normals of the faces around the corner that meet that face
/// at less than the crease angle; at a sharp edge it is the face's own. Inside a face, Wachspress coordinates
/// of the polygon weight the corners: linear on its edges, so that the direction is continuous from face to
/// face. Faces and those around a corner are the part's true ones: a face that was cut into pieces is shaded
/// as one, unless its union is not convex; then stretch by stretch.

#include <array>
#include <span>
#include <vector>

#include "tactum/contact/contact_patch.h"
#include "tactum/geometry/part.h"

namespace tactum::inline v0_1 {

/// A corner of a face, as Wachspress coordinates need it. A ruled face has two of them instead, one for each
/// of its two curved sides: the side's normal, and the side across.
struct ShadedCorner {
  Vec3 weighted = Vec3::Zero();  ///< the surface's normal, times twice the triangle of its neighbours [m^2]
  // Twice the area of the side to the next corner with a point p is  inward . p - offset.
  Vec3 inward = Vec3::Zero();  ///< square to the side, in the face, as long as the side [m]
  double offset = 0.0;         ///< part's frame [m^2]
};

/// A true face. Without corners its normals do not deviate.
struct ShadedFace {
  Vec3 normal = Vec3::Zero();  ///< unit [-]
  int first = 0, count = 0;    ///< of its corners, counter-clockwise; two of a ruled face
};

class ShadingNormals {
 public:
  /// Cost: once per part, linear in its corners.
  ShadingNormals(const Part& part, double crease_rad);

  /// Whether any normal of the part deviates.
  bool bends() const noexcept { return !corners_.empty() || !triangle_normals_.empty(); }
  /// The face that a feature of a piece is, where its normals deviate; null for other features and for faces
  /// whose edges are all sharp.
  const ShadedFace* bent_face(int piece, const Feature& feature) const noexcept;
  /// How much the interpolated normal at `point` (part's frame) differs from a bent face's own.
  Vec3 deviation(const ShadedFace& face, const Vec3& point) const noexcept;
  /// The same, zero where nothing is bent.
  Vec3 deviation(int piece, const Feature& feature, const Vec3& point) const noexcept;
  /// The same for a feature of the part's surface (surface_tree.h).
  Vec3 deviation_on_surface(const Feature& feature, const Vec3& point) const noexcept;

 private:
  void shade_pieces(double cosine);
  void shade_surface(double cosine);

  const Part* part_;
  std::vector<int> first_face_;  // per piece, into face_of_
  std::vector<int> face_of_;     // per piece and face, into faces_
  std::vector<ShadedFace> faces_;
  std::vector<ShadedCorner> corners_;
  std::vector<std::array<Vec3, 3>>
      triangle_normals_;  // at the corners of the surface's triangles; empty: flat
};

/// At the first of the patch's points, as many as there is room for: the patch's normal, turned by the
/// deviations of the faces it lies on, in A's frame. X_AB is the pose of body B in A and X_BA its inverse.
void shaded_normals(const ShadingNormals& a, const ShadingNormals& b, const Pose& X_AB, const Pose& X_BA,
                    const ContactPatch& patch, std::span<Vec3> normals) noexcept;

}  // namespace tactum::inline v0_1
