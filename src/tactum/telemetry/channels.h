#pragma once
/// The displayable values of a frame, by name: the wrench after every stage that changes it, and single
/// numbers. Displays, charts and exports are made from these two tables alone, so that a stage or a number
/// that gets a line here appears in all of them. Channels that are fields of the report are made from the
/// list of its fields (haptics/report_fields.h).

#include <cstdint>
#include <span>

#include "tactum/haptics/frame_state.h"
#include "tactum/response/frame_report.h"

namespace tactum::inline v0_1 {

/// A frame that is over.
struct FrameSource {
  const FrameReport& report;
  const FrameState& state;
  const FrameSettings& settings;
};

/// The wrench behind one stage, in the order of the stages: the first is raw, the last is what was sent.
struct WrenchStage {
  const char* key;                            ///< "smoothed"
  const char* name;                           ///< "After smoothing"
  const char* meaning;                        ///< the effect of the stage
  Wrench (*of)(const FrameSource&) noexcept;  ///< on the hand, at the handle, axes of W [N, N m]
};

struct Channel {
  const char* key;      ///< "stretch_m"
  const char* name;     ///< "Stretch"
  const char* unit;     ///< SI; "" for counts
  const char* group;    ///< numbers of one group belong on one chart
  const char* meaning;  ///< one line
  double (*of)(const FrameSource&) noexcept;
};

std::span<const WrenchStage> wrench_stages() noexcept;
std::span<const Channel> channels() noexcept;

/// A bit of FrameReport::flags and its meaning, with the setting to raise.
struct FlagName {
  std::uint32_t flag;
  const char* name;
};
std::span<const FlagName> frame_flag_table() noexcept;

}  // namespace tactum::inline v0_1
