#include "tactum/parts/metric_thread.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tactum::metric_thread_test {
namespace {

TEST(MetricScrew, BasicDiametersAreThePublishedOnes) {
  // ISO 724: d2 and d1 in mm.
  struct Published {
    const char* name;
    double pitch, d2, d1;
  };
  for (const Published& row : {Published{"M3", 0.5, 2.675, 2.459},
                               {"M4", 0.7, 3.545, 3.242},
                               {"M5", 0.8, 4.480, 4.134},
                               {"M6", 1.0, 5.350, 4.917},
                               {"M8", 1.25, 7.188, 6.647},
                               {"M10", 1.5, 9.026, 8.376},
                               {"M12", 1.75, 10.863, 10.106},
                               {"M14", 2.0, 12.701, 11.835},
                               {"M16", 2.0, 14.701, 13.835},
                               {"M18", 2.5, 16.376, 15.294},
                               {"M20", 2.5, 18.376, 17.294},
                               {"M22", 2.5, 20.376, 19.294},
                               {"M24", 3.0, 22.051, 20.752}}) {
    const auto screw = metric_screw(row.name);
    ASSERT_TRUE(screw) << screw.error().message();
    EXPECT_NEAR(screw->pitch_m * 1e3, row.pitch, 1e-12) << row.name;
    EXPECT_NEAR(screw->pitch_diameter_m() * 1e3, row.d2, 0.000501) << row.name;
    EXPECT_NEAR(screw->minor_m() * 1e3, row.d1, 0.000501) << row.name;
  }
}

TEST(MetricScrew, TolerancesFollowTheStandardsOwnRules) {
  // ISO 965-1: Td2(6) = 90 P^0.4 d^0.1 um with d the geometric mean of its step, grades 4 and 8 are 0.63 and
  // 1.6 of it, TD2 of grades 5, 6, 7 1.06, 1.32 and 1.7 of it, es(g) = -(15 + 11 P); rounded to R40.
  for (const char* name :
       {"M3", "M4", "M5", "M6", "M8", "M10", "M12", "M14", "M16", "M18", "M20", "M22", "M24"}) {
    const MetricScrew screw = *metric_screw(name);
    const double pitch = screw.pitch_m * 1e3;
    const double d = screw.major_m * 1e3;
    const double mean = d <= 5.6    ? std::sqrt(2.8 * 5.6)
                        : d <= 11.2 ? std::sqrt(5.6 * 11.2)
                        : d <= 22.4 ? std::sqrt(11.2 * 22.4)
                                    : std::sqrt(22.4 * 45.0);
    const double six = 90.0 * std::pow(pitch, 0.4) * std::pow(mean, 0.1);
    const double allowance = 15.0 + 11.0 * pitch;
    const ThreadFit fine = *thread_fit(name, "fine");
    EXPECT_NEAR(-fine.bolt_m * 2e6 / (0.63 * six), 1.0, 0.05) << name;
    EXPECT_NEAR(fine.nut_m * 2e6 / (1.06 * six), 1.0, 0.05) << name;
    const ThreadFit medium = *thread_fit(name, "medium");
    EXPECT_NEAR((-medium.bolt_m * 1e6 - allowance) * 2.0 / six, 1.0, 0.06) << name;
    EXPECT_NEAR(medium.nut_m * 2e6 / (1.32 * six), 1.0, 0.05) << name;
    const auto coarse = thread_fit(name, "coarse");
    EXPECT_EQ(static_cast<bool>(coarse), d >= 5.0) << name;
    if (!coarse) continue;
    EXPECT_NEAR((-coarse->bolt_m * 1e6 - allowance) * 2.0 / (1.6 * six), 1.0, 0.06) << name;
    EXPECT_NEAR(coarse->nut_m * 2e6 / (1.7 * six), 1.0, 0.05) << name;
  }
  EXPECT_NEAR(thread_fit("M16", "medium")->flank_clearance_m(), 56e-6, 1e-12);  // (38 + 80 + 106) / 4
  EXPECT_NEAR(thread_fit_with(30e-6).flank_clearance_m(), 30e-6, 1e-15);
}

TEST(MetricScrew, SaysWhatIsNotInTheTable) {
  EXPECT_NE(metric_screw("M2").error().message().find("found \"M2\", expected one of M3 M4"),
            std::string::npos);
  EXPECT_NE(thread_fit("m16", "fine").error().message().find("unknown thread"), std::string::npos);
  EXPECT_NE(thread_fit("M16", "6H").error().message().find("fine, medium or coarse"), std::string::npos);
  EXPECT_NE(thread_fit("M4", "coarse").error().message().find("M5 or larger"), std::string::npos);
}

}  // namespace
}  // namespace tactum::metric_thread_test
