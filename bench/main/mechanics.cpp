/// tactum-bench mechanics: cases with a closed form, in both responses and beside other engines. What is
/// measured, and how, is in bench/mechanics.h.

#include "bench/mechanics.h"

#include <fmt/format.h>

#include "bench/main/commands.h"

namespace tactum {

void add_bench_mechanics(CLI::App& parent) {
  auto page = std::make_shared<std::string>();
  CLI::App* command = parent.add_subcommand(
      "mechanics", "Cases with a closed form, in both responses and beside other engines");
  command->add_option("--write", *page,
                      "write the table to this file, between its marks (docs/mechanics.md)");
  command->callback([page] {
    const bench::Table table =
        bench::mechanics_table([](const std::string& name) { fmt::print(stderr, "{}\n", name); });
    fmt::print("{}", table.text());
    if (!page->empty() && !bench::write_between_marks(*page, "mechanics", table.markdown()))
      fail({"cannot write the file", "", "", *page});
  });
}

}  // namespace tactum
