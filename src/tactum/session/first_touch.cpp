#include "tactum/session/first_touch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactum/haptics/coupling_gains.h"
#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

constexpr int kTries = 3;
constexpr double kReadFor_s = 1.0;
constexpr double kMoved_m = 0.030;         // a move is seen ...
constexpr double kMovedOfWorkspace = 0.4;  // ... or at this much of a small workspace
constexpr double kTurned_rad = 0.35;
constexpr double kFloorBelow_m = 0.010;
constexpr double kSoftWall_N_per_m = 200.0;
constexpr double kPressed_s = 1.0;  // on the floor, for the step to be done
constexpr double kSettle_s = 0.6;   // the start ramp, and a look whether a free handle stays
constexpr double kDrift_m = 0.004;  // in that time, it does not
constexpr double kDrift_rad = 0.08;
constexpr double kGrow_s = 1.5;      // a push grows from zero to the small force in this time
constexpr double kPushed_m = 0.005;  // and ends when the handle has moved so far
constexpr double kPushed_rad = 0.10;
constexpr double kPulse_m = 0.006;  // the first pulse ends here
constexpr double kLongestPulse_s = 0.5;
constexpr double kFarthest_m = 0.035;  // an answer is cut where the handle goes farther than this
constexpr double kFarthestOfWorkspace = 0.4;
constexpr double kBeyondFriction_N = 0.5;
constexpr double kOfMovingTorque = 3.0;
constexpr double kCoast_s = 0.3;
constexpr double kAfterFault_s = 0.6;   // more than the server waits for a device that is lost
constexpr double kShareOfLimit = 0.25;  // small forces are at most this share of the device's
constexpr double kDelivered = 0.25;     // the delivered force may differ from the sent by this share

enum class Outcome { kGood, kAgain, kOver };

/// One guided first touch.
class Guide {
 public:
  Guide(Device& device, const TouchPlanSettings& settings, TouchPerson& person, TouchClock& clock)
      : device_(device),
        info_(device.info()),
        settings_(settings),
        person_(person),
        server_(device, clock, settings.rate_Hz, [this] { return stopped(); }),
        limits_(safety_limits(info_)),
        small_force_N_(std::min(settings.small_force_N, kShareOfLimit * info_.max_force_N)),
        small_torque_Nm_(std::min(settings.small_torque_Nm, kShareOfLimit * info_.max_torque_Nm)) {}

  TouchReport run() {
    if (Result<void> opened = device_.open(); !opened) {
      report_.ended_by = opened.error().message();
      return report_;
    }
    report_.passed = all_steps();
    device_.write({});
    device_.close();
    return report_;
  }

 private:
  bool all_steps() {
    if (!tried("read", [this] { return read(); }) || !axes()) return false;
    if (!info_.actuates_force) return true;
    if (!tried("soft wall", [this] { return wall(true); })) return false;
    for (int axis = 0; axis < 3; ++axis)
      if (!tried("push " + direction_name({axis, 1.0}), [=, this] { return push(axis, false); }))
        return false;
    for (int axis = 0; info_.actuates_torque && axis < 3; ++axis)
      if (!tried(fmt::format("torque about {}", "xyz"[axis]), [=, this] { return push(axis, true); }))
        return false;
    return tried("answer", [this] { return answer(false); }) &&
           (!info_.actuates_torque || tried("answer of turning", [this] { return answer(true); })) &&
           tried("stated limits", [this] { return wall(false); });
  }

  bool axes() {
    constexpr std::array kOrder = {1, 2, 0};  // right, up, toward
    for (const bool turns : {false, true}) {
      if (turns && !info_.senses_rotation) continue;
      for (const int axis : kOrder)
        if (!tried((turns ? "turn about " : "move ") + direction_name({axis, 1.0}),
                   [=, this] { return follow(axis, turns); }))
          return false;
      const std::string fault = axes_fault(read_as_);
      found(turns ? "axes of turning" : "axes", fault.empty(),
            fault.empty() ? "x is toward you, y to the right, z up, as they should be"
                          : fault + "; no force is sent: the driver must convert its axes");
      if (!fault.empty()) {
        report_.ended_by = fault;
        return false;
      }
    }
    return true;
  }

  /// Makes a step, again where a fault or an unclear answer asks for it.
  template <class Step>
  bool tried(const std::string& name, const Step& step) {
    name_ = name;
    for (int attempt = 1; attempt <= kTries; ++attempt) {
      const Outcome outcome = step();
      if (outcome == Outcome::kGood) return true;
      if (outcome == Outcome::kOver) return false;
      if (attempt == kTries) report_.ended_by = report_.findings.back().sentence;
    }
    return false;
  }

