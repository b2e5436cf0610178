#pragma once
/// Metric coarse threads M3 to M24: basic sizes [ISO 1998, 68-1; ISO 1993, 724], the usual hexagon bolts and
/// nuts [ISO 2014a, 4017; ISO 2012, 4032], and how far bolt and nut lie from the basic profile [ISO 2013,
/// 965-1].
///
///             P                        Both threads have one profile: flanks 60 degrees apart, a flat of P/8
///       |<--------->|                  at the major diameter d and of P/4 at the minor diameter d1. On the
///    d __          __  flat P/8        pitch diameter d2 ridge and groove are equally wide, P/2.
///   d2 /  \        /  \                                         H = sqrt(3)/2 P
///  d1 /    \______/    \  flat P/4     d2 = d - 3/4 H,  d1 = d - 5/4 H
///
/// A bolt's profile stands nearer to the axis than the basic one, a nut's farther off, each by half the
/// deviation of its pitch diameter. So the flanks of a nut that sits in the middle of its play are a quarter
/// of the deviations' difference apart, square to the flank.

#include <string>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// Dimensions of one size.
struct MetricScrew {
  std::string name;             ///< "M16"
  double major_m = 0.0;         ///< d [m]
  double pitch_m = 0.0;         ///< P [m]
  double across_flats_m = 0.0;  ///< of head and nut [m]
  double head_height_m = 0.0;   ///< [m]
  double nut_height_m = 0.0;    ///< [m]

  double pitch_diameter_m() const;  ///< d2 [m]
  double minor_m() const;           ///< d1 [m]
};

/// The size called by `name`: M3 M4 M5 M6 M8 M10 M12 M14 M16 M18 M20 M22 M24.
Result<MetricScrew> metric_screw(const std::string& name);

/// How far the pitch diameters of bolt and nut lie from the basic one.
struct ThreadFit {
  double bolt_m = 0.0;  ///< zero or negative [m]
  double nut_m = 0.0;   ///< zero or positive [m]

  /// Between flanks, square to them, of a nut in the middle of its play [m].
  double flank_clearance_m() const { return 0.25 * (nut_m - bolt_m); }
};

/// The middle of the tolerance zones of a class: "fine" (5H/4h), "medium" (6H/6g) or "coarse" (7H/8g, from M5
/// on). The wider tolerances of crests are left out: the whole profile moves with its pitch diameter.
Result<ThreadFit> thread_fit(const std::string& screw, const std::string& tolerance_class);

/// The fit that leaves `clearance_m` between the flanks, half of it from each part. 0 or more.
ThreadFit thread_fit_with(double clearance_m);

}  // namespace tactum::inline v0_1
