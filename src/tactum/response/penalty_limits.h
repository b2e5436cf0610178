#pragma once
/// What the published response leaves out of a scene, in a sentence for people.

#include <string>

#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// Empty where nothing is left out, and in the constraint response.
std::string penalty_sentence(const FrameSettings& settings);

}  // namespace tactum::inline v0_1