  Outcome found(const std::string& step, bool good, const std::string& sentence) {
    report_.findings.push_back({step, good, sentence});
    person_.report(fmt::format("{}: {}", step, sentence));
    return good ? Outcome::kGood : Outcome::kAgain;
  }
  Outcome bad(const std::string& sentence) { return found(name_, false, sentence); }
  Outcome good(const std::string& sentence) { return found(name_, true, sentence); }

  /// Serves, and says what ended a step before it was done.
  std::optional<Outcome> serve(const SafetyLimits& limits, double at_most_s, const TouchStep& step,
                               bool quiet) {
    const StepResult result = server_.serve(limits, at_most_s, step, quiet);
    largest_N_ = result.largest_N;
    report_.largest_N = std::max(report_.largest_N, result.largest_N);
    report_.largest_Nm = std::max(report_.largest_Nm, result.largest_Nm);
    if (result.end == StepEnd::kDone) return {};
    if (result.end == StepEnd::kTimeOver) return bad("nothing came of it in time; nothing is sent");
    StepEnd end = result.end;
    if (end == StepEnd::kFault) {
      bad("the wrench was led to zero at once: " + safety_flag_names(result.faults));
      // Zero for a while: is the device still there?
      end = server_
                .serve(
                    limits_, kAfterFault_s, [](const TouchFrame&) { return Wrench{}; }, true)
                .end;
      if (end == StepEnd::kTimeOver) return Outcome::kAgain;
    }
    report_.ended_by =
        end == StepEnd::kStopped
            ? "stopped, the wrench is zero"
            : "the device is lost: it takes no wrench or gives no sample, and zero was offered to it. " +
                  device_.trouble();
    found(name_, false, report_.ended_by);
    return Outcome::kOver;
  }

  /// Asks, and serves zero until there is an answer.
  std::optional<Outcome> ask(TouchTask task, int axis, const std::string& text) {
    person_.ask({task, axis, text});
    go_on_ = false;
    return serve(
        limits_, settings_.answer_s,
        [this](const TouchFrame&) { return go_on_ ? std::nullopt : std::optional(Wrench{}); }, true);
  }

  bool stopped() {
    const TouchPerson::Word word = person_.heard();
    if (word == TouchPerson::Word::kGoOn) go_on_ = true;
    return word == TouchPerson::Word::kStop;
  }

  Outcome read();
  Outcome follow(int axis, bool turns);
  Outcome wall(bool soft);
  Outcome push(int axis, bool turns);
  Outcome answer(bool turns);
  Outcome measured(bool turns, const std::vector<ResponseSample>& samples);
  std::string pushed_text(const Vec3& moved, int axis, bool turns) const;

  SafetyLimits small_limits() const { return small_limits(small_torque_Nm_); }
  SafetyLimits small_limits(double max_torque_Nm) const {
    SafetySettings small;
    small.max_force_N = small_force_N_;
    small.max_torque_Nm = max_torque_Nm;
    return tightened(limits_, small);
  }
  /// A wrist with much friction needs more than the small torque, or friction hides its damping.
  double answer_torque_Nm() const {
    const double beyond_Nm = std::max(moving_torque_Nm_ + kBeyondFriction_N * kResponseLever_m,
                                      kOfMovingTorque * moving_torque_Nm_);
    return std::min(beyond_Nm, kShareOfLimit * info_.max_torque_Nm);
  }

  Device& device_;
  const DeviceInfo info_;
  const TouchPlanSettings settings_;
  TouchPerson& person_;
  TouchServer server_;
  const SafetyLimits limits_;
  const double small_force_N_, small_torque_Nm_;
  TouchReport report_;
  std::string name_;  // of the step
  std::array<ReadAxis, 3> read_as_;
  bool go_on_ = false;
  double largest_N_ = 0.0;         // of the last step
  double moving_force_N_ = 0.0;    // that moved the free handle along x
  double moving_torque_Nm_ = 0.0;  // and turned it about x
};

/// Where the handle has gone since the first valid sample of a step.
class Displacement {
 public:
  Vec3 of(const DeviceSample& sample, bool turns) {
    if (!sample.valid) return Vec3::Zero();
    if (!started_) start_ = sample.X_DH;
    started_ = true;
    return turns ? log_rotation(sample.X_DH.R * start_.R.transpose()) : Vec3(sample.X_DH.p - start_.p);
  }

 private:
  bool started_ = false;
  Pose start_;
};

