#pragma once
/// From contact patches to the rows of the contact problem: which points push, in which direction, how
/// stiffly.
///
/// A patch pushes with the paper's k_s as a whole, divided among its points by their weights (quadrature of
/// the area, see collision/manifold.h). Pieces may be triangles, or cuts, of larger facets, so patches on the
/// same facet are one patch: their points are weighted by area and reduced to four that carry the same area
/// integrals (mean, second moments, and the gap as a linear function). A wall feels the same however finely
/// it was meshed or cut.

#include <vector>

#include "tactum/base/reserved_vector.h"
#include "tactum/contact/contact_patch.h"
#include "tactum/contact/shading.h"
#include "tactum/dynamics/friction_patch.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// One point of a facet: a row in the making.
struct FacetPoint {
  Vec3 p_W = Vec3::Zero();     ///< [m]
  Vec3 n_BA_W = Vec3::Zero();  ///< unit [-]
  double distance = 0.0;       ///< [m]
  double weight = 0.0;         ///< fraction of the facet's stiffness; they add up to one [-]
};

/// Rows and scratch, allocated at load time.
struct ContactRows {
  ContactRows(std::size_t patches, std::size_t most_rows) {
    facets.reserve(patches);
    points.reserve(patches * 4);
    rows.reserve(most_rows);
  }
  /// The facet a patch lies on, as a sort key, and the patch.
  struct Facet {
    int body_a, body_b, group_a, group_b, patch;
  };
  ReservedVector<Facet> facets;
  ReservedVector<FacetPoint> points;  // of one facet
  ReservedVector<ContactRow> rows;
  bool full = false;  ///< points were dropped

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.rows, self.full);
  }
};

/// The contacts from which rows are made.
struct ContactSource {
  std::span<const Pose> X_WB;                  ///< of the bodies [m]
  std::span<const ContactPatch> patches;       ///< found there
  std::span<const char> of_bodies;             ///< by body: only patches of these become rows; empty: all
  const std::vector<ShadingNormals>& shading;  ///< one per body; empty: normals without shading
  std::span<const double> depth_scale;  ///< by patch: factor for the depth of points that overlap; empty: 1
};

/// Fills `out.rows`.
void make_contact_rows(const ContactSource& from, double stiffness_N_per_m, ContactRows& out) noexcept;

/// Appends the friction force on A of a patch [N] as a contact row, whose normal is the direction of the
/// force and whose impulse is that of `h` seconds, as far as there is room. `number` is
/// ContactRow::friction_patch.
void append_friction(const FrictionPatch& patch, int number, const Vec3& force_W, double h,
                     std::vector<ContactRow>& rows) noexcept;

/// The sum of the contact forces on `body`, stated at `p_WB`, axes of W, T = sum R_i x F_i [Gregory 2000,
/// 5.1], from rows whose impulses were given over `h` seconds; zero where `h` is.
Wrench contact_wrench(std::span<const ContactRow> rows, int body, const Vec3& p_WB, double h) noexcept;

}  // namespace tactum::inline v0_1
