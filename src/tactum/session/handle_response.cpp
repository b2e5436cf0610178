#include "tactum/session/handle_response.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kFewestSamples = 100;
constexpr double kLeastTravel_m = 0.003;  // from end to end
constexpr double kWorstRemainder = 0.05;  // of the travel
constexpr double kSlow_m_per_s = 0.0015;  // below it the direction of friction is not certain
constexpr double kDelayStep_s = 0.00025;
constexpr int kVelocityFrames = 3;  // frames to either side
constexpr int kUnknowns = 5;
// What the method is good for where friction is not quite that of the law (first_touch_test.cpp).
constexpr double kDampingError_Ns_per_m = 0.1;
constexpr double kDampingErrorShare = 0.15;

/// The force of the commands integrated twice, each command held until the next.
class ImpulseIntegral {
 public:
  explicit ImpulseIntegral(std::span<const ResponseSample> samples) : samples_(samples) {
    double once = 0.0, twice = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i > 0) {
        const double h = samples[i].time_s - samples[i - 1].time_s;
        const double force = samples[i - 1].force_N;
        twice += once * h + 0.5 * force * h * h;
        once += force * h;
      }
      once_.push_back(once);
      twice_.push_back(twice);
    }
  }

  double at(double time_s) const {
    const auto after = std::upper_bound(samples_.begin(), samples_.end(), time_s,
                                        [](double t, const ResponseSample& s) { return t < s.time_s; });
    if (after == samples_.begin()) return 0.0;
    const auto i = static_cast<std::size_t>(after - samples_.begin()) - 1;
    const double h = time_s - samples_[i].time_s;
    return twice_[i] + once_[i] * h + 0.5 * samples_[i].force_N * h * h;
  }

 private:
  std::span<const ResponseSample> samples_;
  std::vector<double> once_, twice_;
};

/// The direction of motion, -1 to 1, from readings to either side.
double direction_at(std::span<const ResponseSample> samples, std::size_t i) {
  const std::size_t from = i < kVelocityFrames ? 0 : i - kVelocityFrames;
  const std::size_t to = std::min(samples.size() - 1, i + kVelocityFrames);
  const double v = (samples[to].x_m - samples[from].x_m) / (samples[to].time_s - samples[from].time_s);
  return std::clamp(v / kSlow_m_per_s, -1.0, 1.0);
}

/// The columns of the law, a row for each sample.
Eigen::MatrixXd columns_of(std::span<const ResponseSample> samples) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(samples.size()), kUnknowns);
  double path = 0.0, slid = 0.0, slid_twice = 0.0, last_direction = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double x = samples[i].x_m - samples[0].x_m;
    const double direction = direction_at(samples, i);
    if (i > 0) {
      const double h = samples[i].time_s - samples[i - 1].time_s;
      path += 0.5 * h * (x + samples[i - 1].x_m - samples[0].x_m);
      const double grown = slid + 0.5 * h * (direction + last_direction);
      slid_twice += 0.5 * h * (slid + grown);
      slid = grown;
    }
    last_direction = direction;
    columns.row(static_cast<Eigen::Index>(i)) << x, path, slid_twice, 1.0,
        samples[i].time_s - samples[0].time_s;
  }
  return columns;
}

/// The law at one delay.
struct DelayFit {
  Eigen::VectorXd unknowns;
  double remainder_N = 0.0;  // root of the sum of squares, of the force integrated twice

  double as_length() const { return unknowns(0) > 0.0 ? remainder_N / unknowns(0) : HUGE_VAL; }
};

class ResponseLaw {
 public:
  explicit ResponseLaw(std::span<const ResponseSample> samples)
      : samples_(samples), impulse_(samples), columns_(columns_of(samples)), factored_(columns_) {}