Outcome Guide::read() {
  if (auto over = ask(TouchTask::kHoldStill, 0,
                      "For a second the device is only read; zero force is sent. Hold the handle still."))
    return *over;
  long frames = 0, valid = 0, fresh = 0;
  double last_s = -1.0;
  bool sound = true, on = true;
  if (auto over = serve(
          limits_, 2.0 * kReadFor_s,
          [&](const TouchFrame& now) -> std::optional<Wrench> {
            ++frames;
            valid += now.sample.valid ? 1 : 0;
            fresh += now.sample.valid && now.sample.time_s != last_s ? 1 : 0;
            last_s = now.sample.time_s;
            sound = sound && (!now.sample.valid || plausible(now.sample.X_DH));
            on = now.sample.motors_on;
            return now.since_s < kReadFor_s ? std::optional(Wrench{}) : std::nullopt;
          },
          true))
    return *over;
  if (!sound) return bad("a pose was not one: not finite, no rotation, or beyond 10 m");
  if (2 * valid < frames) return bad(fmt::format("only {} of {} reads succeeded", valid, frames));
  if (!on && info_.actuates_force)
    return bad(
        "the device says that its motors are off: switch them on, calibrate it, or hold its dead-man "
        "switch. " +
        device_.trouble());
  return good(fmt::format("{} of {} reads succeeded, {} new samples a second", valid, frames,
                          std::lround(static_cast<double>(fresh) / kReadFor_s)));
}

Outcome Guide::follow(int axis, bool turns) {
  static constexpr const char* kTurns[] = {"like a steering wheel to the left, seen from where you sit",
                                           "so that its top tips toward you",
                                           "counter-clockwise, seen from above"};
  const double enough =
      turns ? kTurned_rad : std::min(kMoved_m, kMovedOfWorkspace * info_.workspace_radius_m);
  const std::string text =
      turns ? fmt::format("Turn the handle by about 30 degrees {}. Zero force is sent.", kTurns[axis])
            : fmt::format("Move the handle {} by some {:.0f} mm, without turning it. Zero force is sent.",
                          direction_name({axis, 1.0}), 1300.0 * enough);
  if (auto over = ask(turns ? TouchTask::kTurn : TouchTask::kMove, axis, text)) return *over;
  Displacement since;
  Vec3 moved = Vec3::Zero();
  if (auto over = serve(
          limits_, settings_.patience_s,
          [&](const TouchFrame& now) -> std::optional<Wrench> {
            moved = since.of(now.sample, turns);
            return moved.norm() < enough ? std::optional(Wrench{}) : std::nullopt;
          },
          true))
    return *over;
  const std::optional<ReadAxis> clear = clear_axis(moved);
  if (!clear) return bad("the direction was not clear; please move along one direction only");
  read_as_[static_cast<std::size_t>(axis)] = *clear;
  return good((turns ? "a turn about " : "a move ") + direction_name({axis, 1.0}) + " was read as " +
              (turns ? "one about " : "one ") + direction_name(*clear));
}

Outcome Guide::wall(bool soft) {
  DeviceInfo measured = info_;
  if (report_.response) {
    measured.handle.delay_s = report_.response->delay_s;
    measured.handle.damping_Ns_per_m =
        std::max(0.0, report_.response->damping_Ns_per_m - report_.response->damping_error_Ns_per_m);
  }
  if (report_.turning)
    measured.handle.damping_Nms_per_rad =
        std::max(0.0, report_.turning->damping_Nms_per_rad - report_.turning->damping_error_Nms_per_rad);
  const double stiffest = coupling_gains(measured, settings_.rate_Hz).coupling.stiffness_N_per_m;
  const double stiffness = soft ? std::min(kSoftWall_N_per_m, 0.5 * stiffest) : stiffest;
  const SafetyLimits limits = soft ? small_limits() : limits_;
  if (auto over = ask(TouchTask::kPressDown, 2,
                      fmt::format("A floor of {:.3g} N/m lies 10 mm under the handle; it pushes up with at "
                                  "most {:.3g} N. Press onto it for a second.",
                                  stiffness, limits.max_force_N)))
    return *over;
  Displacement since;
  double pressed_s = 0.0, deepest_m = 0.0, sent_N = 0.0, delivered_N = 0.0;
  bool reported = false;
  if (auto over = serve(
          limits, settings_.patience_s,
          [&](const TouchFrame& now) -> std::optional<Wrench> {
            const double depth_m = -since.of(now.sample, false).z() - kFloorBelow_m;
            if (depth_m > 0.0) pressed_s += server_.period_s();
            deepest_m = std::max(deepest_m, depth_m);
            reported = reported || now.sample.has_delivered;
            sent_N += now.sent.f.z();
            delivered_N += now.sample.has_delivered ? now.sample.F_D_delivered.f.z() : 0.0;
            if (pressed_s > kPressed_s) return std::nullopt;
            return Wrench{Vec3(0.0, 0.0, std::max(0.0, stiffness * depth_m)), Vec3::Zero()};
          },
          false))
    return *over;
  std::string text =
      fmt::format("it was pressed in by {:.1f} mm, and {:.2f} N were sent", 1e3 * deepest_m, largest_N_);
  if (!reported) return good(text);
  text += fmt::format("; the device says that it exerted {:.0f} % of it", 100.0 * delivered_N / sent_N);
  return std::abs(delivered_N - sent_N) > kDelivered * sent_N ? bad(text + ". " + device_.trouble())
                                                              : good(text);
}

