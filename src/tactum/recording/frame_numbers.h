#pragma once
/// A frame's report as numbers in a row, in the order of report_fields.h: a pose is twelve (place, then the
/// matrix row by row), a wrench six, everything else one. Exact: a whole number of the report is far below
/// 2^53. A negative zero is a zero, as in the hash.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tactum/haptics/frame_state.h"
#include "tactum/haptics/report_fields.h"
#include "tactum/recording/frame_copy.h"

namespace tactum::inline v0_1 {

struct ReportNumber {
  std::string name;        ///< "shown_fx_N", "X_WH_r01", "work_near_pairs"
  const FieldInfo* field;  ///< the field it is of
};

/// Of every number, in order.
const std::vector<ReportNumber>& report_numbers();

/// Writes report_numbers().size() numbers.
void put_report(const FrameReport& report, double* out) noexcept;

/// Of every number that each hand has of its own, in order.
const std::vector<ReportNumber>& hand_numbers();
/// Writes hand_numbers().size() numbers.
void put_hand_report(const HandReport& report, double* out) noexcept;

/// The hash of the state that a frame leaves: its report, the bodies, the contacts with their impulses, and
/// what hand, smoothing, energy balance and safety of every hand carry to the next frame.
std::uint64_t state_hash(const FrameReport& report, const FrameState& state) noexcept;
/// The same of a copy.
std::uint64_t state_hash(const FrameCopy& frame) noexcept;

}  // namespace tactum::inline v0_1
