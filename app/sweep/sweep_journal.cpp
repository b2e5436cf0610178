#include "app/sweep/sweep_journal.h"

#include <fmt/format.h>
#include <sys/file.h>

#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tactum/recording/crc32.h"

namespace tactum {
namespace {

std::string head_line(const SweepPlan& plan) {
  return fmt::format("tactum sweep journal 1, plan {:016x}, {} runs", plan.hash, plan.runs());
}

/// Takes a hexadecimal number and the blank behind it off a line.
bool take_hex(std::string_view& line, std::uint64_t& number) {
  const auto read = std::from_chars(line.data(), line.data() + line.size(), number, 16);
  if (read.ec != std::errc() || read.ptr == line.data() + line.size() || *read.ptr != ' ') return false;
  line.remove_prefix(static_cast<std::size_t>(read.ptr - line.data()) + 1);
  return true;
}

Error cannot_write(const std::string& path) {
  return {"cannot write the runs of the sweep", std::strerror(errno), "room on the disk", path};
}

}  // namespace

std::string result_line(const SweepResult& result) {
  std::string line = fmt::format("{:x} {:016x} ", result.run, result.hash);
  for (const double number : result.numbers)
    line += fmt::format("{:016x} ", std::bit_cast<std::uint64_t>(number));
  for (const char c : result.error) line += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return fmt::format("{:08x} {}", crc32(line), line);
}

std::optional<SweepResult> result_of_line(std::string_view line) {
  SweepResult result;
  std::uint64_t sum = 0, bits = 0;
  if (!take_hex(line, sum) || sum != crc32(line)) return {};
  if (!take_hex(line, result.run) || !take_hex(line, result.hash)) return {};
  for (double& number : result.numbers) {
    if (!take_hex(line, bits)) return {};
    number = std::bit_cast<double>(bits);
  }
  result.error = line;
  return result;
}

Result<SweepJournal> SweepJournal::open(const std::string& path, const SweepPlan& plan) {
  std::FILE* file = std::fopen(path.c_str(), "ab");
  if (file == nullptr) return cannot_write(path);
  SweepJournal journal(path, file);
  // Held until the file is closed, also by a kill. What is written before another one has ended would be cut.
  if (flock(fileno(file), LOCK_EX | LOCK_NB) != 0)
    return Error{"another process is at work on this sweep", "", "one at a time, or another --out", path};
  std::ostringstream text;
  if (std::ifstream stream(path, std::ios::binary); stream) text << stream.rdbuf();
  const std::string content = text.str(), head = head_line(plan) + "\n";
  std::map<std::uint64_t, SweepResult> done;
  std::size_t good = 0;
  // A journal that was cut within its first line is begun anew.
  if (!content.empty() && !head.starts_with(content) && !content.starts_with(head))
    return Error{"the runs of another sweep are kept here", content.substr(0, content.find('\n')),
                 head_line(plan) + "; the sweep or its scene was changed: --anew computes all of it", path};
  if (content.starts_with(head)) good = head.size();
  while (good > 0) {
    const std::size_t end = content.find('\n', good);
    if (end == std::string::npos) break;
    const std::optional<SweepResult> result =
        result_of_line(std::string_view(content).substr(good, end - good));
    if (!result || result->run >= plan.runs()) break;
    done[result->run] = *result;
    good = end + 1;
  }
  std::error_code failure;
  if (!content.empty()) std::filesystem::resize_file(path, good, failure);
  if (failure) return cannot_write(path);
  journal.done_ = std::move(done);
  if (good == 0 && (std::fputs(head.c_str(), file) < 0 || std::fflush(file) != 0)) return cannot_write(path);
  return journal;
}

Result<void> SweepJournal::add(const SweepResult& result) {
  done_[result.run] = result;
  const std::string line = result_line(result) + "\n";
  if (std::fwrite(line.data(), 1, line.size(), file_.get()) != line.size() || std::fflush(file_.get()) != 0)
    return cannot_write(path_);
  return {};
}

std::vector<std::uint64_t> SweepJournal::pending(const SweepPlan& plan) const {
  std::vector<std::uint64_t> runs;
  for (std::uint64_t run = 0; run < plan.runs(); ++run)
    if (!done_.contains(run)) runs.push_back(run);
  return runs;
}

void SweepJournal::remove() {
  file_.reset();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace tactum
