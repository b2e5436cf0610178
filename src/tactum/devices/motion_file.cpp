#include "tactum/devices/motion_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/devices/number_table.h"
#include "tactum/math/rotation.h"
#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using Row = std::span<const double>;

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

/// Where a pose stands in a row: three columns of the position, then nine or four of the orientation.
struct PoseColumns {
  std::array<int, 3> position{};
  std::array<int, 9> orientation{};
  bool quaternion = false;  // w, x, y, z in the first four
};

Result<int> needed(const NumberTable& table, const std::string& name) {
  const int column = table.column(name);
  if (column >= 0) return column;
  return Error{"missing column", "", "a column named '" + name + "'", table.path};
}

template <std::size_t N>
Result<void> find_columns(const NumberTable& table, const std::string& prefix,
                          const std::array<const char*, N>& names, int* columns) {
  for (std::size_t i = 0; i < N; ++i) {
    Result<int> column = needed(table, prefix + names[i]);
    if (!column) return column.error();
    columns[i] = *column;
  }
  return {};
}

constexpr std::array<const char*, 9> kMatrix = {"m00", "m01", "m02", "m10", "m11",
                                                "m12", "m20", "m21", "m22"};
constexpr std::array<const char*, 4> kQuaternion = {"qw", "qx", "qy", "qz"};
constexpr std::array<const char*, 3> kMatrixPosition = {"px", "py", "pz"};
constexpr std::array<const char*, 3> kQuaternionPosition = {"x", "y", "z"};

Result<PoseColumns> pose_columns(const NumberTable& table, const std::string& prefix) {
  PoseColumns columns;
  columns.quaternion = table.column(prefix + "qw") >= 0;
  Result<void> position = find_columns(
      table, prefix, columns.quaternion ? kQuaternionPosition : kMatrixPosition, columns.position.data());
  if (!position) return position.error();
  Result<void> orientation = columns.quaternion
                                 ? find_columns(table, prefix, kQuaternion, columns.orientation.data())
                                 : find_columns(table, prefix, kMatrix, columns.orientation.data());
  if (!orientation) return orientation.error();
  return columns;
}

/// A pose and how far its orientation was from exact.
struct ReadPose {
  Pose X;
  double deviation = 0.0;
};

Result<ReadPose> read_pose(const NumberTable& table, std::size_t i, const PoseColumns& columns) {
  const Row row = table.row(i);
  ReadPose read;
  for (int k = 0; k < 3; ++k) read.X.p[k] = row[columns.position[k]];
  const auto number = [&](int k) { return row[columns.orientation[k]]; };
  const std::string where = table.where(i, columns.orientation[0]);
  if (columns.quaternion) {
    const Quat q(number(0), number(1), number(2), number(3));
    read.deviation = std::abs(1.0 - q.norm());
    if (!(read.deviation <= tolerances::kQuaternionNear)) {
      return Error{"not a unit quaternion", "length " + std::to_string(q.norm()), "1", where};
    }
    read.X.R = q.normalized().toRotationMatrix();
    return read;
  }
  Mat3 M;
  for (int k = 0; k < 9; ++k) M(k / 3, k % 3) = number(k);
  const NearestRotation nearest = orthonormalized(M);
  if (!nearest.exists) {
    return Error{"not a rotation matrix", "a singular matrix or a reflection", "a rotation", where};
  }
  if (nearest.deviation > tolerances::kRotationNear) {
    return Error{"not a rotation matrix",
                 "R R^T differing from the identity by " + short_number(nearest.deviation),
                 "at most " + short_number(tolerances::kRotationNear), where};
  }
  read.X.R = nearest.R;
  read.deviation = nearest.deviation;
  return read;
}

void count_repair(double deviation, MotionRepairs& repairs) {
  if (deviation > tolerances::kRotationExact) ++repairs.orthonormalized_rows;
  repairs.worst_deviation = std::max(repairs.worst_deviation, deviation);
}

Result<std::uint32_t> read_buttons(const NumberTable& table, std::size_t i, int column) {
  if (column < 0) return 0u;
  const double value = table.row(i)[column];
  constexpr double kLargest = std::numeric_limits<std::uint32_t>::max();
  if (value >= 0.0 && value <= kLargest && value == std::floor(value))
    return static_cast<std::uint32_t>(value);
  return Error{"not a button mask", std::to_string(value), "a whole number", table.where(i, column)};
}

}  // namespace

std::string MotionRepairs::sentence(std::size_t rows) const {
  if (orthonormalized_rows == 0) return {};
  return std::to_string(orthonormalized_rows) + " of " + std::to_string(rows) +
         " rows held rotations rounded by up to " + short_number(worst_deviation) +
         "; they were made orthonormal";
}

