#pragma once
/// Which boxes overlap, kept from frame to frame: the ends of all boxes stand sorted on each axis, and a
/// frame moves only the ends that changed their order, by insertion sort [Cohen 1995]. Where a lower end
/// passes an upper end an overlap on that axis begins, the other way round it ends. Cost of a frame: the
/// boxes that moved plus the swaps; with coherent motion hardly more than looking.
///
/// The overlapping pairs are found by their two boxes in a hash table, so memory grows with the boxes, not
/// with their square: there is room for every pair of up to 128 boxes, and for 64 pairs a box beyond that.
/// Inside a part its hierarchy does the same work (geometry/bvh.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tactum/base/reserved_vector.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

class SweepAndPrune {
 public:
  struct Pair {
    std::int32_t a, b;  ///< a < b
    std::int32_t slot;  ///< less than room(); its own while the pair is listed
  };

  /// The largest number of pairs of `boxes` boxes that is listed.
  static std::size_t room_for(std::size_t boxes) noexcept;

  /// Sorts from nothing: n log n, and the overlaps on one axis. Allocates; everything after does not.
  explicit SweepAndPrune(const std::vector<Aabb>& boxes) : SweepAndPrune(boxes, room_for(boxes.size())) {}
  /// The same with room for `room` pairs.
  SweepAndPrune(const std::vector<Aabb>& boxes, std::size_t room);

  /// Moves box `i`; takes effect at the next update.
  void move(int i, const Aabb& box) noexcept;

  /// Sorts again; returns how many swaps it took.
  int update() noexcept;

  /// Pairs that overlap on all axes (touching counts), in no particular but reproducible order.
  std::span<const Pair> pairs() const noexcept { return pairs_; }
  std::size_t room() const noexcept { return room_; }
  /// Pairs that overlap and found no room; they are listed as soon as there is some.
  int missing() const noexcept { return missing_; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.boxes_, self.axes_, self.ends_of_, self.pairs_, self.free_slots_, self.table_, self.missing_);
  }

 private:
  struct End {
    double value;
    std::int32_t box;
    bool upper;
    /// Lower ends first where ends coincide, so that touching boxes overlap.
    bool before(const End& b) const { return value < b.value || (value == b.value && !upper && b.upper); }
  };
  struct Ends {
    std::int32_t lower, upper;
  };

  std::int32_t& place_of(std::size_t axis, const End& end) noexcept {
    Ends& ends = ends_of_[axis][static_cast<std::size_t>(end.box)];
    return end.upper ? ends.upper : ends.lower;
  }
  void list_all() noexcept;
  void begin_overlap(std::int32_t box, std::int32_t other) noexcept;
  void end_overlap(std::int32_t box, std::int32_t other) noexcept;
  std::size_t home_of(std::int32_t a, std::int32_t b) const noexcept;
  std::size_t next(std::size_t entry) const noexcept { return (entry + 1) & (table_.size() - 1); }
  std::size_t entry_of(std::int32_t a, std::int32_t b) const noexcept;
  void erase(std::size_t entry) noexcept;

  std::vector<Aabb> boxes_;
  std::size_t room_;
  std::array<std::vector<End>, 3> axes_;
  std::array<std::vector<Ends>, 3> ends_of_;  // where box i's ends stand on an axis
  ReservedVector<Pair> pairs_;
  ReservedVector<std::int32_t> free_slots_;  // as a stack
  std::vector<std::int32_t> table_;          // hash table: indices of pairs_, or -1
  ReservedVector<std::int32_t> open_;        // boxes that list_all() has begun and not ended
  int missing_ = 0;
};

}  // namespace tactum::inline v0_1
