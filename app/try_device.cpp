#include "try_device.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "commands.h"
#include "tactum/devices/hand_model.h"
#include "tactum/drivers/registry.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/session/device_profile.h"
#include "tactum/session/rehearsal.h"
#include "watch.h"

namespace tactum {
namespace {

constexpr double kTryRate_Hz = 1000.0;

void say(const std::string& text) {
  fmt::print("{}\n", text);
  std::fflush(stdout);
}

/// Reads lines from a terminal without waiting: ENTER goes on, a line that begins with q stops, and so does
/// Ctrl-C. With --yes every question is answered at once.
class TerminalPerson final : public TouchPerson {
 public:
  explicit TerminalPerson(bool yes) : yes_(yes) {}

  void report(const std::string& sentence) override { say("  " + sentence); }
  void ask(const TouchRequest& request) override {
    say("\n" + request.text + (yes_ ? "" : "  [ENTER: go on, q: stop]"));
    go_on_ = yes_;
  }
  Word heard() override {
    if (interrupted()) return Word::kStop;
    if (go_on_) {
      go_on_ = false;
      return Word::kGoOn;
    }
    if (yes_) return Word::kNothing;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, 0) <= 0) return Word::kNothing;
    char text[64];
    const ssize_t length = read(STDIN_FILENO, text, sizeof text);
    return length <= 0 || text[0] == 'q' || text[0] == 'Q' ? Word::kStop : Word::kGoOn;
  }

 private:
  bool yes_;
  bool go_on_ = false;
};

/// The same, and the simulated hand does what is asked.
class RehearsalPerson final : public TouchPerson {
 public:
  RehearsalPerson(RehearsedDevice& device, bool yes) : device_(device), terminal_(yes) {}

  void report(const std::string& sentence) override { terminal_.report(sentence); }
  void ask(const TouchRequest& request) override {
    device_.obey(request);
    terminal_.ask(request);
  }
  Word heard() override { return terminal_.heard(); }

 private:
  RehearsedDevice& device_;
  TerminalPerson terminal_;
};

void sum_up_touch(const TouchReport& report) {
  say(fmt::format("\nThe largest force that was sent is {:.2f} N, the largest torque {:.3f} N m.",
                  report.largest_N, report.largest_Nm));
  if (!report.passed) say("Not passed: " + report.ended_by + ".");
}

/// Keeps what was measured, and says what it makes of the coupling.
void keep_profile(const DeviceInfo& info, const TouchReport& report, const std::string& asked) {
  if (!report.passed || !report.response) return say("No profile is written.");
  if (!info.is_hardware && asked.empty())
    return say("Passed. This was a rehearsal: no profile is written without --profile FILE.");
  const std::string path = asked.empty() ? profile_path(info) : asked;
  if (path.empty()) fail({"there is no folder for the profile", "no HOME", "--profile FILE", ""});
  const DeviceProfile profile = profile_of(info, *report.response, report.turning);
  if (const Result<void> written = write_profile(path, profile); !written) fail(written.error());
  const DeviceInfo known = with_profile(info, profile);
  say(fmt::format("Passed. {} is written{}. {}", path,
                  asked.empty() ? ", and tactum feel uses it from now on" : "",
                  margin_sentence(coupling_gains(known, kTryRate_Hz).coupling, known, kTryRate_Hz)));
}

TouchPlanSettings plan_of(const TryOptions& options) {
  TouchPlanSettings plan;
  plan.rate_Hz = kTryRate_Hz;
  plan.patience_s = options.patience_s;
  return plan;
}

TouchReport rehearsed(const SimulatedDeviceModel& model, const TryOptions& options, DeviceInfo& info) {
  const Result<HandModel> hand = hand_model("medium");
  if (!hand) fail(hand.error());
  RehearsedDevice device(model, *hand);
  info = device.info();
  RehearsalPerson person(device, options.yes);
  RehearsalClock virtual_clock;
  SteadyTouchClock steady;  // where a person reads along, things take their time
  TouchClock& clock = options.yes ? static_cast<TouchClock&>(virtual_clock) : steady;
  return first_touch(device, plan_of(options), person, clock);
}

}  // namespace

void try_device(const TryOptions& options) {
  if (!options.yes && isatty(STDIN_FILENO) == 0)
    fail({"every step of the first touch asks before it begins", "no terminal", "a terminal, or --yes",
          options.device});
  watch_for_interrupts();
  DeviceInfo info;
  TouchReport report;
  const std::string name = listed_device_name(options.device);
  if (name == "simulated" || name.starts_with("simulated:")) {
    const Result<SimulatedDeviceModel> model =
        simulated_device_preset(name == "simulated" ? "premium-1.5-6dof" : name);
    if (!model) fail(model.error());
    say("A rehearsal: the device is simulated, and its hand does what you are asked.");
    report = rehearsed(*model, options, info);
  } else {
    Result<std::unique_ptr<Device>> device = make_device(name, {});
    if (!device) fail(device.error());
    info = (*device)->info();
    if (!info.is_hardware)
      fail(
          {"only real and simulated devices can be tried", name, "a connected one, or simulated:PRESET", ""});
    say(fmt::format(
        "{}{}: at most {:.3g} N and {:.3g} N m. Keep its stop in reach; q or Ctrl-C ends with zero "
        "force.",
        info.name, info.serial.empty() ? "" : ", serial " + info.serial, info.max_force_N,
        info.max_torque_Nm));
    TerminalPerson person(options.yes);
    SteadyTouchClock clock;
    report = first_touch(**device, plan_of(options), person, clock);
  }
  sum_up_touch(report);
  keep_profile(info, report, options.profile);
  if (!report.passed) end_with(2);
}

}  // namespace tactum
