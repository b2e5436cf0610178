#include "tactum/parts/slotted_plate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/filling.h"
#include "tactum/base/random.h"
#include "tactum/base/tolerances.h"

namespace tactum::slotted_plate_test {
namespace {

double area_of(const SlottedPlate& plate) {
  const double width = (plate.slots - 1) * plate.pitch_m + plate.slot_width_m + 2.0 * plate.margin_m;
  return width * (plate.slot_length_m + 2.0 * plate.margin_m);
}

/// A slot's: the straight part, and a polygon of twice the end's facets that touches the circle.
double slot_area(const SlottedPlate& plate) {
  const double radius = 0.5 * plate.slot_width_m;
  const double ends = 2 * plate.end_facets * radius * radius * std::tan(0.5 * kPi / plate.end_facets);
  return plate.slot_width_m * (plate.slot_length_m - plate.slot_width_m) + ends;
}

/// Distance of (x, y) from the middle line of the nearest slot.
double from_middle_line(const SlottedPlate& plate, double x, double y) {
  const double straight = 0.5 * (plate.slot_length_m - plate.slot_width_m);
  double nearest = 1e300;
  for (int slot = 0; slot < plate.slots; ++slot) {
    const double middle = (slot - 0.5 * (plate.slots - 1)) * plate.pitch_m;
    nearest = std::min(nearest, std::hypot(x - middle, y - std::clamp(y, -straight, straight)));
  }
  return nearest;
}

TEST(SlottedPlate, WeighsThePlateLessItsSlots) {
  for (const int slots : {1, 2, 5}) {
    for (const int facets : {2, 4, 12, 32}) {
      SlottedPlate plate;
      plate.slots = slots;
      plate.end_facets = facets;
      const auto pieces = slotted_plate_pieces(plate);
      ASSERT_TRUE(pieces) << pieces.error().message();
      EXPECT_EQ(pieces->size(), static_cast<std::size_t>(slots + 1 + 2 * slots * (facets - 1)));
      const double expected = (area_of(plate) - slots * slot_area(plate)) * plate.thickness_m;
      EXPECT_NEAR(filling::volume(*pieces) / expected, 1.0, 1e-12)
          << slots << " slots, " << facets << " facets";
      for (const Polytope& piece : *pieces)
        EXPECT_LT(convexity_defect(piece), 4 * tolerances::kCoplanar * piece.extent.size);
    }
  }
}

TEST(SlottedPlate, FillsEverythingButTheSlotsOnce) {
  for (const int facets : {2, 10}) {
    SlottedPlate plate;
    plate.end_facets = facets;
    const auto pieces = *slotted_plate_pieces(plate);
    const double x_end = plate.pitch_m + 0.5 * plate.slot_width_m + plate.margin_m;
    const double y_end = 0.5 * plate.slot_length_m + plate.margin_m;
    const double radius = 0.5 * plate.slot_width_m;
    const std::uint64_t seed = 7;
    Random random(seed);
    for (int i = 0; i < 20000; ++i) {
      const double x = random.uniform(-1.1 * x_end, 1.1 * x_end);
      const double y = random.uniform(-1.1 * y_end, 1.1 * y_end);
      const double z = random.uniform(-0.001, 0.007);
      const bool in_plate = std::abs(x) < x_end && std::abs(y) < y_end && z > 0.0 && z < plate.thickness_m;
      const double away = from_middle_line(plate, x, y);
      bool in_slot = away < radius;
      if (facets == 2) {
        const double middle = plate.pitch_m * std::clamp(std::round(x / plate.pitch_m), -1.0, 1.0);
        in_slot = std::abs(x - middle) < radius && std::abs(y) < 0.5 * plate.slot_length_m;
      } else if (!in_slot && away < radius / std::cos(0.5 * kPi / facets)) {
        continue;  // between the circle and the corners of its facets either is right
      }
      EXPECT_EQ(filling::pieces_holding(pieces, {x, y, z}), in_plate && !in_slot ? 1 : 0)
          << facets << " facets, seed " << seed << " sample " << i;
    }
  }
}

TEST(SlottedPlate, RoundEndsTouchTheirCircle) {
  // A slot as long as it is wide is a round hole: every wall keeps the radius's distance from its middle.
  SlottedPlate plate;
  plate.slots = 1;
  plate.slot_length_m = plate.slot_width_m;
  plate.end_facets = 16;
  const auto pieces = *slotted_plate_pieces(plate);
  int walls = 0;
  for (const Polytope& piece : pieces) {
    for (const auto& face : piece.faces) {
      if (std::abs(face.normal.z()) > 0.5 || face.offset >= 0.0) continue;  // walls face the axis
      if (std::abs(face.offset + 0.5 * plate.slot_width_m) < 1e-12) ++walls;
    }
  }
  EXPECT_EQ(walls, 2 * 15 + 2);
}

TEST(SlottedPlate, RefusesWhatCannotBe) {
  const auto message = [](const SlottedPlate& plate) {
    const auto pieces = slotted_plate_pieces(plate);
    return pieces ? std::string("no error") : pieces.error().message();
  };
  EXPECT_EQ(message({}), "no error");
  EXPECT_NE(message({.slots = 0}).find("number of slots"), std::string::npos);
  EXPECT_NE(message({.slots = 33}).find("1 to 32"), std::string::npos);
  EXPECT_NE(message({.slot_width_m = 0.0}).find("slot width"), std::string::npos);
  EXPECT_NE(message({.slot_length_m = 0.004, .end_facets = 8}).find("slot length"), std::string::npos);
  EXPECT_EQ(message({.slot_length_m = 0.004}), "no error");  // square ends
  EXPECT_NE(message({.slot_length_m = std::nan("")}).find("slot length"), std::string::npos);
  EXPECT_NE(message({.pitch_m = 0.008}).find("more than the slot's width"), std::string::npos);
  EXPECT_NE(message({.margin_m = 0.0}).find("margin"), std::string::npos);
  EXPECT_NE(message({.thickness_m = -1.0}).find("thickness"), std::string::npos);
  EXPECT_NE(message({.end_facets = 5}).find("even number"), std::string::npos);
  EXPECT_NE(message({.end_facets = 34}).find("even number"), std::string::npos);
}

}  // namespace
}  // namespace tactum::slotted_plate_test
