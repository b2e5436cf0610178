/// tactum export FILE: a recording for other programs.

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "app/hdf5/export_hdf5.h"
#include "commands.h"
#include "tactum/recording/export_csv.h"

namespace tactum {
namespace {

struct ExportCommand {
  std::string file;
  std::string csv;
  std::string hdf5;
};

struct CloseTable {
  void operator()(std::FILE* out) const {
    if (out != stdout) std::fclose(out);
  }
};

/// Prints how far the recording went, and ends the command where it is damaged.
void report_export(std::uint64_t frames, const std::string& out, const McapEnd& end) {
  fmt::print(stderr, "{} frames in {}\n", frames, out);
  if (!end.complete)
    fmt::print(stderr, "{} {}\n", end.cut ? "The recording has no end:" : "The recording is damaged:",
               end.wrong ? end.wrong->message() : "");
  if (!end.complete && !end.cut) end_with(1);
}

void export_table(const McapFile& file, const ExportCommand& command) {
  const bool to_output = command.csv == "-";
  const std::unique_ptr<std::FILE, CloseTable> out(to_output ? stdout : std::fopen(command.csv.c_str(), "w"));
  if (!out) fail({"cannot write the table", std::strerror(errno), "a file that can be written", command.csv});
  const Result<CsvExport> exported = export_csv(file, command.file, out.get());
  if (!exported) fail(exported.error());
  report_export(exported->rows, to_output ? "the table" : command.csv, exported->end);
}

void export_file(const ExportCommand& command) {
  const Result<McapFile> file = McapFile::open(command.file);
  if (!file) fail(file.error());
  if (!command.csv.empty()) export_table(*file, command);
  if (command.hdf5.empty()) return;
  const Result<Hdf5Export> exported = export_hdf5(*file, command.file, command.hdf5);
  if (!exported) fail(exported.error());
  report_export(exported->rows, command.hdf5, exported->end);
}

}  // namespace

void add_export(CLI::App& app) {
  auto options = std::make_shared<ExportCommand>();
  CLI::App* command = app.add_subcommand("export", "Write a recording for other programs");
  command->add_option("FILE", options->file, "A recording of tactum feel --record")->required();
  CLI::Option_group* forms = command->add_option_group("forms", "At least one of these");
  forms->add_option("--csv", options->csv,
                    "Write every frame to this CSV file (- for standard output), a column for each quantity");
  forms->add_option("--hdf5", options->hdf5,
                    "Write every frame and contact to this HDF5 file, with units and frames as attributes");
  forms->require_option(1, 2);
  command->callback([options] { export_file(*options); });
}

}  // namespace tactum
