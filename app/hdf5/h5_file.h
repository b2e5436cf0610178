#pragma once
/// Writes HDF5: groups, columns that grow, and attributes. The same calls give the same bytes, since no times
/// are kept in the file. The file has its name only when it is whole.

#include <hdf5.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "app/hdf5/h5_disk.h"
#include "tactum/base/result.h"

namespace tactum {

/// A handle of the library, closed by the function that belongs to it.
class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  H5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  H5Handle(H5Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  H5Handle& operator=(H5Handle&&) = delete;
  ~H5Handle() { reset(); }
  hid_t id() const noexcept { return id_; }
  bool good() const noexcept { return id_ >= 0; }
  /// Closes it; false where that fails, or it had not been opened.
  bool reset() {
    const bool closed = id_ >= 0 && close_(id_) >= 0;
    id_ = -1;
    return closed;
  }

 private:
  hid_t id_;
  Close close_;
};

/// The number types that columns have.
template <class T>
hid_t h5_type();
template <>
inline hid_t h5_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t h5_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t h5_type<std::uint64_t>() {
  return H5T_NATIVE_UINT64;
}
template <>
inline hid_t h5_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

class H5File {
 public:
  /// Begins a file beside `path`, which close() gives its name.
  static Result<H5File> create(const std::string& path);
  H5File(H5File&& other) = default;
  /// A file that was not closed is removed.
  ~H5File();

  void group(const std::string& name);
  /// Attributes of a group or column; "/" is the whole file.
  void attribute(const std::string& object, const std::string& name, const std::string& text);
  void attribute(const std::string& object, const std::string& name, double number);
  void attribute(const std::string& object, const std::string& name, const std::vector<std::string>& texts);
  /// A text as a dataset of its own.
  void text(const std::string& name, const std::string& text);
  /// Ends the file. An error where any call before failed, such as on a full disk; the file is then gone.
  Result<void> close();

  hid_t id() const noexcept { return file_.id(); }
  /// Remembers that a call failed, unless it succeeded.
  void check(bool good) noexcept { *good_ = *good_ && good; }
  /// False where a call before failed, so that more need not be written.
  bool good() const noexcept { return *good_ && disk_->wrong().empty(); }

 private:
  H5File(std::string path, std::string unfinished);
  std::string path_, unfinished_;
  std::unique_ptr<H5Disk> disk_;
  H5Handle file_;  // closed before the disk below it
  std::unique_ptr<bool> good_;
};

/// A column of numbers, or of rows of `width` numbers, which grows as rows are added. It ends before its file
/// is closed. Adding allocates a buffer once.
template <class T>
class H5Column {
 public:
  H5Column(H5File& file, const std::string& name, std::size_t width = 1)
      : file_(&file), width_(width), data_(open(file, name, width)) {
    buffer_.reserve(kRows * width);
  }
  H5Column(H5Column&& other) noexcept = default;
  ~H5Column() {
    if (data_.good()) flush();
  }
  void add(T number) {
    buffer_.push_back(number);
    if (buffer_.size() == kRows * width_) flush();
  }

 private:
  static constexpr std::size_t kRows = 4096;  // of a chunk

  static H5Handle open(H5File& file, const std::string& name, std::size_t width) {
    const hsize_t size[2] = {0, width}, most[2] = {H5S_UNLIMITED, width}, chunk[2] = {kRows, width};
    const int rank = width == 1 ? 1 : 2;
    const H5Handle space(H5Screate_simple(rank, size, most), H5Sclose);
    const H5Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    file.check(H5Pset_obj_track_times(options.id(), false) >= 0 &&
               H5Pset_chunk(options.id(), rank, chunk) >= 0 && H5Pset_shuffle(options.id()) >= 0 &&
               H5Pset_deflate(options.id(), 4) >= 0);
    H5Handle data(
        H5Dcreate2(file.id(), name.c_str(), h5_type<T>(), space.id(), H5P_DEFAULT, options.id(), H5P_DEFAULT),
        H5Dclose);
    file.check(data.good());
    return data;
  }
  void flush() {
    const hsize_t rows = file_->good() ? buffer_.size() / width_ : 0;
    if (rows == 0) return buffer_.clear();
    const hsize_t size[2] = {rows_ + rows, width_}, from[2] = {rows_, 0}, count[2] = {rows, width_};
    const int rank = width_ == 1 ? 1 : 2;
    bool good = H5Dset_extent(data_.id(), size) >= 0;
    const H5Handle space(H5Dget_space(data_.id()), H5Sclose);
    const H5Handle memory(H5Screate_simple(rank, count, nullptr), H5Sclose);
    good = good && H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, from, nullptr, count, nullptr) >= 0 &&
           H5Dwrite(data_.id(), h5_type<T>(), memory.id(), space.id(), H5P_DEFAULT, buffer_.data()) >= 0;
    file_->check(good);
    rows_ += rows;
    buffer_.clear();
  }

  H5File* file_;
  std::size_t width_;
  H5Handle data_;
  hsize_t rows_ = 0;
  std::vector<T> buffer_;
};

}  // namespace tactum
