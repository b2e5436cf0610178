/// tactum report FILE: a recording as a page with charts, tables and numbers.

#include "app/report/report_page.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"

namespace tactum {
namespace {

struct ReportCommand {
  std::vector<std::string> files;
  std::string out;
  bool compare = false;
};

/// "runs/gears.mcap" becomes "gears.html", in the folder where the command is called.
std::string page_name(const std::string& recording) {
  return std::filesystem::path(recording).stem().string() + ".html";
}

void report_files(const ReportCommand& command) {
  if (command.compare != (command.files.size() == 2))
    fail({"another number of recordings", fmt::format("{}", command.files.size()),
          command.compare ? "two with --compare" : "one, or two with --compare", ""});
  const std::string out = command.out.empty() ? page_name(command.files.front()) : command.out;
  check_writable(out);
  std::vector<RunFigures> runs;
  bool damaged = false;
  for (const std::string& path : command.files) {
    const Result<McapFile> file = McapFile::open(path);
    if (!file) fail(file.error());
    Result<RunFigures> run = figures_of(*file, path);
    if (!run) fail(run.error());
    damaged = damaged || (!run->end.complete && !run->end.cut);
    runs.push_back(std::move(*run));
  }
  write_text(out, report_page(runs));
  fmt::print(stderr, "the report is in {}\n", out);
  if (damaged) end_with(1);
}

}  // namespace

void add_report(CLI::App& app) {
  auto options = std::make_shared<ReportCommand>();
  CLI::App* command =
      app.add_subcommand("report", "Write a page with the charts, tables and numbers of a recording");
  command->footer(
      "Exit codes: 0 done, 1 an error or a damaged file, 2 the command line is wrong. A recording that was "
      "cut short is reported as far as it goes.");
  command->add_option("FILE", options->files, "A recording of tactum feel --record; with --compare two")
      ->required()
      ->expected(1, 2);
  command->add_flag("--compare", options->compare,
                    "Put two recordings side by side: charts with the same axes, and the differences");
  command->add_option("-o,--out", options->out,
                      "The page to write; by default the recording's name with .html, in this folder");
  command->callback([options] { report_files(*options); });
}

}  // namespace tactum
