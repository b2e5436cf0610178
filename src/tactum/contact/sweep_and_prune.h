#pragma once
/// Finds which boxes overlap, from frame to frame: the ends of all boxes are sorted on each axis, and a frame
/// moves only the ends that changed their order, by insertion sort [Cohen 1995]. Where a lower end passes an
/// upper end an overlap on that axis begins, the other way round it ends; a pair that overlaps on three axes
/// is near. Cost of a frame: the boxes that moved plus the swaps; with coherent motion hardly more than
/// reading the ends.
///
/// The pairs are kept in a triangular table, so memory grows with the square of the boxes: this is for
/// bodies (tens to a thousand). Inside a part its hierarchy does the same work (geometry/bvh.h).

#include <array>
#include <cstdint>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum {

class SweepAndPrune {
 public:
  struct Pair {
    int a, b;  ///< a < b
  };

  /// Sorts from nothing: n log n, and n^2 for the table. Allocates; everything after does not.
  explicit SweepAndPrune(const std::vector<Aabb>& boxes);

  /// Moves box `i`; takes effect at the next update.
  void move(int i, const Aabb& box) noexcept;

  /// Sorts again; returns how many swaps it took.
  int update() noexcept;

  /// Pairs that overlap on all axes (touching counts), in no particular but reproducible order.
  const std::vector<Pair>& pairs() const noexcept { return pairs_; }

 private:
  struct End {
    double value;
    std::int32_t box;
    bool upper;
    /// Lower ends first where ends coincide, so that touching boxes overlap.
    bool before(const End& b) const { return value < b.value || (value == b.value && !upper && b.upper); }
  };

  std::size_t row(int a, int b) const noexcept;
  void begin_overlap(int a, int b) noexcept;
  void end_overlap(int a, int b) noexcept;

  int count_;
  std::array<std::vector<End>, 3> axes_;
  std::array<std::vector<std::array<std::int32_t, 2>>, 3> place_;  // where box i's lower and upper ends stand
  std::vector<std::uint8_t> overlapping_axes_;                     // per pair, 0..3
  std::vector<std::int32_t> listed_at_;                            // per pair: its place in pairs_, or -1
  std::vector<Pair> pairs_;
};

}  // namespace tactum
