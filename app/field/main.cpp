/// `tactum-field IMAGE.vti -o FIELD.toml`: VTK image data as a force field that scenes take. A program of its
/// own, since VTK is larger than all the rest together.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/manual.h"
#include "tactum/scene/field_file.h"
#include "vtk_image.h"

int main(int argc, char** argv) {
  using namespace tactum;
  CLI::App app("Turn VTK image data into a force field for scenes.", "tactum-field");
  std::string input;
  std::string output;
  VtkOptions options;
  app.add_option("IMAGE", input, ".vti image data, or .vtk structured points")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("-o,--output", output, "The header to write (.toml); the numbers go beside it")->required();
  app.add_option("--array", options.array, "Which point data; otherwise the only vectors there are");
  app.add_option("--metres-per-unit", options.metres_per_unit, "Of the image's spacing and origin [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--newtons-per-unit", options.newtons_per_unit, "Of its vectors [N]")->capture_default_str();
  if (print_manual(app, argc, argv)) return 0;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const Result<VtkField> field = read_vtk_image(input, options);
  const Result<void> written = field ? write_field_file(output, field->grid.shape(), field->grid.samples())
                                     : Result<void>(field.error());
  if (!written) {
    fmt::print(stderr, "tactum-field: {}\n", written.error().message());
    return 1;
  }
  const GridShape& shape = field->grid.shape();
  fmt::print("\"{}\": {} x {} x {} nodes, {:.4g} x {:.4g} x {:.4g} m apart, up to {:.3g} N/m steep\n",
             field->array, shape.nodes[0], shape.nodes[1], shape.nodes[2], shape.spacing.x(),
             shape.spacing.y(), shape.spacing.z(), field->grid.steepest());
  fmt::print("next: in a scene, [[field]] kind = \"grid\", file = \"{}\"\n", output);
  return 0;
}
