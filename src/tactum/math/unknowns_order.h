#pragma once
/// An order of the unknowns of a quadratic program in which those that rows connect are near: reverse Cuthill
/// and McKee [Cuthill and McKee 1969; George 1971]. The matrix of the rows' products then has its entries
/// near its diagonal (envelope_cholesky.h). Unknowns that always go together are a segment, as are those of
/// one body.
///
/// Nothing allocates after the constructor.

#include <cstdint>
#include <span>
#include <utility>

#include "tactum/base/reserved_vector.h"
#include "tactum/math/small_qp.h"

namespace tactum::inline v0_1 {

class UnknownsOrder {
 public:
  /// Room for so many rows, segments and unknowns.
  UnknownsOrder(std::size_t most_rows, std::size_t most_segments, std::size_t most_unknowns);

  /// Begins with no unknowns; then segments are added, then every row is connected, then the order is found.
  void begin() noexcept;
  /// Adds a segment of the next `unknowns` unknowns.
  void add_segment(std::size_t unknowns) noexcept;
  /// The unknowns of this row belong together.
  void connect(const QpRow& row) noexcept;
  /// Finds the order. False when there was no room for all connections.
  bool find() noexcept;

  /// The place of each unknown.
  std::span<const std::uint32_t> places() const noexcept { return places_; }
  /// For each place the first one that may stand in a row with it.
  std::span<const std::uint32_t> envelope() const noexcept { return envelope_; }

 private:
  using Segment = std::uint32_t;
  using Edge = std::pair<Segment, Segment>;

  std::size_t segments() const noexcept { return first_of_.size() - 1; }
  Segment order_from(Segment start, std::size_t number) noexcept;

  ReservedVector<Segment> segment_of_;        // of an unknown
  ReservedVector<std::uint32_t> first_of_;    // unknown of a segment, and behind the last one their number
  ReservedVector<Edge> edges_;                // in both directions
  ReservedVector<std::uint32_t> edges_from_;  // of a segment, in edges_
  ReservedVector<Segment> order_;
  ReservedVector<std::uint32_t> placed_;  // of a segment: its number in the order; at last its first place
  ReservedVector<std::uint32_t> places_, envelope_;
};

}  // namespace tactum::inline v0_1