Result<Motion> read_motion(const std::string& path) {
  Result<NumberTable> table = read_number_table(path, {"time_s", "x", "y", "z", "qx", "qy", "qz", "qw"});
  if (!table) return table.error();
  Result<int> time = needed(*table, "time_s");
  if (!time) return time.error();
  Result<PoseColumns> columns = pose_columns(*table, "");
  if (!columns) return columns.error();
  const int button_column = table->column("buttons");

  Motion motion;
  motion.start_time_s = table->row(0)[*time];
  for (std::size_t i = 0; i < table->rows(); ++i) {
    const double time_s = table->row(i)[*time] - motion.start_time_s;
    if (i > 0 && !(time_s > motion.time_s.back())) {
      return Error{"times must increase", std::to_string(table->row(i)[*time]) + " s",
                   "more than " + std::to_string(table->row(i - 1)[*time]) + " s", table->where(i, *time)};
    }
    Result<ReadPose> pose = read_pose(*table, i, *columns);
    if (!pose) return pose.error();
    Result<std::uint32_t> buttons = read_buttons(*table, i, button_column);
    if (!buttons) return buttons.error();
    motion.time_s.push_back(time_s);
    motion.X.push_back(pose->X);
    motion.buttons.push_back(*buttons);
    count_repair(pose->deviation, motion.repairs);
  }
  return motion;
}

Result<TwoBodyMotion> read_two_body_motion(const std::string& path) {
  Result<NumberTable> table = read_number_table(path, {});
  if (!table) return table.error();
  const bool numbered = table->column("o1_px") >= 0;
  Result<int> frame = needed(*table, "frame");
  if (!frame) return frame.error();
  Result<int> time = needed(*table, "time_s");
  if (!time) return time.error();
  Result<PoseColumns> a = pose_columns(*table, numbered ? "o1_" : "a_");
  if (!a) return a.error();
  Result<PoseColumns> b = pose_columns(*table, numbered ? "o2_" : "b_");
  if (!b) return b.error();

  TwoBodyMotion motion;
  for (std::size_t i = 0; i < table->rows(); ++i) {
    const double number = table->row(i)[*frame];
    constexpr double kLargest = 1ull << 53;  // whole numbers a double holds exactly
    if (number != std::floor(number) || std::abs(number) > kLargest) {
      return Error{"not a frame number", std::to_string(number), "a whole number", table->where(i, *frame)};
    }
    Result<ReadPose> X_WA = read_pose(*table, i, *a);
    if (!X_WA) return X_WA.error();
    Result<ReadPose> X_WB = read_pose(*table, i, *b);
    if (!X_WB) return X_WB.error();
    motion.frame.push_back(static_cast<std::int64_t>(number));
    motion.time_s.push_back(table->row(i)[*time]);
    motion.X_WA.push_back(X_WA->X);
    motion.X_WB.push_back(X_WB->X);
    count_repair(std::max(X_WA->deviation, X_WB->deviation), motion.repairs);
  }
  return motion;
}

Motion fitted(const Motion& motion, double radius_m) {
  Motion result = motion;
  if (motion.X.empty()) return result;
  Vec3 low = motion.X.front().p;
  Vec3 high = low;
  for (const Pose& X : motion.X) {
    low = low.cwiseMin(X.p);
    high = high.cwiseMax(X.p);
  }
  const Vec3 centre = 0.5 * (low + high);
  double extent = 0.0;
  for (const Pose& X : motion.X) extent = std::max(extent, (X.p - centre).norm());
  const double scale = extent > radius_m ? radius_m / extent : 1.0;
  const Mat3 R_first = motion.X.front().R;
  for (Pose& X : result.X) X = {X.R * R_first.transpose(), (X.p - centre) * scale};
  return result;
}

HandState RecordedMotion::at(double time_s) const noexcept {
  const std::vector<double>& times = motion_.time_s;
  if (times.empty()) return {};
  if (!(time_s >= 0.0)) return {motion_.X.front(), {}, motion_.buttons.front()};
  if (time_s >= times.back()) return {motion_.X.back(), {}, motion_.buttons.back()};
  const auto next = std::upper_bound(times.begin(), times.end(), time_s);
  const std::size_t i = static_cast<std::size_t>(next - times.begin()) - 1;
  const Twist V = twist_between(motion_.X[i], motion_.X[i + 1], times[i + 1] - times[i]);
  return {advanced(motion_.X[i], V, time_s - times[i]), V, motion_.buttons[i]};
}

}  // namespace tactum::inline v0_1
