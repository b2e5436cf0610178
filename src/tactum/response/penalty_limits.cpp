#include "tactum/response/penalty_response.h"

#include <algorithm>

namespace tactum::inline v0_1 {
namespace {

bool some(const PairCoefficients& of) {
  return std::any_of(of.coefficients.begin(), of.coefficients.end(), [](double c) { return c > 0.0; });
}

}  // namespace

std::string penalty_sentence(const FrameSettings& settings) {
  if (settings.response != ResponseModel::kPenalty) return "";
  const bool friction = some(settings.friction);
  const bool restitution = some(settings.impacts.restitution);
  if (!friction && !restitution) return "";
  return std::string("penalty response: the contacts of the grasped part are springs without ") +
         (friction && restitution ? "friction and restitution"
          : friction              ? "friction"
                                  : "restitution") +
         "; the other bodies obey what the scene says";
}

}  // namespace tactum::inline v0_1
