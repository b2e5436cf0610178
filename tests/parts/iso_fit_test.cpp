#include "tactum/parts/iso_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tactum::iso_fit_test {
namespace {

struct Published {
  const char* name;
  double nominal_mm;
  double upper_um, lower_um;
};

TEST(IsoFit, ZonesAreThePublishedOnes) {
  // Limit deviations as ISO 286-2 prints them.
  const Published table[] = {
      {"H7", 25, 21, 0},     {"g6", 25, -7, -20},    {"H7", 8, 15, 0},      {"g6", 8, -5, -14},
      {"k6", 50, 18, 2},     {"H8", 40, 39, 0},      {"f7", 40, -25, -50},  {"h6", 60, 0, -19},
      {"h9", 100, 0, -87},   {"H11", 12, 110, 0},    {"d9", 30, -65, -117}, {"e8", 20, -40, -73},
      {"n6", 30, 28, 15},    {"p6", 30, 35, 22},     {"m6", 16, 18, 7},     {"s6", 70, 78, 59},
      {"r6", 130, 88, 63},   {"js6", 10, 4.5, -4.5}, {"F8", 25, 53, 20},    {"G7", 50, 34, 9},
      {"E9", 16, 75, 32},    {"D10", 25, 149, 65},   {"K7", 25, 6, -15},    {"M7", 25, 0, -21},
      {"N7", 25, -7, -28},   {"P7", 25, -14, -35},   {"N9", 6, 0, -30},     {"N9", 3, -4, -29},
      {"JS9", 8, 18, -18},   {"K8", 40, 12, -27},    {"M6", 300, -9, -41},  {"M8", 25, 4, -29},
      {"P9", 10, -15, -51},  {"H6", 3, 6, 0},        {"k8", 50, 39, 0},     {"s7", 200, 168, 122},
      {"h13", 500, 0, -970}, {"P6", 5, -9, -17},     {"K6", 10, 2, -7},     {"f6", 1, -6, -12},
  };
  for (const Published& row : table) {
    const auto limits = iso_limits(row.name, row.nominal_mm / 1000.0);
    ASSERT_TRUE(limits) << row.name << ": " << limits.error().message();
    EXPECT_NEAR(limits->upper_m * 1e6, row.upper_um, 1e-9) << row.nominal_mm << " " << row.name;
    EXPECT_NEAR(limits->lower_m * 1e6, row.lower_um, 1e-9) << row.nominal_mm << " " << row.name;
  }
}

TEST(IsoFit, StepsOfSizeBelongToTheirUpperEnd) {
  EXPECT_NEAR(iso_limits("H7", 0.018)->upper_m, 18e-6, 1e-12);
  EXPECT_NEAR(iso_limits("H7", 0.01801)->upper_m, 21e-6, 1e-12);
  EXPECT_NEAR(iso_limits("s6", 0.065)->lower_m, 53e-6, 1e-12);
  EXPECT_NEAR(iso_limits("s6", 0.06501)->lower_m, 59e-6, 1e-12);
}

TEST(IsoFit, GradesFollowTheStandardsOwnRule) {
  // The tables round i = 0.45 cbrt(D) + 0.001 D um, D the geometric mean of the step, times the grade's
  // factor.
  const double factor[] = {7, 10, 16, 25, 40, 64, 100, 160, 250};
  const double ends[] = {3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500};
  for (int grade = 5; grade <= 13; ++grade) {
    for (int step = 1; step < 13; ++step) {
      const double mean = std::sqrt(ends[step - 1] * ends[step]);
      const double exact = factor[grade - 5] * (0.45 * std::cbrt(mean) + 0.001 * mean);
      const auto limits = iso_limits("H" + std::to_string(grade), ends[step] / 1000.0);
      EXPECT_NEAR(limits->upper_m * 1e6, exact, std::max(1.0, 0.06 * exact)) << grade << " " << ends[step];
    }
  }
}

TEST(IsoFit, HoleAndShaftBasedFitsAgree) {
  // The standard's special rule: "K7/h6" leaves the limits of clearance that "H7/k6" leaves.
  for (const char letter : {'k', 'm', 'n', 'p'}) {
    for (const double nominal_mm : {5, 8, 14, 25, 40, 70, 100, 150, 220, 350, 450}) {
      const std::string small(1, letter);
      const std::string capital(1, static_cast<char>(letter - 'a' + 'A'));
      const Fit a = *iso_fit("H7/" + small + "6", nominal_mm / 1000.0);
      const Fit b = *iso_fit(capital + "7/h6", nominal_mm / 1000.0);
      for (const FitPosition position : {FitPosition::kMinClearance, FitPosition::kMaxClearance})
        EXPECT_NEAR(a.clearance_m(position), b.clearance_m(position), 1e-12) << letter << nominal_mm;
    }
  }
}

TEST(IsoFit, PositionInTheZoneMovesBothParts) {
  const Fit fit = *iso_fit("H7/g6", 0.025);
  EXPECT_NEAR(fit.clearance_m(FitPosition::kMinClearance), 7e-6, 1e-12);
  EXPECT_NEAR(fit.clearance_m(FitPosition::kMid), 24e-6, 1e-12);
  EXPECT_NEAR(fit.clearance_m(FitPosition::kMaxClearance), 41e-6, 1e-12);
  EXPECT_LT(iso_fit("H7/s6", 0.025)->clearance_m(FitPosition::kMaxClearance), 0.0);
}

TEST(IsoFit, SaysWhatIsNotInTheTable) {
  const auto message = [](const char* fit, double nominal_m) {
    const auto found = iso_fit(fit, nominal_m);
    return found ? std::string("no error") : found.error().message();
  };
  EXPECT_NE(message("H7", 0.02).find("found \"H7\", expected a hole and a shaft"), std::string::npos);
  EXPECT_NE(message("g6/H7", 0.02).find("a hole and a shaft"), std::string::npos);
  EXPECT_NE(message("", 0.02).find("unknown fit"), std::string::npos);
  EXPECT_NE(message("/", 0.02).find("unknown fit"), std::string::npos);
  EXPECT_NE(message("H4/g6", 0.02).find("a grade from 5 to 13"), std::string::npos);
  EXPECT_NE(message("H7/g99", 0.02).find("found \"g99\", expected a grade"), std::string::npos);
  EXPECT_NE(message("Q7/g6", 0.02).find("a hole of D E F"), std::string::npos);
  EXPECT_NE(message("H7/q6", 0.02).find("a shaft of d e f"), std::string::npos);
  EXPECT_NE(message("H7/g6x", 0.02).find("a letter and a grade"), std::string::npos);
  EXPECT_NE(message("H777/g6", 0.02).find("a letter and a grade"), std::string::npos);
  EXPECT_NE(message("K9/h6", 0.02).find("K5 to K8"), std::string::npos);
  EXPECT_NE(message("H7/g6", 0.0005).find("found 0.5 mm, expected 1 to 500 mm"), std::string::npos);
  EXPECT_NE(message("H7/g6", 0.6).find("1 to 500 mm"), std::string::npos);
  EXPECT_NE(message("H7/g6", std::nan("")).find("1 to 500 mm"), std::string::npos);
  EXPECT_EQ(message("H13/s5", 0.5), "no error");
}

}  // namespace
}  // namespace tactum::iso_fit_test
