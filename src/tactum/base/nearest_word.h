#pragma once
/// The known word that a mistyped one was meant to be, for errors that name it.

#include <string>
#include <string_view>
#include <vector>

namespace tactum::inline v0_1 {

/// The known word nearest to `word` by Damerau-Levenshtein distance, when near enough to be meant; else
/// empty.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

}  // namespace tactum::inline v0_1
