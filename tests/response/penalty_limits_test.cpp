#include "tactum/response/penalty_response.h"

#include <gtest/gtest.h>

namespace tactum {
namespace {

TEST(PenaltyLimits, AreStatedForScenesThatAskForMore) {
  FrameSettings settings;
  settings.response = ResponseModel::kPenalty;
  EXPECT_EQ(penalty_sentence(settings), "");
  settings.friction = {{0.0, 0.0, 0.0, 0.0}, 2};
  EXPECT_EQ(penalty_sentence(settings), "");
  settings.friction = {{0.0, 0.3, 0.3, 0.0}, 2};
  EXPECT_NE(penalty_sentence(settings).find("without friction;"), std::string::npos);
  settings.impacts.restitution = {{0.0, 0.5, 0.5, 0.0}, 2};
  EXPECT_NE(penalty_sentence(settings).find("without friction and restitution;"), std::string::npos);
  settings.friction = {};
  EXPECT_NE(penalty_sentence(settings).find("without restitution;"), std::string::npos);
  settings.response = ResponseModel::kConstraint;
  EXPECT_EQ(penalty_sentence(settings), "");
}

}  // namespace
}  // namespace tactum
