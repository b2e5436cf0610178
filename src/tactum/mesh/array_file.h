#pragma once
/// Named arrays in one block of bytes, the form of a part file.
///
///   magic 8 | version 4 | byte order 4 | whole size 8 | checksum 8          the checksum is of all the rest
///   name 24 | element size 4 | zero 4 | count 8 | elements, filled up to 8  ... once for each array
///
/// Numbers stand as the machine has them (little-endian, as the byte order says), so an array is copied out
/// of the mapped file in one piece. Writer and reader are called with the same fields in the same order; one
/// function serves both:
///
///   template <class Archive, class T> void fields(Archive& archive, T& part) {
///     archive("name", part.name);                    // a text
///     archive("vertices", part.surface.vertices);    // a vector of plain data
///     archive("volume", part.mass.volume);           // plain data
///     archive("tree", part.tree);                    // anything with for_each_array, scalars and sound
///   }
///
/// The reader trusts nothing: sizes are compared with the bytes that are there before anything is allocated,
/// and the first error ends it with a sentence.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// Copied byte by byte. Eigen's small matrices are plain numbers too, though their type traits deny it.
template <class T>
concept PlainData = std::is_trivially_copyable_v<T> || std::is_same_v<T, Vec3> || std::is_same_v<T, Mat3>;

/// Keeps its data in flat arrays and can check whether they fit together.
template <class T>
concept ArraysInside = requires(T& object, const T& constant) {
  object.scalars();
  object.for_each_array([](auto&) {});
  { constant.sound() } -> std::convertible_to<bool>;
};

class ArrayWriter {
 public:
  template <PlainData T>
  requires(!ArraysInside<T>) void operator()(std::string_view name, const T& value) {
    put(name, sizeof(T), 1, &value);
  }
  template <PlainData T, class Memory>
  void operator()(std::string_view name, const std::vector<T, Memory>& values) {
    put(name, sizeof(T), values.size(), values.data());
  }
  template <ArraysInside T>
  void operator()(std::string_view name, const T& object) {
    (*this)(name, object.scalars());
    object.for_each_array([&](const auto& array) { (*this)(name, array); });
  }
  void operator()(std::string_view name, const std::string& text) { put(name, 1, text.size(), text.data()); }
  void operator()(std::string_view name, const std::vector<std::string>& texts);
  void operator()(std::string_view name, const std::vector<Polytope>& pieces);

  /// The whole block.
  std::string finish(std::string_view magic, std::uint32_t version) &&;

 private:
  void put(std::string_view name, std::size_t element, std::size_t count, const void* data);
  std::string body_;
};

class ArrayReader {
 public:
  /// Checks magic, version, size and checksum. Errors call the thing `what` ("part") and the file `where`.
  ArrayReader(std::string_view bytes, std::string_view magic, std::uint32_t version, std::string what,
              std::string where);

  template <PlainData T>
  requires(!ArraysInside<T>) void operator()(std::string_view name, T& value) {
    const std::string_view data = take(name, sizeof(T));
    if (error_) return;
    if (data.size() != sizeof(T)) return refuse(name, "not one value");
    if constexpr (std::is_same_v<T, bool>) {
      if (data[0] != 0 && data[0] != 1) return refuse(name, "neither true nor false");
    }
    std::memcpy(static_cast<void*>(&value), data.data(), sizeof(T));
  }
  template <PlainData T, class Memory>
  void operator()(std::string_view name, std::vector<T, Memory>& values) {
    const std::string_view data = take(name, sizeof(T));
    if (error_) return;
    values.resize(data.size() / sizeof(T));
    if (!data.empty()) std::memcpy(static_cast<void*>(values.data()), data.data(), data.size());
  }
  template <ArraysInside T>
  void operator()(std::string_view name, T& object) {
    (*this)(name, object.scalars());
    object.for_each_array([&](auto& array) { (*this)(name, array); });
    if (!error_ && !object.sound()) refuse(name, "numbers that point outside");
  }
  void operator()(std::string_view name, std::string& text);
  void operator()(std::string_view name, std::vector<std::string>& texts);
  /// Only corners and loops are stored; the rest is computed from them anew, to the same bits.
  void operator()(std::string_view name, std::vector<Polytope>& pieces);

  /// Ends the reading with an error about the array. The first error stays.
  void refuse(std::string_view name, std::string_view found);
  /// Nothing may follow the last array.
  Result<void> finish();

 private:
  /// The elements of the next array, which must have this name.
  std::string_view take(std::string_view name, std::size_t element);

  std::string_view rest_;
  std::string what_;
  std::string where_;
  std::optional<Error> error_;
};

}  // namespace tactum::inline v0_1