  DelayFit at(double delay_s) const {
    Eigen::VectorXd wanted(columns_.rows());
    for (std::size_t i = 0; i < samples_.size(); ++i)
      wanted(static_cast<Eigen::Index>(i)) = impulse_.at(samples_[i].time_s - delay_s);
    DelayFit fit;
    fit.unknowns = factored_.solve(wanted);
    fit.remainder_N = (columns_ * fit.unknowns - wanted).norm();
    return fit;
  }

  /// The standard deviation of an unknown, where the remainder is noise.
  double deviation(int unknown, double remainder_N) const {
    const Eigen::MatrixXd spread = (columns_.transpose() * columns_).inverse();
    const double freedom = static_cast<double>(columns_.rows() - kUnknowns);
    return remainder_N * std::sqrt(std::max(0.0, spread(unknown, unknown)) / freedom);
  }

 private:
  std::span<const ResponseSample> samples_;
  ImpulseIntegral impulse_;
  Eigen::MatrixXd columns_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factored_;
};

/// The delay of the smallest remainder: by trial, then by the parabola through the best and its neighbours.
double best_delay(const ResponseLaw& law) {
  const int steps = static_cast<int>(std::lround(kLongestResponseDelay_s / kDelayStep_s));
  std::vector<double> squares;
  for (int i = 0; i <= steps; ++i) {
    const double length = law.at(i * kDelayStep_s).as_length();
    squares.push_back(length * length);
  }
  const auto best =
      static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin());
  double delay_s = static_cast<double>(best) * kDelayStep_s;
  if (best == 0 || best + 1 == squares.size()) return delay_s;
  const double bend = squares[best - 1] - 2.0 * squares[best] + squares[best + 1];
  if (bend > 0.0 && std::isfinite(bend))
    delay_s += 0.5 * kDelayStep_s * (squares[best - 1] - squares[best + 1]) / bend;
  return delay_s;
}

}  // namespace

Result<HandleResponse> fit_handle_response(std::span<const ResponseSample> samples,
                                           std::optional<double> known_delay_s) {
  if (samples.size() < kFewestSamples)
    return Error{"the answer of the handle is too short", std::to_string(samples.size()) + " samples",
                 "at least " + std::to_string(kFewestSamples), ""};
  const auto [least, most] =
      std::minmax_element(samples.begin(), samples.end(),
                          [](const ResponseSample& a, const ResponseSample& b) { return a.x_m < b.x_m; });
  const double travel_m = most->x_m - least->x_m;
  if (!(travel_m > kLeastTravel_m))
    return Error{"the handle hardly moved under the force", std::to_string(1e3 * travel_m) + " mm",
                 "a handle that nobody holds, and motors that are on", ""};
  const ResponseLaw law(samples);
  HandleResponse response;
  response.delay_s = known_delay_s ? *known_delay_s : best_delay(law);
  const DelayFit fit = law.at(response.delay_s);
  response.mass_kg = fit.unknowns(0);
  response.damping_Ns_per_m = fit.unknowns(1);
  response.friction_N = fit.unknowns(2);
  response.damping_error_Ns_per_m =
      std::max(2.0 * law.deviation(1, fit.remainder_N),
               kDampingError_Ns_per_m + kDampingErrorShare * std::abs(response.damping_Ns_per_m));
  response.remainder_m = fit.as_length() / std::sqrt(static_cast<double>(samples.size()));
  if (!(response.remainder_m < kWorstRemainder * travel_m))
    return Error{"the handle did not move as a mass with damping and friction does",
                 std::to_string(1e3 * response.remainder_m) + " mm of " + std::to_string(1e3 * travel_m) +
                     " mm are not explained",
                 "a handle that nobody holds and that hits nothing", ""};
  return response;
}

TurnResponse turn_response(const HandleResponse& at_lever) {
  constexpr double kSquare_m2 = kResponseLever_m * kResponseLever_m;
  return {at_lever.mass_kg * kSquare_m2, at_lever.damping_Ns_per_m * kSquare_m2,
          at_lever.damping_error_Ns_per_m * kSquare_m2, at_lever.friction_N * kResponseLever_m};
}

}  // namespace tactum::inline v0_1
