#include "tactum/recording/export_csv.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>

#include "tactum/recording/recording_visitor.h"

namespace tactum::inline v0_1 {
namespace {

/// One line, whatever is in it.
std::string in_a_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

std::string csv_head(const RunHead& head) {
  std::string text = fmt::format(
      "# recording of tactum {}\n# scene: {}\n# device: {}\n# rate_Hz: {}\n# date: {}\n"
      "# axes: of the world; wrenches act on the hand, at the handle; device_* is in the frame of the "
      "device\n"
      "# units: the end of a column's name; a column without one is a count, a flag or a quaternion's part\n",
      in_a_line(head.version), in_a_line(head.scene), in_a_line(head.device.name), 1.0 / head.dt_s,
      in_a_line(head.date));
  for (std::size_t i = 0; i < head.other_devices.size(); ++i)
    text += fmt::format("# device of hand {}: {}\n", i + 2, in_a_line(head.other_devices[i].name));
  for (const auto& [key, value] : head.settings)
    text += fmt::format("# setting {} = {}\n", in_a_line(key), setting_text(key, value));
  for (const TraceColumn& column : head.columns)
    text += fmt::format("# column {}: {}\n", in_a_line(column.name), in_a_line(column.meaning));
  for (std::size_t i = 0; i < head.columns.size(); ++i)
    text += (i == 0 ? "" : ",") + in_a_line(head.columns[i].name);
  return text + "\n";
}

class CsvWriting final : public RecordingVisitor {
 public:
  CsvWriting(const std::string& name, std::FILE* out) : RecordingVisitor(name), out_(out) {}
  std::uint64_t rows = 0;
  std::optional<Error> cannot;

 private:
  Result<void> begin(Files) override { return put(csv_head(head())); }
  Result<void> row(const std::vector<double>& numbers) override {
    fmt::memory_buffer text;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      fmt::format_to(std::back_inserter(text), "{}{}", i == 0 ? "" : ",", numbers[i] + 0.0);
    text.push_back('\n');
    ++rows;
    return put({text.data(), text.size()});
  }
  Result<void> put(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), out_) == text.size()) return {};
    cannot = Error{"cannot write the whole table", std::strerror(errno), "room on the disk", ""};
    return *cannot;
  }

  std::FILE* out_;
};

}  // namespace

Result<CsvExport> export_csv(const McapSource& source, const std::string& name, std::FILE* out) {
  CsvWriting writing(name, out);
  McapEnd end = read_recording(source, writing);
  if (writing.cannot) return *writing.cannot;
  if (!writing.begun()) return *end.wrong;
  if (std::fflush(out) != 0)
    return Error{"cannot write the whole table", std::strerror(errno), "room on the disk", ""};
  return CsvExport{writing.rows, std::move(end)};
}

}  // namespace tactum::inline v0_1
