#pragma once
/// The capacity of the search for contacts, and its work in a frame: plain numbers, for settings and reports.

#include <cstddef>

namespace tactum::inline v0_1 {

/// Room reserved at load time; a full one sets a flag and drops the rest of that step.
struct ContactFinderCapacity {
  std::size_t pairs = 1 << 16;     ///< near piece pairs
  std::size_t patches = 4096;      ///< contact patches of a frame
  std::size_t minima = 8192;       ///< local minima of two surfaces
  std::size_t kept_minima = 1024;  ///< ... of which so many become patches (contact_reduction.h)
};

/// Counted work of one frame: N, K and M of the paper's T_h = N t_s + K t_c + M t_f, and what was left. It is
/// that of the search for patches: tests of trial poses are counted in FrameReport::validation_tests.
struct ContactWork {
  int broad_phase_runs = 0;       ///< 1 when boxes or lists had to be renewed, else 0 ("N-body tests")
  int bodies = 0;                 ///< N
  int near_pairs = 0;             ///< pairs on the lists
  int exact_tests = 0;            ///< K: of near pairs; each query of a pair of surfaces counts as one
  int feature_steps = 0;          ///< feature pairs visited by the exact tests
  int surface_queries = 0;        ///< pairs of bodies whose surfaces were searched for local minima
  int minima = 0;                 ///< found by them
  int dropped_minima = 0;         ///< of these, left out for want of room
  double dropped_error = 0.0;     ///< a dropped one can be overstepped by this at most [m]
  int patches = 0;                ///< M
  int uncertified = 0;            ///< answers without a certificate
  int due = 0;                    ///< pairs that may be within their tolerance, with no valid answer
  int known = 0;                  ///< ... and those whose last answer holds
  int unchecked = 0;              ///< due pairs beyond the budget, of pieces or of surfaces
  int left_unproven = 0;          ///< ... that no bound proves to stay apart in this frame
  int left_of_grasped = 0;        ///< ... of these, pairs of the grasped part
  int longest_unchecked = 0;      ///< frames since the last check of a pair of pieces that was left unproven
  bool capacity_reached = false;  ///< something was dropped: raise the capacity
};

}  // namespace tactum::inline v0_1
