#pragma once
/// A recording as an HDF5 file, for h5py, pandas, MATLAB and Octave. docs/recording.md tells what is in it.

#include <cstdint>
#include <string>

#include "tactum/recording/mcap_reader.h"

namespace tactum {

struct Hdf5Export {
  std::uint64_t rows = 0;
  McapEnd end;  ///< how the recording ended
};

/// Writes to the file `out`. An error where there is nothing to be told, or `out` cannot be written. `name`
/// is the recording's, for errors.
Result<Hdf5Export> export_hdf5(const McapSource& source, const std::string& name, const std::string& out);

/// The unit of a column of a frame, by its name: "N m", "rad/s"; "1" for counts, flags, shares and the parts
/// of quaternions.
std::string unit_of_column(const std::string& name);
/// The frame whose axes it is along: "W" the world, "D" the device; "none" for what has no direction.
std::string frame_of_column(const std::string& name);

}  // namespace tactum