std::string Guide::pushed_text(const Vec3& moved, int axis, bool turns) const {
  const std::optional<ReadAxis> clear = clear_axis(moved);
  const std::string what = turns ? "a torque about " : "a force ";
  if (!clear) return what + direction_name({axis, 1.0}) + " moved the handle in no clear direction";
  return what + direction_name({axis, 1.0}) + (turns ? " turned the handle about " : " moved the handle ") +
         direction_name(*clear);
}

Outcome Guide::push(int axis, bool turns) {
  const double most = turns ? small_torque_Nm_ : small_force_N_;
  const double enough = turns ? kPushed_rad : kPushed_m;
  const double drift = turns ? kDrift_rad : kDrift_m;
  if (auto over =
          ask(TouchTask::kRelease, axis,
              fmt::format("Put the handle in the middle and let go. A {} {} grows to at most {:.3g} {} "
                          "and ends when the handle moves.",
                          turns ? "torque about" : "force", direction_name({axis, 1.0}), most,
                          turns ? "N m" : "N")))
    return *over;
  Displacement since;
  Vec3 moved = Vec3::Zero();
  bool drifts = false;
  double wanted = 0.0;
  if (auto over = serve(
          small_limits(), kSettle_s + 2.0 * kGrow_s,
          [&](const TouchFrame& now) -> std::optional<Wrench> {
            moved = since.of(now.sample, turns);
            const double growing_s = now.since_s - kSettle_s;
            drifts = drifts || (growing_s < 0.0 && moved.norm() > drift);
            if (drifts || moved.norm() > enough) return std::nullopt;
            wanted = most * std::clamp(growing_s / kGrow_s, 0.0, 1.0);
            const Vec3 along = wanted * Vec3::Unit(axis);
            return turns ? Wrench{Vec3::Zero(), along} : Wrench{along, Vec3::Zero()};
          },
          false))
    return *over;
  if (drifts) return bad("the handle moves by itself: its weight is not compensated, or somebody holds it");
  const std::optional<ReadAxis> clear = clear_axis(moved);
  const std::string text = pushed_text(moved, axis, turns);
  if (!clear || clear->axis != axis || clear->sign < 0.0) return bad(text);
  if (axis == 0) (turns ? moving_torque_Nm_ : moving_force_N_) = wanted;
  return good(text + fmt::format(", at {:.2g} {}", wanted, turns ? "N m" : "N"));
}

/// The pushes of the answer: forward until the handle has gone 6 mm, which took a time T; then back 2 T,
/// forward 2 T, back 2 T, forward T: without friction it is where it began, and at rest.
class Pulses {
 public:
  /// The sign of the force; nothing when the last pulse, and a while of coasting, are over.
  std::optional<double> sign(double since_s, double moved_m) {
    if (length_s_ == 0.0) {
      if (moved_m < kPulse_m && since_s < kLongestPulse_s) return 1.0;
      length_s_ = since_s;
    }
    const double pulses = since_s / length_s_;
    if (pulses < 3.0) return -1.0;
    if (pulses < 5.0) return 1.0;
    if (pulses < 7.0) return -1.0;
    if (pulses < 8.0) return 1.0;
    return since_s < 8.0 * length_s_ + kCoast_s ? std::optional(0.0) : std::nullopt;
  }

 private:
  double length_s_ = 0.0;  // of the first
};

