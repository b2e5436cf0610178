/// tactum-bench stability: the stiffest walls that the simulated devices hold. What is measured, and how, is
/// in bench/stability.h.

#include <fmt/format.h>

#include <algorithm>

#include "bench/main/commands.h"
#include "bench/pairs_plot.h"
#include "bench/port_controllers.h"
#include "bench/report.h"
#include "bench/stability.h"

namespace tactum {
namespace {

struct StabilityJob {
  bench::StabilityOptions options;
  std::string json, svg;
  bool release = false;
  bool controllers = false;
};

/// Every preset, pressed and let go of.
void run_release(const StabilityJob& job) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  if (job.json != "-")
    fmt::print("{:<18}{:>10}{:>12}{:>10}{:>14}{:>14}{:>14}{:>14}\n", "device", "pressed N", "peak m/s",
               "rest s", "travelled mm", "largest step N", "slew limit N", "stiffness %");
  for (const SimulatedDeviceModel& device : simulated_device_presets()) {
    if (!job.options.devices.empty() && std::find(job.options.devices.begin(), job.options.devices.end(),
                                                  device.name) == job.options.devices.end())
      continue;
    const bench::ReleaseRow row = bench::release_pressed(device);
    json.push_back(to_json(row));
    if (job.json != "-")
      fmt::print("{:<18}{:>10.2f}{:>12.3f}{:>10}{:>14.1f}{:>14.3f}{:>14.3f}{:>14.0f}\n", row.device,
                 row.pressed_N, row.peak_m_per_s, row.at_rest ? fmt::format("{:.2f}", row.rest_s) : "never",
                 1e3 * row.travelled_m, row.largest_step_N, row.slew_limit_N, 100.0 * row.least_share);
  }
  if (!job.json.empty()) write_json(job.json, json);
}

void run_controllers(const StabilityJob& job) {
  const std::vector<bench::ControllerRow> rows =
      bench::bench_controllers([](const std::string& what) { fmt::print(stderr, "{}\n", what); });
  if (job.json != "-") fmt::print("{}", table_of(rows).text());
  if (job.json.empty()) return;
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const bench::ControllerRow& row : rows) json.push_back(to_json(row));
  write_json(job.json, json);
}

void run_stability(const StabilityJob& job) {
  if (job.controllers) return run_controllers(job);
  if (job.release) return run_release(job);
  const Result<std::vector<bench::WallRow>> rows =
      bench_stability(job.options, [](const std::string& device) { fmt::print(stderr, "{}\n", device); });
  if (!rows) fail(rows.error());
  if (job.json != "-") {
    fmt::print("{:<17}{:<8}{:<9}{:>7}{:>9}{:>12}{:>12}{:>12}{:>12}\n", "device", "hand", "wall", "kHz",
               "delay ms", "alone", "bound", "no energy", "at rest");
    for (const bench::WallRow& row : *rows)
      fmt::print("{:<17}{:<8}{:<9}{:>7g}{:>9g}{:>12.4g}{:>12.4g}{:>12.4g}{:>12.4g}\n", row.device, row.hand,
                 row.turning ? "turning" : "plane", row.rate_Hz / 1000, row.delay_s * 1000, row.alone,
                 row.bound, row.passive, row.at_rest);
  }
  if (!job.json.empty()) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const bench::WallRow& row : *rows) json.push_back(to_json(row));
    write_json(job.json, json);
  }
  if (!job.svg.empty() && !bench::write_text(job.svg, bench::z_width_plot(*rows)))
    fail({"cannot write the file", "", "", job.svg});
}

}  // namespace

void add_bench_stability(CLI::App& parent) {
  auto job = std::make_shared<StabilityJob>();
  CLI::App* command = parent.add_subcommand(
      "stability", "The stiffest walls that simulated devices hold in a hand, beside the passivity bound");
  command->add_option("--device", job->options.devices, "a preset, several times; by default all");
  command->add_option("--rate", job->options.rates_Hz, "of the loop [Hz]")->check(CLI::Range(100.0, 10000.0));
  command->add_option("--delay", job->options.delays_s, "from command to motor [s]")
      ->check(CLI::Range(0.0, SimulatedDevice::kMaxDelay_s));
  command->add_flag("--controllers", job->controllers,
                    "instead, ways to keep a spring that is too stiff from swinging, side by side");
  command->add_flag("--let-go", job->release, "instead, what the handle does when a hand that presses opens");
  command->add_option("--json", job->json, "write the rows to this file (- for standard output)");
  command->add_option("--svg", job->svg, "draw them into this file");
  command->callback([job] { run_stability(*job); });
}

}  // namespace tactum
