#include "tactum/recording/shown_run.h"

#include <algorithm>
#include <cmath>

#include "tactum/recording/byte_io.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::uint64_t kSecond_ns = 1'000'000'000;

constexpr const char* kWrenchSchema = R"(std_msgs/Header header
geometry_msgs/Wrench wrench
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Wrench
geometry_msgs/Vector3 force
geometry_msgs/Vector3 torque
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
)";

}  // namespace

ShownRun::ShownRun(McapWriter& writer, const World& world, double dt_s,
                   const std::vector<TraceColumn>& columns, std::size_t hands)
    : writer_(writer),
      columns_(world, columns, hands),
      frames_a_message_(
          std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(1.0 / (dt_s * kRate_Hz))))) {
  const std::uint16_t transform =
      writer.add_schema({"foxglove.FrameTransform", "jsonschema", shown_json::transform_schema()});
  const std::uint16_t update =
      writer.add_schema({"foxglove.SceneUpdate", "jsonschema", shown_json::scene_schema()});
  const std::uint16_t wrench = writer.add_schema({"geometry_msgs/WrenchStamped", "ros1msg", kWrenchSchema});
  transforms_ = writer.add_channel({transform, "/tf", "json", {}});
  scene_ = writer.add_channel({update, "/scene", "json", {}});
  for (const ShownHandColumns& hand : columns_.hands)
    wrenches_.push_back({writer.add_channel({wrench, "/wrench/sent" + hand.number, "ros1", {}}),
                         writer.add_channel({wrench, "/wrench/computed" + hand.number, "ros1", {}})});
}

void ShownRun::show_scene(const World& world) {
  writer_.add_message(scene_, 0, shown_json::scene_message(world, kMostTriangles));
}

void ShownRun::show_wrench(std::uint16_t channel, const double* wrench, std::uint64_t time_ns) {
  std::string message;
  ByteWriter out(message);
  out.number(sequence_);
  out.number(static_cast<std::uint32_t>(time_ns / kSecond_ns));
  out.number(static_cast<std::uint32_t>(time_ns % kSecond_ns));
  out.text("world");
  for (int i = 0; i < 6; ++i) out.number(wrench[i]);
  writer_.add_message(channel, time_ns, message);
}

void ShownRun::show(std::uint64_t index, const std::vector<double>& numbers, std::uint64_t time_ns) {
  if (index % frames_a_message_ != 0) return;
  const double* row = numbers.data();
  for (const std::string& transform : columns_.transforms(row, time_ns))
    writer_.add_message(transforms_, time_ns, transform);
  for (std::size_t h = 0; h < wrenches_.size(); ++h) {
    show_wrench(wrenches_[h].sent, row + columns_.hands[h].sent, time_ns);
    show_wrench(wrenches_[h].computed, row + columns_.hands[h].computed, time_ns);
  }
  ++sequence_;
}

}  // namespace tactum::inline v0_1
