/// Any bytes as a scene file: a description, or a sentence that says what is wrong with it. Nothing is built,
/// since a scene may ask for as many bodies as it likes.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "tactum/scene/check_description.h"
#include "tactum/scene/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactum;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Result<SceneDescription> scene = parse_description(text, "fuzzed", "fuzzed.toml", {});
  if (!scene) {
    if (scene.error().message().empty()) std::abort();
    return 0;
  }
  const Result<void> checked = check_description(*scene);
  if (!checked && checked.error().message().empty()) std::abort();
  return 0;
}
