#pragma once
/// What was probably meant where a text is not TOML: a closing quote, `[[body]]` for `[body]`, a comma; or
/// that the text is YAML, JSON or XML. For src/tactum/scene/*.cpp only, as toml_reader.h.

#include <toml++/toml.h>
#include <string>
#include <string_view>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// The parser's error in words of a scene file, at the parser's line and column; where no slip is
/// recognised, in the parser's own words. `file` names the source.
Error toml_error(std::string_view text, const std::string& file, const toml::parse_error& error);

}  // namespace tactum::inline v0_1
