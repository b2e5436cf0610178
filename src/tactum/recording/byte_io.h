#pragma once
/// Numbers and texts in little-endian bytes, as MCAP and the messages of a recording have them.

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace tactum::inline v0_1 {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

/// Appends to a string, which grows as it must.
class ByteWriter {
 public:
  explicit ByteWriter(std::string& out) : out_(out) {}
  template <class T>
  requires std::is_arithmetic_v<T>
  void number(T value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out_.append(bytes, sizeof value);
  }
  void bytes(std::string_view raw) { out_.append(raw); }
  /// With its length in 32 bits before it.
  void text(std::string_view raw) {
    number(static_cast<std::uint32_t>(raw.size()));
    bytes(raw);
  }

 private:
  std::string& out_;
};

/// Reads from bytes that anybody may have written. What lies beyond the end is zero or empty, and from then
/// on good() is false.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  requires std::is_arithmetic_v<T> T number() {
    T value{};
    const std::string_view raw = bytes(sizeof value);
    if constexpr (std::is_same_v<T, bool>)
      value = !raw.empty() && raw[0] != 0;  // any other byte in a bool would be undefined
    else if (raw.size() == sizeof value)
      std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  std::string_view bytes(std::uint64_t size) {
    if (size > bytes_.size() - at_) good_ = false;
    if (!good_) return {};
    const std::string_view raw = bytes_.substr(at_, size);
    at_ += static_cast<std::size_t>(size);
    return raw;
  }
  std::string_view text() { return bytes(number<std::uint32_t>()); }
  std::string_view rest() { return bytes(bytes_.size() - at_); }
  bool good() const { return good_; }
  bool done() const { return at_ == bytes_.size(); }
  std::size_t at() const { return at_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace tactum::inline v0_1