/// A turn is pushed and measured as the motion of a point at the lever.
Outcome Guide::answer(bool turns) {
  const double lever_m = turns ? kResponseLever_m : 1.0;
  const double force_N =
      turns ? answer_torque_Nm() / lever_m : std::min(small_force_N_, moving_force_N_ + kBeyondFriction_N);
  const double farthest_m =
      turns ? kFarthest_m : std::min(kFarthest_m, kFarthestOfWorkspace * info_.workspace_radius_m);
  if (auto over = ask(TouchTask::kRelease, 0,
                      turns ? fmt::format("Put the handle in the middle and let go. It is turned to and fro "
                                          "by {:.2g} N m for a second, by a quarter of a turn at most; the "
                                          "damping of turning is measured.",
                                          force_N * lever_m)
                            : fmt::format("Put the handle in the middle and let go. It is pushed to and fro "
                                          "by {:.2g} N for a second, over a few centimetres at most; its "
                                          "damping and the delay are measured.",
                                          force_N)))
    return *over;
  Displacement since;
  Pulses pulses;
  std::vector<ResponseSample> samples;
  bool far = false;
  if (auto over = serve(
          small_limits(std::max(small_torque_Nm_, answer_torque_Nm())), kSettle_s + 9.0 * kLongestPulse_s,
          [&](const TouchFrame& now) -> std::optional<Wrench> {
            // The last frame's force is known now that safety has passed it.
            if (!samples.empty()) samples.back().force_N = turns ? now.sent.t.x() / lever_m : now.sent.f.x();
            const double x_m = lever_m * since.of(now.sample, turns).x();
            far = far || std::abs(x_m) > farthest_m;
            if (far) return std::nullopt;
            if (now.since_s < kSettle_s) return Wrench{};
            samples.push_back({now.now_s, x_m, 0.0});
            const std::optional<double> sign = pulses.sign(now.since_s - kSettle_s, x_m);
            if (!sign) return std::nullopt;
            const Vec3 push(*sign * force_N * lever_m, 0.0, 0.0);
            return turns ? Wrench{Vec3::Zero(), push} : Wrench{push, Vec3::Zero()};
          },
          false))
    return *over;
  if (!far) return measured(turns, samples);
  return bad(turns ? fmt::format("the handle turned by more than {:.1f} rad: something carries it along",
                                 farthest_m / lever_m)
                   : fmt::format("the handle went farther than {:.0f} mm: something carries it along",
                                 1e3 * farthest_m));
}

Outcome Guide::measured(bool turns, const std::vector<ResponseSample>& samples) {
  std::optional<double> known_delay_s;
  if (turns) known_delay_s = report_.response->delay_s;
  const Result<HandleResponse> response = fit_handle_response(samples, known_delay_s);
  if (!response) return bad(response.error().message());
  if (turns) {
    report_.turning = turn_response(*response);
    return good(fmt::format("damping {:.2g} +- {:.2g} N m s/rad, friction {:.2g} N m, inertia {:.3g} kg m^2",
                            report_.turning->damping_Nms_per_rad, report_.turning->damping_error_Nms_per_rad,
                            report_.turning->friction_Nm, report_.turning->inertia_kg_m2));
  }
  report_.response = *response;
  return good(
      fmt::format("delay {:.1f} ms, damping {:.2f} +- {:.2f} N s/m, friction {:.2f} N, mass {:.3f} kg",
                  1e3 * response->delay_s, response->damping_Ns_per_m, response->damping_error_Ns_per_m,
                  response->friction_N, response->mass_kg));
}

}  // namespace

TouchReport first_touch(Device& device, const TouchPlanSettings& settings, TouchPerson& person,
                        TouchClock& clock) {
  return Guide(device, settings, person, clock).run();
}

std::string direction_name(const ReadAxis& direction) {
  static constexpr const char* kNames[2][3] = {{"toward you (+x)", "to the right (+y)", "up (+z)"},
                                               {"away from you (-x)", "to the left (-y)", "down (-z)"}};
  return kNames[direction.sign < 0.0 ? 1 : 0][direction.axis];
}

std::optional<ReadAxis> clear_axis(const Vec3& v) {
  constexpr double kClear = 0.8;
  int axis = 0;
  const double most = v.cwiseAbs().maxCoeff(&axis);
  if (!(most > kClear * v.norm())) return {};
  return ReadAxis{axis, v(axis) < 0.0 ? -1.0 : 1.0};
}

std::string axes_fault(const std::array<ReadAxis, 3>& read) {
  std::string flipped, swapped;
  for (int i = 0; i < 3; ++i) {
    const ReadAxis& as = read[static_cast<std::size_t>(i)];
    if (as.axis != i)
      swapped +=
          (swapped.empty() ? "" : ", ") + direction_name({i, 1.0}) + " was read as " + direction_name(as);
    else if (as.sign < 0.0)
      flipped += (flipped.empty() ? "" : " and ") + std::string(1, "xyz"[i]);
  }
  std::string text;
  if (!flipped.empty()) text = "the axis " + flipped + " is flipped";
  if (!swapped.empty()) text += (text.empty() ? "" : "; ") + ("axes are swapped: " + swapped);
  return text;
}

}  // namespace tactum::inline v0_1
