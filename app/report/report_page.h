#pragma once
/// A report as one HTML page that needs nothing else: no network, no script, light or dark as the reader's
/// system has it, white on paper.

#include <string>
#include <vector>

#include "app/report/run_figures.h"

namespace tactum {

/// The page of one recording, or of two side by side: their charts then have the same axes. The numbers stand
/// in it as well as JSON, in the element with the id "numbers".
std::string report_page(const std::vector<RunFigures>& runs);

/// The head of a page up to the opening of its body, with the style; `title` is text.
std::string page_head(const std::string& title);

}  // namespace tactum
