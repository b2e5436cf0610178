#pragma once
/// The file on the disk below an HDF5 file. The library is never told that a write has failed: what it cannot
/// write it would keep until the process ends, try again there, and crash. So what the disk does not take is
/// kept here, where the library finds it again, and wrong() says that the file is not whole.

#include <hdf5.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tactum {

class H5Disk {
 public:
  /// Makes the file, empty. wrong() says where that failed.
  explicit H5Disk(const std::string& path);
  H5Disk(const H5Disk&) = delete;
  H5Disk& operator=(const H5Disk&) = delete;
  ~H5Disk();

  void write(std::uint64_t at, const char* bytes, std::size_t size);
  void read(std::uint64_t at, char* bytes, std::size_t size) const;
  void set_size(std::uint64_t size);
  std::uint64_t size() const noexcept { return size_; }
  void close();
  /// The operating system's words for the first call that failed; empty where none has.
  const std::string& wrong() const noexcept { return wrong_; }

  /// Makes the HDF5 file that is written here, by a driver of ours. Negative where the library refuses. It is
  /// closed before this ends. `access` has the other properties of the access.
  hid_t make_hdf5(const std::string& name, hid_t creation, hid_t access);

 private:
  void keep(std::uint64_t at, const char* bytes, std::size_t size);
  void check(bool good);

  int file_;
  std::uint64_t size_ = 0;
  std::string wrong_;
  std::map<std::uint64_t, std::vector<char>> kept_;  // pages that the disk did not take, by their number
};

}  // namespace tactum
