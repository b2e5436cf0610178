/// docs/accuracy.md: how far off the answers of the contact core are at worst, and how many feature pairs
/// they take, for one pair of shapes after the other. With TACTUM_WRITE_ACCURACY set the page is written;
/// else each figure is compared with it, and one that has become worse fails.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "collision/cases.h"
#include "oracles/exhaustive.h"
#include "tactum/collision/closest_features.h"

namespace tactum {
namespace {

using cases::Making;

constexpr const char* kPage = TACTUM_SOURCE_DIR "/docs/accuracy.md";

/// The worst of one pair of shapes. Lengths are fractions of the larger shape's size.
struct Worst {
  double distance =
      0.0;  // of pieces apart: the points' distance less the support planes' gap, over all corners
  double normal = 0.0;  // bound on its angle that this leaves [rad], for gaps above 1e-3 of the size
  double depth = 0.0;   // of pieces that overlap: the depth less that of the support planes along its normal
  int cold_steps = 0;   // without a last frame
  int tracked_steps = 0;  // in the frames of a hand's motion
  int uncertified = 0;

  static constexpr std::array<const char*, 6> kNames{"distance [size]", "normal [rad]",   "depth [size]",
                                                     "steps, cold",     "steps, tracked", "uncertified"};
  std::array<double, 6> figures() const {
    return {distance, normal, depth, double(cold_steps), double(tracked_steps), double(uncertified)};
  }
};

void hold_against_scan(const Polytope& A, const Polytope& B, const Pose& X, const PairDistance& answer,
                       Worst& worst) {
  const double size = std::max(A.extent.size, B.extent.size);
  worst.uncertified += !answer.certified();
  if (answer.normal.isZero()) return;
  const double gap = double(oracle::support_gap(A, B, X, answer.normal));
  const double off = std::abs(answer.distance - gap) / size;
  if (answer.distance < 0.0) {
    worst.depth = std::max(worst.depth, off);
    return;
  }
  // The distance is between the gap and that of two points on the pieces; a normal that leaves only `off` of
  // a distance d is within acos(1 - off / d) of the one there is.
  const double points = (answer.p_a - answer.p_b).norm();
  const double bound = std::max(off, std::abs(points - gap) / size);
  worst.distance = std::max(worst.distance, bound);
  const double d = points / size;
  if (d > 1e-3) worst.normal = std::max(worst.normal, std::sqrt(2.0 * bound / d));
}

void measure_cold(Random& random, const Polytope& A, const Polytope& B, int poses, Worst& worst) {
  for (int i = 0; i < poses; ++i) {
    const Pose X = cases::make_pose(random, A, B, Making(i % int(Making::kCount)));
    PairCache cache;
    const PairDistance answer = closest_features(A, B, X, cache);
    worst.cold_steps = std::max(worst.cold_steps, answer.steps);
    hold_against_scan(A, B, X, answer, worst);
  }
}

/// A hand that brings B to A and pushes on, turning all the while: up to 0.5 mm and 3 mrad a frame.
void measure_tracked(Random& random, const Polytope& A, const Polytope& B, int approaches, Worst& worst) {
  for (int approach = 0; approach < approaches; ++approach) {
    Pose X{cases::random_rotation(random), Vec3::Zero()};
    const Vec3 away = cases::random_unit(random);
    X.p = A.extent.center - X.R * B.extent.center + away * (A.extent.radius + B.extent.radius);
    const double speed = random.uniform(0.1, 0.5);
    const Twist V{-away * speed, cases::random_unit(random) * random.uniform(1.0, 3.0)};
    PairCache cache;
    closest_features(A, B, X, cache);
    for (int frame = 0; frame < 200; ++frame) {
      X = advanced(X, V, 1e-3);
      const PairDistance answer = closest_features(A, B, X, cache);
      worst.tracked_steps = std::max(worst.tracked_steps, answer.steps);
      hold_against_scan(A, B, X, answer, worst);
    }
  }
}

struct Named {
  std::string name;
  Polytope shape;
};

std::vector<Named> shapes() {
  Random random(77);
  return {{"box", make_box({0.02, 0.03, 0.05})},
          {"tetrahedron", cases::random_hull(random, 4, {0.04, 0.04, 0.04})},
          {"needle 50:1", make_box({0.001, 0.001, 0.05})},
          {"plate 100:1", make_box({0.05, 0.05, 0.0005})},
          {"prism 6", make_prism(6, 0.02, 0.04)},
          {"cylinder 64", make_prism(64, 0.02, 0.05)},
          {"hull 100", cases::random_hull(random, 100, {0.03, 0.03, 0.03})},
          {"sphere 162", make_icosphere(2, 0.025)},
          {"sphere 642", make_icosphere(3, 0.025)},
          {"triangle", *flat_polygon({{0, 0, 0.01}, {0.05, 0, 0.01}, {0.01, 0.03, 0.01}})}};
}

/// Two digits, rounded up: the written figure is never less than the measured one.
std::string rounded_up(double value) {
  if (value == 0.0) return "0";
  if (value == std::floor(value) && value < 1e6) return std::to_string(int(value));
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", std::ceil(value / unit * (1.0 - 1e-12)) * unit);
  return text;
}

std::map<std::string, std::vector<double>> read_page() {
  std::map<std::string, std::vector<double>> rows;
  std::ifstream in(kPage);
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
    if (cells.size() != Worst::kNames.size() + 2) continue;
    const auto first = cells[1].find_first_not_of(' ');
    const std::string name = cells[1].substr(first, cells[1].find_last_not_of(' ') - first + 1);
    for (std::size_t i = 2; i < cells.size(); ++i)
      rows[name].push_back(std::strtod(cells[i].c_str(), nullptr));
  }
  return rows;
}

void write_page(const std::vector<std::pair<std::string, Worst>>& rows, int poses, int approaches) {
  std::ofstream out(kPage);
  out << "# Accuracy of the contact core\n\n"
         "Written by `tests/collision/accuracy_test.cpp` (`TACTUM_WRITE_ACCURACY=1 "
         "build/release/tests/test_collision\n"
         "--gtest_filter='Accuracy*'`); the same test fails when a figure becomes worse.\n\n"
         "For every pair of shapes, the worst of "
      << poses
      << " poses without a last frame (random; face to face, edge to edge, vertex\n"
         "over edge, face and vertex; aligned and flush; tilted by 1e-16 to 1e-2 rad; gaps of 0 and 1e-14 to "
         "1 of the size, of\n"
         "either sign) and of "
      << approaches
      << " approaches of 200 frames each (0.1-0.5 mm and 1-3 mrad a frame, from apart to deep inside).\n\n"
         "- **distance**: of pieces apart, the points' distance less the gap of the support planes along the "
         "answer's\n"
         "  normal, by a scan of all corners in long double: the true distance lies between the two.\n"
         "- **normal**: the largest angle which that leaves between the answer's normal and the true one, "
         "for gaps above\n"
         "  1e-3 of the size.\n"
         "- **depth**: of pieces that overlap, the depth of the answer less that of the support planes along "
         "its "
         "normal.\n"
         "- **steps**: feature pairs looked at by one query, without and with a last frame.\n\n"
         "Lengths are shares of the larger shape's size.\n\n| pair |";
  for (const char* name : Worst::kNames) out << ' ' << name << " |";
  out << "\n|---|---|---|---|---|---|---|\n";
  for (const auto& [name, worst] : rows) {
    out << "| " << name << " |";
    for (double figure : worst.figures()) out << ' ' << rounded_up(figure) << " |";
    out << '\n';
  }
  out << "\nWhat does not change an answer by more than 4e-9 of the size "
         "(`tests/collision/closest_features_test.cpp`):\n"
         "exchanging A and B, the order of the vertices, a rotation of the world, pieces a thousand times "
         "smaller or larger.\n"
         "A world moved by 1 km rounds the poses themselves: 1e-12 m more.\n";
}

TEST(Accuracy, IsNotWorseThanItsPageSays) {
  const int poses = 2000;
  const int approaches = 40;
  const bool write = std::getenv("TACTUM_WRITE_ACCURACY") != nullptr;
  const auto list = shapes();
  const auto page = read_page();
  std::vector<std::pair<std::string, Worst>> rows;
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t j = i; j < list.size(); ++j) {
      Worst worst;
      // Streams of their own: a build that tries fewer poses tries the first of these.
      Random random(2026 + 100 * i + j);
      Random hand(52026 + 100 * i + j);
      measure_cold(random, list[i].shape, list[j].shape, cases::some_of(poses), worst);
      measure_tracked(hand, list[i].shape, list[j].shape, cases::some_of(approaches), worst);
      rows.emplace_back(list[i].name + ", " + list[j].name, worst);
    }
  if (write) return write_page(rows, poses, approaches);
  for (const auto& [name, worst] : rows) {
    ASSERT_TRUE(page.contains(name)) << kPage << " has no row for '" << name << "'";
    const std::vector<double>& known = page.at(name);
    const auto figures = worst.figures();
    for (std::size_t i = 0; i < figures.size(); ++i)
      EXPECT_LE(figures[i], known[i] * (1.0 + 1e-9)) << name << ": " << Worst::kNames[i];
  }
}

}  // namespace
}  // namespace tactum
