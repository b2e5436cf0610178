/// The trace of a run.
#include "tactum/telemetry/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/generated_page.h"
#include "support/pressed_block.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

/// A block that is pressed onto a plate, tilted, by an ideal device that is turned and scaled.
struct Pressed {
  std::unique_ptr<Simulation> simulation;
  explicit Pressed(double scale = 1.0) {
    DeviceInfo device;
    device.actuates_force = device.actuates_torque = device.senses_rotation = true;
    device.max_force_N = 20.0;
    device.max_torque_Nm = 1.0;
    device.max_stiffness_N_per_m = 500.0;
    FrameSettings settings = settings_for(device, 1000.0);
    settings.tool.body = 0;
    settings.workspace.scale = scale;
    settings.workspace.X_WD.R = exp_rotation({0, 0, 0.5 * kPi});
    simulation = std::move(*Simulation::make(block_over_plate(), settings));
  }
  void go(int frame) {
    simulation->step(Pose{exp_rotation({1e-4 * frame, 0, 0}), {1e-6 * frame, 0, -1e-5 * frame}});
  }
  FrameSource source() const { return {simulation->report(), simulation->state(), simulation->settings()}; }
};

Vec3 vector_at(const FrameTrace& trace, const std::vector<double>& row, const std::string& name) {
  const int column = trace.column(name);
  EXPECT_GE(column, 0) << name;
  const auto i = static_cast<std::size_t>(std::max(0, column));
  return {row[i], row[i + 1], row[i + 2]};
}

double number_at(const FrameTrace& trace, const std::vector<double>& row, const std::string& name) {
  const int column = trace.column(name);
  EXPECT_GE(column, 0) << name;
  return row[static_cast<std::size_t>(std::max(0, column))];
}

TEST(Trace, ARowIsTheFrame) {
  for (const double scale : {1.0, 5.0}) {
    Pressed pressed(scale);
    FrameTrace trace(pressed.simulation->world(), 0.001, true);
    std::vector<double> row(trace.width()), before;
    for (int i = 0; i < 1200; ++i) {
      pressed.go(i);
      trace.take(pressed.source(), nullptr);
      before = row;
      ASSERT_TRUE(trace.pop(row));
    }
    const FrameReport& report = pressed.simulation->report();
    const Mat3 R_WD = exp_rotation({0, 0, 0.5 * kPi});
    EXPECT_GT(report.shown.f.norm(), 1.0) << "something is felt";
    EXPECT_EQ(number_at(trace, row, "time_s"), 1.199);
    EXPECT_EQ(vector_at(trace, row, "hand_px_m"), report.X_WH.p);
    EXPECT_EQ(vector_at(trace, row, "proxy_px_m"), report.X_WH_proxy.p);
    EXPECT_LT((vector_at(trace, row, "device_px_m") - Vec3(1.199e-3, 0, -1.199e-2)).norm(), 1e-15);
    EXPECT_LT((vector_at(trace, row, "sent_fx_N") - R_WD * report.shown.f).norm(), 1e-15);
    EXPECT_LT((vector_at(trace, row, "sent_tx_Nm") - R_WD * report.shown.t).norm(), 1e-15);
    EXPECT_LT((vector_at(trace, row, "smoothed_fx_N") - R_WD * report.smoothed.f).norm(), 1e-15);
    EXPECT_LT((vector_at(trace, row, "computed_tx_Nm") - report.coupling.t / scale).norm(), 1e-15);
    EXPECT_EQ(number_at(trace, row, "in_contact"), 1.0);
    EXPECT_EQ(number_at(trace, row, "ramping"), 0.0);
    EXPECT_EQ(number_at(trace, row, "energy_balance_J"), report.port.balance_J);
    EXPECT_EQ(number_at(trace, row, "energy_stiffness_share"), report.port.stiffness_share);
    EXPECT_EQ(number_at(trace, row, "grasped_contact_points"), report.grasped_contact_points);
    const Vec3 moved = vector_at(trace, row, "proxy_px_m") - vector_at(trace, before, "proxy_px_m");
    EXPECT_LT((vector_at(trace, row, "proxy_vx_m_per_s") - 1000.0 * moved).norm(), 1e-9);
    const Eigen::Quaterniond q(number_at(trace, row, "hand_qw"), number_at(trace, row, "hand_qx"),
                               number_at(trace, row, "hand_qy"), number_at(trace, row, "hand_qz"));
    EXPECT_LT((q.toRotationMatrix() - report.X_WH.R).norm(), 1e-12);
    EXPECT_EQ(vector_at(trace, row, "body0_px_m"), pressed.simulation->bodies().X_WB[0].p);
  }
}

