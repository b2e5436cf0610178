#pragma once
/// What all calls of the C interface share: errors as a status and a sentence, and structs that may grow.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "tactum/base/result.h"
#include "tactum/embedding/tactum_c.h"

namespace tactum::inline v0_1::c_calls {

/// Keeps the sentence for tactum_last_error() of this thread, and returns the status.
tactum_status say(tactum_status status, const std::string& sentence) noexcept;
tactum_status refuse(const Error& error) noexcept;
/// A mistake of the caller's: "tactum_step_pose: X_DH is null".
tactum_status bad_call(const char* call, const char* what) noexcept;

/// Runs the body of a call; no exception leaves it.
template <class Body>
tactum_status guarded(const Body& body) noexcept {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return say(TACTUM_NO_MEMORY, "there is not enough memory");
  } catch (const std::exception& exception) {
    return say(TACTUM_INTERNAL, exception.what());
  } catch (...) {
    return say(TACTUM_INTERNAL, "something was thrown that is no exception");
  }
}

/// Structs of the first version that has them are so large; smaller ones were never filled in.
template <class T>
constexpr std::size_t first_size() {
  return sizeof(T);
}
template <>
constexpr std::size_t first_size<tactum_scene_options>() {
  return offsetof(tactum_scene_options, other_devices);
}

/// Reads options that a program of another version may have filled in; null: all defaults. Bytes that this
/// version does not know must be zero, since they ask for something that it cannot do.
template <class T>
tactum_status take(const char* call, const T* given, T& taken) noexcept {
  taken = T{};
  if (given == nullptr) return TACTUM_OK;
  if (given->struct_size < first_size<T>()) return bad_call(call, "struct_size is not that of the struct");
  std::memcpy(&taken, given, std::min(given->struct_size, sizeof(T)));
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  const bool unknown =
      given->struct_size > sizeof(T) && std::any_of(bytes + sizeof(T), bytes + given->struct_size,
                                                    [](unsigned char byte) { return byte != 0; });
  return unknown ? bad_call(call, "an option is of a newer library than this one") : TACTUM_OK;
}

/// Whether an answer can be given to this struct.
template <class T>
tactum_status check_room(const char* call, const T* out) noexcept {
  if (out == nullptr) return bad_call(call, "the struct for the answer is null");
  if (out->struct_size < first_size<T>()) return bad_call(call, "struct_size is not that of the struct");
  return TACTUM_OK;
}

/// Fills what a program of another version has made room for; what this version does not know is zero.
template <class T>
void give(T full, T* out) noexcept {
  const std::size_t size = out->struct_size;
  full.struct_size = size;
  std::memcpy(out, &full, std::min(size, sizeof(T)));
  if (size > sizeof(T)) std::memset(reinterpret_cast<unsigned char*>(out) + sizeof(T), 0, size - sizeof(T));
}

inline std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

}  // namespace tactum::inline v0_1::c_calls
