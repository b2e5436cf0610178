#pragma once
/// STEP files on the command line: the program `tactum-step`, which is there where OpenCASCADE is
/// installed, makes meshes of them.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tactum/base/result.h"

namespace tactum {

/// Whether the name ends in .step or .stp.
bool is_step_name(const std::string& name);

/// A length with its unit, "20um", "0.02 mm", "1e-5m", in metres.
Result<double> length_with_unit(const std::string& text);

/// Meshes of STEP files, in a folder that goes with the object.
class StepMeshes {
 public:
  StepMeshes() = default;
  ~StepMeshes();
  StepMeshes(const StepMeshes&) = delete;
  StepMeshes& operator=(const StepMeshes&) = delete;

  /// Triangulates the files, with a chord error of a twentieth of the fit where one is asked for [m], and
  /// returns a mesh in metres for each. An error says where tactum-step was searched, or what it said.
  Result<std::vector<std::string>> make(const std::vector<std::string>& files, std::optional<double> fit_m);

  /// What was triangulated and how finely, in lines.
  const std::string& report() const { return report_; }

 private:
  std::filesystem::path folder_;
  std::string report_;
};

}  // namespace tactum