TEST(Trace, ItRampsAtFirstAndTheFirstRowHasNoVelocityOfTheProxy) {
  Pressed pressed;
  FrameTrace trace(pressed.simulation->world(), 0.001, false);
  std::vector<double> row(trace.width());
  pressed.go(0);
  trace.take(pressed.source(), nullptr);
  ASSERT_TRUE(trace.pop(row));
  EXPECT_EQ(number_at(trace, row, "ramping"), 1.0);
  EXPECT_EQ(vector_at(trace, row, "proxy_vx_m_per_s"), Vec3(Vec3::Zero()));
  EXPECT_FALSE(trace.pop(row)) << "there was one frame";
}

TEST(Trace, WhatNobodyPopsIsCountedAndTheRestIsInOrder) {
  Pressed pressed;
  FrameTrace trace(pressed.simulation->world(), 0.001, false);
  for (std::size_t i = 0; i < FrameTrace::kFrames + 7; ++i) {
    pressed.go(0);
    trace.take(pressed.source(), nullptr);
  }
  EXPECT_EQ(trace.dropped(), 7u);
  std::vector<double> row(trace.width());
  for (std::size_t i = 0; i < FrameTrace::kFrames; ++i) {
    ASSERT_TRUE(trace.pop(row));
    ASSERT_EQ(number_at(trace, row, "time_s"), static_cast<double>(i) * 0.001);
  }
  EXPECT_FALSE(trace.pop(row));
}

TEST(Trace, NamesAreUniqueAndPlainAlsoOfBodies) {
  World world = block_over_plate();
  world.bodies.push_back(world.bodies[1]);
  world.bodies[0].name = "left jaw, 5 mm";
  world.bodies[1].name = "left jaw; 5 mm";  // the same, once it can stand in a column's name
  world.bodies[2].name.clear();
  const FrameTrace trace(world, 0.001, true);
  std::set<std::string> names;
  for (const TraceColumn& column : trace.columns()) {
    EXPECT_TRUE(names.insert(column.name).second) << column.name;
    EXPECT_EQ(
        column.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"),
        std::string::npos)
        << column.name;
    EXPECT_FALSE(column.meaning.empty()) << column.name;
  }
  for (const char* name : {"left_jaw__5_mm_px_m", "left_jaw__5_mm_1_qw", "body2_vx_m_per_s"})
    EXPECT_GE(trace.column(name), 0) << name;
  EXPECT_EQ(trace.column("nothing"), -1);
}

TEST(Trace, ThePageIsMadeFromTheColumns) {
  World world = block_over_plate();
  world.bodies.resize(1);
  world.bodies[0].name = "NAME";
  std::string page =
      "# The trace of a run\n\n"
      "`tactum feel SCENE --trace FILE.csv` writes one row a frame and one column a number; with\n"
      "`--trace-bodies` every body has columns as well, those of NAME below. Lines at the head begin with "
      "`#`:\n"
      "the scene, the device, the rate, the frames, the date, and every setting of the run. This page is "
      "made\n"
      "from `src/tactum/telemetry/trace.cpp` by a test.\n\n"
      "Vectors have the axes of the world, wrenches act on the hand at the handle, as the device has them "
      "(with\n"
      "a workspace scale, torques of the scene are divided by it); `device_*` is in the frame of the "
      "device.\n"
      "Columns of a second hand have the same names behind `h2_`, those of a third behind `h3_`.\n"
      "`tactum-bench feel --scenes` judges such traces.\n\n"
      "```python\n"
      "import pandas\n"
      "trace = pandas.read_csv(\"run.csv\", comment=\"#\")\n"
      "trace.plot(x=\"time_s\", y=[\"smoothed_fz_N\", \"sent_fz_N\"])\n"
      "```\n\n"
      "| column | meaning |\n|---|---|\n";
  const FrameTrace trace(world, 0.001, true);
  for (const TraceColumn& column : trace.columns())
    page += "| `" + column.name + "` | " + column.meaning + " |\n";
  testing::expect_page("docs/trace.md", page);
}

}  // namespace
}  // namespace tactum
