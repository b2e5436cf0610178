#include "tactum/scene/check_description.h"

#include <fmt/format.h>

#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {
namespace {

class CheckVisitor final : public ItemVisitor {
 public:
  using ItemVisitor::angle;
  using ItemVisitor::number;
  using ItemVisitor::table;
  using ItemVisitor::vector;

  CheckVisitor(std::string path, const SceneSource& source, FirstError& errors)
      : path_(std::move(path)), source_(source), errors_(errors) {}

  void number(const char* key, double& value, Range range, Need) override {
    if (!within(value, range)) out_of_range(key, fmt::format("{}", value), shown(range));
  }
  void angle(const char* key, double& value_rad, Range range_deg, Need) override {
    const Range range_rad{radians(range_deg.low), radians(range_deg.high), range_deg.above_low};
    if (!within(value_rad, range_rad))
      out_of_range(key, fmt::format("{:.9g}", value_rad / radians(1.0)), shown(range_deg));
  }
  void integer(const char* key, int& value, int low, int high, Need) override {
    if (value < low || value > high)
      out_of_range(key, fmt::format("{}", value), fmt::format("{} to {}", low, high));
  }
  void flag(const char*, bool&) override {}
  void text(const char*, std::string&, Need) override {}
  void vector(const char* key, Vec3& value, Need) override {
    if (!value.allFinite())
      out_of_range(key, fmt::format("[{}, {}, {}]", value.x(), value.y(), value.z()), "finite numbers");
  }
  void interval(const char*, Interval&, double) override {}  // its rule refuses what is not a number
  void rotation(Mat3& R) override {
    const double off = (R * R.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff();
    if (!(off < tolerances::kRotationNear && R.determinant() > 0.0))
      fail("quat_wxyz", "the orientation in " + section() + " is no rotation",
           fmt::format("a matrix of determinant {:.6g}", R.determinant()),
           "an orthogonal matrix of determinant 1");
  }
  void setting(const SettingInfo& info, FrameSettings& frame, SafetySettings& safety) override;
  int word(const char*, int index, const WordList&, Need) override { return index; }

  bool present(const char*, bool in_memory) override { return in_memory; }
  void table(const char* key, const KeyList&, const Visit& visit) override {
    CheckVisitor inside(item_path(path_, key), source_, errors_);
    visit(inside);
  }
  bool several(const char*, bool in_memory) override { return in_memory; }
  std::size_t size(const char*, std::size_t in_memory) override { return in_memory; }
  void element(const char* key, std::size_t index, const KeyList&, const Visit& visit) override {
    CheckVisitor inside(item_path(path_, key, index), source_, errors_);
    visit(inside);
  }
  int marked(const std::vector<KeyList>&, const WordList&, int in_memory, const Error&) override {
    return in_memory;
  }
  void only(const Alternatives&, int) override {}

  void fail(const char* key, std::string what, std::string found, std::string expected) override {
    const std::string item = key ? item_path(path_, key) : path_;
    errors_.add({std::move(what), std::move(found), std::move(expected), source_.where(item)});
  }
  std::string section() const override { return source_.section(path_); }

 private:
  void out_of_range(const char* key, std::string found, std::string expected) {
    fail(key, fmt::format("\"{}\" in {} is out of range", key, section()), std::move(found),
         std::move(expected));
  }

  std::string path_;
  const SceneSource& source_;
  FirstError& errors_;
};

/// The ends of the range as they come back from memory, where units may round them.
void CheckVisitor::setting(const SettingInfo& info, FrameSettings& frame, SafetySettings& safety) {
  const double value = info.get(frame, safety);
  FrameSettings end_frame;
  SafetySettings end_safety;
  if (value == info.get(end_frame, end_safety)) return;  // the default, which may be infinite
  const auto end = [&](double limit) {
    info.set(end_frame, end_safety, limit);
    return info.get(end_frame, end_safety);
  };
  const double low = end(info.low), high = end(info.high);
  if (!(value >= low && value <= high))
    out_of_range(info.key, fmt::format("{}", value), shown(Range{info.low, info.high}));
}

}  // namespace

Result<void> check_description(const SceneDescription& scene) {
  FirstError errors;
  SceneDescription copy = scene;  // visitors may write
  CheckVisitor visitor("", scene.source, errors);
  visit_items(visitor, copy);
  if (errors) return errors.error();
  return {};
}

}  // namespace tactum::inline v0_1
