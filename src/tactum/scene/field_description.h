#pragma once
/// The force fields of a scene, as values in memory.

#include <optional>
#include <string>
#include <variant>

#include "tactum/dynamics/analytic_field.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The numbers of a grid are kept in this precision.
enum class SampleType { kFloat32, kFloat64 };

/// A formula as values on a grid about the field's middle.
struct SampledGrid {
  int nodes = 0;               ///< along each side, 2 to 512 [-]
  Vec3 size_m = Vec3::Zero();  ///< of the box of the nodes [m]
  SampleType type = SampleType::kFloat32;
};

struct DipoleDescription {
  static constexpr const char* kKind = "dipole";
  DipoleField formula = {};
  std::optional<SampledGrid> sampled = {};
};

struct WellDescription {
  static constexpr const char* kKind = "well";
  WellField formula = {};
  std::optional<SampledGrid> sampled = {};
};

struct VortexDescription {
  static constexpr const char* kKind = "vortex";
  VortexField formula = {};
  std::optional<SampledGrid> sampled = {};
};

struct GridDescription {
  static constexpr const char* kKind = "grid";
  std::string file = {};  ///< the header of a field file (field_file.h), see SceneSource::folders
};

struct FieldDescription {
  std::variant<DipoleDescription, WellDescription, VortexDescription, GridDescription> shape = {};
  Pose X_WF = {};                                ///< where the field is [m]
  double scale = 1.0;                            ///< [-]
  std::optional<double> largest_force_N = {};    ///< on a body; no limit when absent [N]
  std::optional<double> largest_torque_Nm = {};  ///< about its centre of mass; no limit when absent [N m]
  std::optional<double> edge_m = {};             ///< of a grid; one spacing when absent or 0 [m]
};

}  // namespace tactum::inline v0_1
