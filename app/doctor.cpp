/// tactum doctor: whether this machine and its devices let the loop run on time, and what helps where not.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "commands.h"
#include "tactum/drivers/registry.h"
#include "tactum/loop/machine.h"

namespace tactum {
namespace {

struct DoctorOptions {
  std::string device;
  double rate_Hz = 1000.0;
  double duration_s = 3.0;
  std::string json;
  bool install_limits = false;
  bool print_limits = false;
};

const char* word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kBetter:
      return "could be better";
    case Verdict::kBad:
      return "bad";
  }
  return "";
}

void print(const MachineFinding& finding) {
  fmt::print("{: <16} {: <28} {}\n", word_of(finding.verdict), finding.subject, finding.found);
  if (!finding.cure.empty()) fmt::print("{: <45} {}\n", "", finding.cure);
}

nlohmann::ordered_json as_json(const MachineFinding& finding) {
  return {{"subject", finding.subject},
          {"verdict", word_of(finding.verdict)},
          {"found", finding.found},
          {"cure", finding.cure}};
}

/// A device that cannot be used: its error has the cure in what was expected.
MachineFinding of_error(const std::string& device, const Error& error) {
  return {device, Verdict::kBad, error.found.empty() ? error.what : error.what + ": " + error.found,
          error.expected.empty() ? error.where : "What helps: " + error.expected + "."};
}

/// The device with its motors on and no wrench.
MachineFinding measured_device(const DoctorOptions& options) {
  Result<std::unique_ptr<Device>> device = make_device(options.device, {});
  if (!device) return of_error(options.device, device.error());
  const Result<LoopMeasure> measure = measure_loop(**device, options.rate_Hz, options.duration_s);
  if (!measure) return of_error(options.device, measure.error());
  MachineFinding finding = judge_device(*measure, (*device)->info(), options.rate_Hz);
  if (finding.verdict != Verdict::kGood && !(*device)->trouble().empty()) finding.cure = (*device)->trouble();
  return finding;
}

void install_limits() {
  std::ofstream file(kLimitsPath);
  file << realtime_limits();
  file.close();
  if (!file)
    fail({"the limits cannot be written", "no right to", "sudo tactum doctor --install-limits", kLimitsPath});
  fmt::print("{} is written. Members of the group plugdev have them when they log in anew.\n", kLimitsPath);
}

void examine(const DoctorOptions& options) {
  std::vector<MachineFinding> findings = examine_machine();
  findings.push_back(judge_wake_ups(measure_wake_ups(options.rate_Hz, options.duration_s), options.rate_Hz));
  if (!options.device.empty()) findings.push_back(measured_device(options));
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MachineFinding& finding : findings) {
    if (options.json != "-") print(finding);
    json.push_back(as_json(finding));
  }
  if (!options.json.empty()) write_json(options.json, json);
  const auto bad = [](const MachineFinding& finding) { return finding.verdict == Verdict::kBad; };
  if (std::any_of(findings.begin(), findings.end(), bad)) end_with(2);
}

}  // namespace

void add_doctor(CLI::App& app) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor", "Say whether this machine lets the loop run on time, and what helps; 2 when it does not");
  command->add_option("--device", options->device,
                      "Measure this device too: its motors are switched on, no wrench is sent");
  command->add_option("--rate", options->rate_Hz, "The rate of the loop that is measured [Hz]")
      ->check(number_between(10.0, 100'000.0, "a rate of the loop in Hz"));
  command->add_option("--duration", options->duration_s, "Measure so long [s]")
      ->check(number_between(0.1, 3600.0, "a duration in seconds"));
  command->add_option("--json", options->json, "Write the findings to this file (- for stdout)");
  CLI::Option* install =
      command->add_flag("--install-limits", options->install_limits,
                        "Write the limits that let users' loops run in real time, and do nothing else");
  command->add_flag("--print-limits", options->print_limits, "Print those limits, and write nothing")
      ->excludes(install);
  command->callback([options] {
    if (options->print_limits)
      fmt::print("# {}\n{}", kLimitsPath, realtime_limits());
    else if (options->install_limits)
      install_limits();
    else
      examine(*options);
  });
}

}  // namespace tactum
