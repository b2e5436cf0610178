#pragma once
/// The memory of contact rows from frame to frame, by the rows' names: the last force of each in an island
/// that moves by itself. The exact solver begins with the rows that had one, the sweeps with the forces
/// themselves.

#include <algorithm>
#include <cstdint>

#include "tactum/base/reserved_vector.h"

namespace tactum::inline v0_1 {

struct RowState {
  std::uint64_t name = 0;  ///< given by the caller; 0 is that of no row
  double force_N = 0.0;    ///< along the normal; not negative [N]
  int closed_frames = 0;   ///< in so many more frames its gap need not open
};

class RowMemory {
 public:
  explicit RowMemory(std::size_t most_rows) {
    last_.reserve(most_rows);
    now_.reserve(most_rows);
  }
  /// Begins a frame.
  void begin() noexcept {
    last_.swap(now_);
    now_.clear();
    next_ = 0;
  }
  /// Gives the next row of this frame the state that the row of the same name had in the last frame, or an
  /// empty one, and returns its number; -1 when there is no room. Rows come in the same order from frame to
  /// frame but for those that come and go. Only the next kLookAhead rows of the last frame are searched: when
  /// more than that go at once, those behind them begin without their forces.
  int recall(std::uint64_t name) noexcept {
    if (now_.size() == now_.capacity()) return -1;
    RowState state{.name = name};
    for (std::size_t ahead = 0; ahead < std::min(kLookAhead, last_.size()); ++ahead) {
      const std::size_t i = (next_ + ahead) % last_.size();
      if (last_[i].name != name) continue;
      next_ = i + 1;
      state = last_[i];
      state.closed_frames = std::max(0, state.closed_frames - 1);
      break;
    }
    now_.push_back(state);
    return static_cast<int>(now_.size()) - 1;
  }
  /// The state that recall() gave this number.
  RowState& operator[](int row) noexcept { return now_[static_cast<std::size_t>(row)]; }
  const RowState& operator[](int row) const noexcept { return now_[static_cast<std::size_t>(row)]; }

 private:
  static constexpr std::size_t kLookAhead = 64;

  ReservedVector<RowState> last_, now_;
  std::size_t next_ = 0;  // in last_
};

}  // namespace tactum::inline v0_1
