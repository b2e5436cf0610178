#include "tactum/scene/item_visitor.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace tactum::inline v0_1 {

void ItemVisitor::number(const char* key, std::optional<double>& value, Range range) {
  optional(key, value, [&](double& number_there) { number(key, number_there, range, Need::kOptional); });
}

void ItemVisitor::angle(const char* key, std::optional<double>& value_rad, Range range_deg) {
  optional(key, value_rad, [&](double& angle_there) { angle(key, angle_there, range_deg, Need::kOptional); });
}

void ItemVisitor::vector(const char* key, std::optional<Vec3>& value) {
  optional(key, value, [&](Vec3& vector_there) { vector(key, vector_there, Need::kOptional); });
}

void ItemVisitor::direction(const char* key, Vec3& value, Need need) {
  vector(key, value, need);
  if (!(value.norm() > 0.0))
    fail(key, fmt::format("\"{}\" in {} has no direction", key, section()), "a vector of length 0",
         "an axis");
}

void ItemVisitor::sizes(const char* key, Vec3& value) {
  vector(key, value, Need::kRequired);
  if (!(value.minCoeff() > 0.0))
    fail(key, fmt::format("\"{}\" in {} is out of range", key, section()),
         fmt::format("[{}, {}, {}]", value.x(), value.y(), value.z()), "three numbers above 0");
}

void ItemVisitor::pose(Pose& X) {
  vector("pos_m", X.p);
  rotation(X.R);
}

void ItemVisitor::exclude(const char* key, const char* other, const char* what) {
  if (present(key, false) && present(other, false))
    fail(key, fmt::format("{} in {}", what, section()), fmt::format("{} and {}", key, other), "one of them");
}

void ItemVisitor::missing(const char* key, const char* expected) {
  fail(nullptr, fmt::format("missing key \"{}\" in {}", key, section()), "none", expected);
}

void KeyVisitor::add(const char* key) {
  const auto same = [&](const char* known) { return std::string_view(known) == key; };
  if (std::none_of(keys.begin(), keys.end(), same)) keys.push_back(key);
}

void KeyVisitor::rotation(Mat3&) {
  add("quat_wxyz");
  add("rpy_deg");
}

int KeyVisitor::word(const char* key, int index, const WordList&, Need) {
  add(key);
  return index;
}

std::size_t KeyVisitor::size(const char* key, std::size_t) {
  add(key);
  return 0;
}

}  // namespace tactum::inline v0_1
