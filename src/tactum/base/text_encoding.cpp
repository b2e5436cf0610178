#include "tactum/base/text_encoding.h"

namespace tactum::inline v0_1 {
namespace {

/// The name of an encoding in which a letter takes more than one byte; empty when it is none of them.
std::string_view wide_encoding(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv)) return "UTF-32";
  if (bytes.starts_with("\xFF\xFE"sv) || bytes.starts_with("\xFE\xFF"sv)) return "UTF-16";
  if (bytes.size() < 4) return {};
  const auto is_letter = [&](std::size_t i) {
    return (bytes[i] >= ' ' && bytes[i] <= '~') || bytes[i] == '\n';
  };
  const bool little = is_letter(0) && bytes[1] == '\0' && is_letter(2) && bytes[3] == '\0';
  const bool big = bytes[0] == '\0' && is_letter(1) && bytes[2] == '\0' && is_letter(3);
  return little || big ? "UTF-16"sv : std::string_view();
}

}  // namespace

Result<std::string_view> utf8_text(std::string_view bytes, const std::string& where) {
  if (const std::string_view encoding = wide_encoding(bytes); !encoding.empty()) {
    return Error{"the encoding of the text is not read", std::string(encoding),
                 "UTF-8 or ASCII (save the file as UTF-8)", where};
  }
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return bytes.starts_with(kMark) ? bytes.substr(kMark.size()) : bytes;
}

}  // namespace tactum::inline v0_1
