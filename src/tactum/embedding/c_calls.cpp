#include "tactum/embedding/c_calls.h"

namespace tactum::inline v0_1::c_calls {
namespace {

std::string& last_sentence() {
  static thread_local std::string sentence;
  return sentence;
}

}  // namespace

tactum_status say(tactum_status status, const std::string& sentence) noexcept {
  try {
    last_sentence() = sentence;
  } catch (...) {
    last_sentence().clear();  // the status has to do
  }
  return status;
}

tactum_status refuse(const Error& error) noexcept {
  try {
    return say(TACTUM_REFUSED, error.message());
  } catch (...) {
    return say(TACTUM_REFUSED, {});
  }
}

tactum_status bad_call(const char* call, const char* what) noexcept {
  try {
    return say(TACTUM_BAD_CALL, std::string(call) + ": " + what);
  } catch (...) {
    return say(TACTUM_BAD_CALL, {});
  }
}

}  // namespace tactum::inline v0_1::c_calls

using namespace tactum;  // the C interface stands outside the namespace

int32_t tactum_version(void) { return TACTUM_LIBRARY_VERSION; }

const char* tactum_last_error(void) { return c_calls::last_sentence().c_str(); }

const char* tactum_status_text(tactum_status status) {
  switch (status) {
    case TACTUM_OK:
      return "done";
    case TACTUM_REFUSED:
      return "a file, a mesh, a scene or a setting is not as expected";
    case TACTUM_BAD_CALL:
      return "the call itself is wrong";
    case TACTUM_NO_MEMORY:
      return "there is not enough memory";
    case TACTUM_INTERNAL:
      return "a mistake of the library's own";
  }
  return "no such status";
}
