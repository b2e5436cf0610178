/// `tactum-step PART.step -o PART.obj`: CAD files in STEP as triangles that `tactum prepare` takes. A program
/// of its own, since OpenCASCADE is as large as all the rest together.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "app/manual.h"
#include "step_mesh.h"

int main(int argc, char** argv) {
  using namespace tactum;
  CLI::App app("Triangulate a STEP file for `tactum prepare`.", "tactum-step");
  std::string input;
  std::string output;
  double deviation_mm = 0.0;
  double angle_deg = 180.0 / kPi * StepOptions().angle_rad;
  app.add_option("STEP", input, "AP203, AP214 or AP242")->required()->check(CLI::ExistingFile);
  app.add_option("-o,--output", output, "The OBJ to write, in metres, an object for each body")->required();
  app.add_option("--deviation", deviation_mm,
                 "How far triangles may be from the exact surface [mm]; otherwise 1e-4 of the diagonal")
      ->check(CLI::PositiveNumber);
  app.add_option("--angle", angle_deg, "Between neighbouring facets of a curve, at most [deg]")
      ->check(CLI::Range(0.1, 90.0))
      ->capture_default_str();
  if (print_manual(app, argc, argv)) return 0;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const Result<StepMesh> step = read_step(input, {1e-3 * deviation_mm, kPi / 180.0 * angle_deg});
  const Result<void> written = step ? write_obj(output, *step) : Result<void>(step.error());
  if (!written) {
    fmt::print(stderr, "tactum-step: {}\n", written.error().message());
    return 1;
  }
  for (std::size_t b = 0; b < step->bodies.size(); ++b)
    fmt::print("body_{}: {}, {} faces, {} triangles\n", b + 1,
               step->bodies[b].solid ? "a solid" : "an open shell", step->bodies[b].faces,
               step->bodies[b].triangles);
  fmt::print("deviation {:.3g} mm at most where it was measured ({:.3g} mm asked)\n", 1e3 * step->deviation_m,
             1e3 * step->asked_deviation_m);
  fmt::print("next: tactum prepare {} --units m -o PART\n", output);
  return 0;
}
