#pragma once
/// What counts for a whole MJCF file: the compiler's settings, the classes of defaults, orientations in
/// every spelling. For src/tactum/import/*.cpp only.

#include <map>
#include <string>
#include <vector>

#include "tactum/import/import_log.h"
#include "tactum/import/import_model.h"

namespace tactum::inline v0_1 {

/// <compiler>, as far as anything that is felt depends on it.
struct MjcfCompiler {
  double radians_per_unit = kPi / 180.0;  ///< of angles in the file
  std::string euler_sequence = "xyz";
  std::string mesh_folder = {};  ///< "meshdir", else "assetdir"
  bool strips_paths = false;
  bool limits_by_range = true;          ///< "autolimits"
  int least_group = 0, most_group = 5;  ///< of geoms that weigh
  MassRules masses = {};
};

MjcfCompiler read_compiler(const XmlElement& mujoco, ImportLog& log);

/// The tree of <default> classes.
class MjcfDefaults {
 public:
  MjcfDefaults(const XmlElement& mujoco, ImportLog& log);

  /// An element with its defaults: those of its own class, else of the class of its bodies, and of the
  /// classes these stand in. `name` is that of the element in <default>.
  Attributes of(const XmlElement& element, const std::string& childclass, ImportLog& log) const;

 private:
  struct Class {
    std::string parent;
    std::vector<const XmlElement*> elements;
  };
  void add(const XmlElement& element, const std::string& parent, ImportLog& log);
  std::map<std::string, Class> classes_;
};

/// Puts the content of included files in place of each <include>. Files are seen from `folder`.
void include_files(XmlElement& mujoco, const std::string& folder, ImportLog& log);

/// The rotation that quat, axisangle, euler, xyaxes or zaxis gives; the nearest layer that has one counts.
Mat3 rotation_of(const Attributes& attributes, const MjcfCompiler& compiler);

/// The shortest rotation that takes z to the direction, which is not zero.
Mat3 rotation_to(const Vec3& z);

}  // namespace tactum::inline v0_1
