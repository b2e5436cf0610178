#pragma once
/// Loops that are compiled twice from the same source: narrow, for every processor, and wide, for those with
/// AVX2. Both take every sum in the same order, so it makes no difference to the results which one is called.
///
///     name_of.h        the loops as a template on the number of lanes
///     name_narrow.cpp  its instance for every processor
///     name_wide.cpp    its instance for AVX2; CMakeLists.txt compiles files of this name with -mavx2
///
/// Each makes a table of functions, of one type, and CpuBuilds holds the two. Whatever a wide file shows to
/// the linker must have no copy in another file (tools/check_wide_symbols.py): it might be called on any
/// processor. So wide files do not call the functions below.

namespace tactum::inline v0_1 {

/// Whether the processor that this runs on has AVX2. The processor itself is asked once, when the program
/// starts; a call reads the answer.
bool cpu_has_avx2() noexcept;

/// The two builds of one table of functions.
template <class Table>
struct CpuBuilds {
  const Table* narrow;  ///< never null
  const Table* wide;    ///< null where the library is built for another kind of processor

  /// The wide build where it can run, else null.
  const Table* usable_wide() const noexcept { return cpu_has_avx2() ? wide : nullptr; }
  /// The wide build where it can run, else the narrow one.
  const Table& best() const noexcept {
    const Table* const usable = usable_wide();
    return usable != nullptr ? *usable : *narrow;
  }
};

}  // namespace tactum::inline v0_1
