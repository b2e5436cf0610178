#include "tactum/devices/hand_model.h"

#include <array>
#include <vector>

#include "tactum/base/nearest_word.h"

namespace tactum::inline v0_1 {
namespace {

// Chosen by us inside what is commonly reported for a hand that holds a stylus: stiffness 100 to 1000 N/m
// growing with grip force, damping of some N s/m, and tens to a hundred grams that move with the handle. The
// damping gives a ratio of 0.4 to 0.5 with a light device, between a hand that swings and one that creeps.
// Rotation follows from translation with a finger span of 60 mm as lever for the spring and damper and 40 mm
// as radius of gyration: k_r = k (0.06 m)^2, b_r = b (0.06 m)^2, J = m (0.04 m)^2. They are not a
// measurement of anyone's hand.
const std::array<HandModel, 3>& grips() {
  static const std::array<HandModel, 3> table = {{
      //  grip     kg    kg m^2   N/m   N s/m  N m/rad  N m s/rad
      {"loose", 0.05, 0.08e-3, 100.0, 3.0, 0.36, 0.0108},
      {"medium", 0.10, 0.16e-3, 300.0, 6.0, 1.08, 0.0216},
      {"firm", 0.15, 0.24e-3, 800.0, 15.0, 2.88, 0.0540},
  }};
  return table;
}

}  // namespace

Result<HandModel> hand_model(const std::string& grip) {
  std::vector<std::string> known;
  std::string names;
  for (const HandModel& model : grips()) {
    if (model.name == grip) return model;
    known.push_back(model.name);
    names += (names.empty() ? "" : ", ") + model.name;
  }
  const std::string nearest = nearest_word(grip, known);
  return Error{"unknown grip of the hand", "'" + grip + "'",
               nearest.empty() ? "one of " + names : "'" + nearest + "' (of " + names + ")", ""};
}

HandModel no_hand() {
  HandModel model;
  model.name = "none";
  return model;
}

}  // namespace tactum::inline v0_1
