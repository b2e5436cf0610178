#pragma once
/// A model as a scene file: links that are fixed to each other become one body, every other link a body
/// with a joint to the one it hangs on.

#include <string>
#include <vector>

#include "tactum/import/import_log.h"
#include "tactum/import/import_model.h"
#include "tactum/import/model_mass.h"

namespace tactum::inline v0_1 {

/// What the file does not say.
struct ImportChoices {
  std::string tool = {};    ///< the body that is held; empty: chosen
  std::string folder = {};  ///< from which the scene file names meshes; empty: by their whole paths
};

/// A scene file, and what a person should know of it.
struct WrittenScene {
  std::string toml = {};
  std::vector<std::string> sentences = {};
};

/// Errors and notes go to the log. Poses are those of the file, but for joints whose limits leave that out:
/// they start at the nearest limit, which a note states.
WrittenScene write_scene(const ImportModel& model, const ImportChoices& choices, ModelMeshes& meshes,
                         ImportLog& log);

}  // namespace tactum::inline v0_1
