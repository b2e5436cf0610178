#include "tactum/parts/iso_fit.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>

namespace tactum::inline v0_1 {
namespace {

constexpr int kSteps = 13;
constexpr int kFineSteps = 22;
using StepRow = std::array<int, kSteps>;
using FineRow = std::array<int, kFineSteps>;

// The steps of nominal size: above the one before, up to and including this [mm]. The letters r and s divide
// the steps beyond 50 mm once more.
constexpr StepRow kUpTo = {3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500};
constexpr FineRow kFineUpTo = {3,   6,   10,  18,  30,  50,  65,  80,  100, 120, 140,
                               160, 180, 200, 225, 250, 280, 315, 355, 400, 450, 500};

// Standard tolerance grades 4 to 13 [um]. Grade 4 is needed for the differences of grades only.
constexpr int kFirstGrade = 4;
constexpr std::array<StepRow, 10> kGrades = {{
    {3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20},
    {4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27},
    {6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40},
    {10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63},
    {14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97},
    {25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155},
    {40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250},
    {60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400},
    {100, 120, 150, 180, 210, 250, 300, 350, 400, 460, 520, 570, 630},
    {140, 180, 220, 270, 330, 390, 460, 540, 630, 720, 810, 890, 970},
}};

// Shafts' fundamental deviations, distances from the nominal size [um]: d to h below it, k to s above.
constexpr StepRow kD = {20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230};
constexpr StepRow kE = {14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135};
constexpr StepRow kF = {6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68};
constexpr StepRow kG = {2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20};
constexpr StepRow kH = {};
constexpr StepRow kK = {0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5};
constexpr StepRow kM = {2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23};
constexpr StepRow kN = {4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40};
constexpr StepRow kP = {6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68};
constexpr FineRow kR = {10, 15, 19, 23, 28, 34, 41, 43,  51,  54,  63,
                        65, 68, 77, 80, 84, 94, 98, 108, 114, 126, 132};
constexpr FineRow kS = {14,  19,  23,  28,  35,  43,  53,  59,  71,  79,  92,
                        100, 108, 122, 130, 140, 158, 170, 190, 208, 232, 252};

struct Letter {
  std::string_view name;  // of the shaft
  const StepRow* deviation;
};
constexpr Letter kBelow[] = {{"d", &kD}, {"e", &kE}, {"f", &kF}, {"g", &kG}, {"h", &kH}};
constexpr Letter kAbove[] = {{"k", &kK}, {"m", &kM}, {"n", &kN}, {"p", &kP}};

template <std::size_t N>
std::size_t step_of(const std::array<int, N>& up_to, double nominal_mm) {
  std::size_t step = 0;
  while (step + 1 < N && nominal_mm > up_to[step]) ++step;
  return step;
}

template <std::size_t N>
const StepRow* deviation_of(const Letter (&letters)[N], std::string_view name) {
  for (const Letter& letter : letters)
    if (letter.name == name) return letter.deviation;
  return nullptr;
}

struct Name {
  std::string letter;
  int grade = 0;
};

/// "H7" in its two halves; nothing when it is no such name.
std::optional<Name> parsed(const std::string& text) {
  Name name;
  std::size_t i = 0;
  while (i < text.size() && std::isalpha(static_cast<unsigned char>(text[i])) != 0) name.letter += text[i++];
  const std::size_t digits = text.size() - i;
  if (name.letter.empty() || digits < 1 || digits > 2) return std::nullopt;
  for (; i < text.size(); ++i) {
    if (std::isdigit(static_cast<unsigned char>(text[i])) == 0) return std::nullopt;
    name.grade = 10 * name.grade + (text[i] - '0');
  }
  return name;
}

int grade_um(int grade, std::size_t step) {
  return kGrades[static_cast<std::size_t>(grade - kFirstGrade)][step];
}

struct Zone {
  double lower_um = 0.0;
  double upper_um = 0.0;
};

std::optional<Zone> shaft_zone(const Name& name, double nominal_mm) {
  const std::size_t step = step_of(kUpTo, nominal_mm);
  const double width = grade_um(name.grade, step);
  if (name.letter == "js") return Zone{-0.5 * width, 0.5 * width};
  if (const StepRow* below = deviation_of(kBelow, name.letter))
    return Zone{-(*below)[step] - width, -1.0 * (*below)[step]};
  double above = 0.0;
  if (name.letter == "r" || name.letter == "s") {
    above = (name.letter == "r" ? kR : kS)[step_of(kFineUpTo, nominal_mm)];
  } else if (const StepRow* row = deviation_of(kAbove, name.letter)) {
    above = name.letter == "k" && name.grade > 7 ? 0 : (*row)[step];
  } else {
    return std::nullopt;
  }
  return Zone{above, above + width};
}

/// How far a hole of the letters K to P lies below the nominal size at its upper limit. In the finer grades
/// the hole is moved up by the difference to the next finer grade, so that "K7/h6" fits as "H7/k6" does.
std::optional<double> hole_below(const Name& name, const std::string& letter, std::size_t step) {
  const StepRow* row = deviation_of(kAbove, letter);
  if (row == nullptr) return std::nullopt;
  const bool smallest = step == 0;  // 3 mm and below: no such differences
  if (letter == "k" && name.grade > 8 && !smallest) return std::nullopt;
  if (letter == "n" && name.grade > 8 && !smallest) return 0.0;
  if (letter == "m" && name.grade == 6 && kUpTo[step] == 315) return 9.0;  // the table's one exception
  const bool moved = !smallest && name.grade <= (letter == "p" ? 7 : 8);
  const int difference = moved ? grade_um(name.grade, step) - grade_um(name.grade - 1, step) : 0;
  return (*row)[step] - difference;
}

std::optional<Zone> hole_zone(const Name& name, double nominal_mm) {
  std::string letter;
  for (const char c : name.letter) letter += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::size_t step = step_of(kUpTo, nominal_mm);
  const double width = grade_um(name.grade, step);
  if (letter == "js") return Zone{-0.5 * width, 0.5 * width};
  if (const StepRow* above = deviation_of(kBelow, letter))
    return Zone{1.0 * (*above)[step], (*above)[step] + width};
  const std::optional<double> below = hole_below(name, letter, step);
  if (!below) return std::nullopt;
  return Zone{-*below - width, -*below};
}

bool is_hole(const std::string& name) {
  return !name.empty() && std::isupper(static_cast<unsigned char>(name.front())) != 0;
}

}  // namespace

double Fit::hole_m(FitPosition position) const {
  if (position == FitPosition::kMid) return hole.middle_m();
  return position == FitPosition::kMinClearance ? hole.lower_m : hole.upper_m;
}

double Fit::shaft_m(FitPosition position) const {
  if (position == FitPosition::kMid) return shaft.middle_m();
  return position == FitPosition::kMinClearance ? shaft.upper_m : shaft.lower_m;
}

Result<SizeLimits> iso_limits(const std::string& name, double nominal_m) {
  const double nominal_mm = nominal_m * 1000.0;
  const auto unknown = [&name](const char* expected) {
    return Error{"an unknown tolerance class", "\"" + name + "\"", expected, ""};
  };
  const std::optional<Name> parts = parsed(name);
  if (!parts) return unknown("a letter and a grade, such as H7 for a hole or g6 for a shaft");
  if (!(nominal_mm >= 1.0 && nominal_mm <= 500.0))
    return Error{"a size for which there are no fits", fmt::format("{} mm", nominal_mm), "1 to 500 mm", ""};
  if (parts->grade <= kFirstGrade || parts->grade > 13) return unknown("a grade from 5 to 13");
  const std::optional<Zone> zone =
      is_hole(name) ? hole_zone(*parts, nominal_mm) : shaft_zone(*parts, nominal_mm);
  if (!zone && parts->letter == "K") return unknown("K5 to K8 above 3 mm");
  if (!zone)
    return unknown(is_hole(name) ? "a hole of D E F G H JS K M N P" : "a shaft of d e f g h js k m n p r s");
  return SizeLimits{zone->lower_um / 1e6, zone->upper_um / 1e6};
}

Result<Fit> iso_fit(const std::string& name, double nominal_m) {
  const std::size_t slash = name.find('/');
  const std::string hole = name.substr(0, slash);
  const std::string shaft = slash == std::string::npos ? "" : name.substr(slash + 1);
  if (!is_hole(hole) || shaft.empty() || is_hole(shaft))
    return Error{"an unknown fit", "\"" + name + "\"", "a hole and a shaft, such as H7/g6", ""};
  const Result<SizeLimits> of_hole = iso_limits(hole, nominal_m);
  if (!of_hole) return of_hole.error();
  const Result<SizeLimits> of_shaft = iso_limits(shaft, nominal_m);
  if (!of_shaft) return of_shaft.error();
  return Fit{*of_hole, *of_shaft};
}

}  // namespace tactum::inline v0_1
