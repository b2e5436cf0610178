#pragma once
/// The encoding of a text as programs store it: UTF-8 with or without a byte order mark is read, everything
/// else that says what it is gets refused by name.

#include <string>
#include <string_view>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// The text without its UTF-8 byte order mark. UTF-16 and UTF-32 are refused, with `where` as the place:
/// they are known by their marks, or by the zero bytes beside the first two letters.
Result<std::string_view> utf8_text(std::string_view bytes, const std::string& where);

}  // namespace tactum::inline v0_1
