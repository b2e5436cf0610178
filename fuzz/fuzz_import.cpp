/// Any bytes as a URDF or MJCF file: a scene file that reads as one, or a sentence that says what is wrong.
/// Nothing is built, since a file may ask for as many bodies as it likes.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "tactum/import/import_scene.h"
#include "tactum/scene/check_description.h"
#include "tactum/scene/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactum;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Result<ImportedScene> imported = import_scene_text(text, "fuzz/corpus/import/fuzzed.xml");
  if (!imported) {
    if (imported.error().message().empty()) std::abort();
    return 0;
  }
  const Result<SceneDescription> scene = parse_description(imported->toml, "fuzzed", "fuzzed.toml", {});
  if (!scene) {
    if (scene.error().message().empty()) std::abort();
    return 0;
  }
  if (!check_description(*scene)) std::abort();  // what was written is in its ranges
  return 0;
}
