#pragma once
/// Motions from files. One body, for hands and replay:
///
///   time_s,px,py,pz,m00,m01,...,m22[,buttons]     header with these names, any order; m row-major
///   time_s,x,y,z,qw,qx,qy,qz[,buttons]            the same with a quaternion
///   t x y z qx qy qz qw                           no header, spaces: the TUM trajectory format
///
/// Two bodies, for distances along a motion:
///
///   frame,time_s,a_px,...,a_m22,b_px,...,b_m22    or o1_ and o2_ for a_ and b_
///
/// Columns with other names are ignored. A matrix within tolerances::kRotationExact of a rotation is taken as
/// one; within kRotationNear it is too, and the repair counted (files with six decimals); anything else is
/// refused, as it would stretch a part. Taken means: replaced by the nearest rotation, a change of rounding
/// only.

#include <cstdint>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/devices/hand_motion.h"
#include "tactum/math/pose.h"

namespace tactum::inline v0_1 {

/// Repairs made while reading, to be reported to the user.
struct MotionRepairs {
  std::size_t orthonormalized_rows = 0;  ///< rows with an orientation that was near a rotation, not exact
  double worst_deviation = 0.0;          ///< largest |R R^T - I| entry, or |1 - length| of a quaternion [-]

  /// "12 of 51 rows held rotations rounded by up to 3e-06; they were made orthonormal", or empty.
  std::string sentence(std::size_t rows) const;
};

/// A pose per time. Times increase strictly and start at zero (`start_time_s` was taken off).
struct Motion {
  std::vector<double> time_s;          ///< [s]
  std::vector<Pose> X;                 ///< [m]
  std::vector<std::uint32_t> buttons;  ///< zero when the file has none
  double start_time_s = 0.0;           ///< first time in the file [s]
  MotionRepairs repairs;
};

/// Two poses per row, as the file has them (lengths in the file's unit).
struct TwoBodyMotion {
  std::vector<std::int64_t> frame;
  std::vector<double> time_s;  ///< [s]
  std::vector<Pose> X_WA;
  std::vector<Pose> X_WB;
  MotionRepairs repairs;
};

Result<Motion> read_motion(const std::string& path);
Result<TwoBodyMotion> read_two_body_motion(const std::string& path);

/// The motion moved and scaled into a sphere of `radius_m` about the origin: a room-sized recording for a
/// desk-sized device. The centre of its bounding box goes to the origin; it is only ever made smaller;
/// orientations are relative to the first.
Motion fitted(const Motion& motion, double radius_m);

/// A recorded motion as a hand's intention: straight and by one rotation from row to row.
class RecordedMotion final : public HandMotion {
 public:
  explicit RecordedMotion(Motion motion) : motion_(std::move(motion)) {}
  HandState at(double time_s) const noexcept override;
  double duration_s() const noexcept override { return motion_.time_s.empty() ? 0.0 : motion_.time_s.back(); }

 private:
  Motion motion_;
};

}  // namespace tactum::inline v0_1
