#pragma once
/// Limits and fits by name: how far a hole's and a shaft's size may lie from the nominal one
/// [ISO 2010, 286-1 and 286-2].
///
///      hole "H7"                     shaft "g6"          A letter says where the tolerance zone begins (its
///                   upper ______                         fundamental deviation, capital letters for holes),
///                        |//////|                        a number how wide it is (its grade). A fit names
///     nominal ___________|//////|___ lower ________      both, the hole first: "H7/g6".
///                              upper ______
///                                   |//////|             Sizes 1 to 500 mm, grades 5 to 13,
///                              lower|//////|             holes D E F G H JS K M N P, shafts d e f g h js k
///                                                        m n p r s.
///
/// Read from the standard's rounded tables, not from its formulas. Set-up only.

#include <string>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// Deviations from the nominal size.
struct SizeLimits {
  double lower_m = 0.0;  ///< [m]
  double upper_m = 0.0;  ///< [m]

  double middle_m() const { return 0.5 * (lower_m + upper_m); }
};

/// Where within their zones hole and shaft lie: as near to each other as the fit allows, in the middle, or as
/// far apart.
enum class FitPosition { kMinClearance, kMid, kMaxClearance };

struct Fit {
  SizeLimits hole;
  SizeLimits shaft;

  /// Deviation from the nominal size at a position of the zone [m].
  double hole_m(FitPosition position) const;
  double shaft_m(FitPosition position) const;
  /// Hole less shaft; negative where the shaft is the larger [m].
  double clearance_m(FitPosition position) const { return hole_m(position) - shaft_m(position); }
};

/// The zone of one tolerance class, "H7" (a hole) or "g6" (a shaft), at a nominal size. An error names the
/// part of the name or the size that is not in the table.
Result<SizeLimits> iso_limits(const std::string& name, double nominal_m);

/// The zones of a fit, "H7/g6": the hole's class first.
Result<Fit> iso_fit(const std::string& name, double nominal_m);

}  // namespace tactum::inline v0_1
