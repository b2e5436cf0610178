#pragma once
/// The geoms of MJCF, and the meshes they name. For src/tactum/import/*.cpp only.

#include <map>
#include <optional>
#include <string>

#include "tactum/import/mjcf_settings.h"

namespace tactum::inline v0_1 {

/// <asset><mesh>.
class MjcfMeshes {
 public:
  MjcfMeshes(const XmlElement& mujoco, const std::string& folder, const MjcfCompiler& compiler,
             const MjcfDefaults& defaults, ImportLog& log);

  /// Makes the shape the mesh of this name; its pose, that of the geom, becomes that of the file's numbers.
  /// False, and no error, when there is none.
  bool place(const std::string& name, ModelShape& shape) const;
  std::vector<std::string> names() const;

 private:
  struct Asset {
    std::string path;
    Vec3 scale = Vec3::Ones();
    Pose X_GF;  ///< the frame of the scaled file in the geom's
  };
  void add(const Attributes& of, const std::string& folder, const MjcfCompiler& compiler);
  std::map<std::string, Asset> assets_;
};

/// The shape of a geom in its body; none, with an error or a note, for what cannot be felt.
std::optional<ModelShape> read_geom(const Attributes& of, const MjcfCompiler& compiler,
                                    const MjcfMeshes& meshes);

}  // namespace tactum::inline v0_1
