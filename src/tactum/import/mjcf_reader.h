#pragma once
/// MJCF into a model. For src/tactum/import/*.cpp only.

#include <string>

#include "tactum/import/import_log.h"
#include "tactum/import/import_model.h"

namespace tactum::inline v0_1 {

/// `folder` is that of the file; included files are put into the tree. The elements are marked as read;
/// errors and notes go to the log. The model points to the elements, which must outlive it.
ImportModel read_mjcf(XmlElement& mujoco, const std::string& folder, ImportLog& log);

}  // namespace tactum::inline v0_1
