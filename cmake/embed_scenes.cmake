# tactum_embed_scenes(NAME...): the registry of built-in scenes. Writes build/generated/builtin_scenes_data.cpp with the
# text of scenes/NAME.toml in the given order and adds it to the scene layer.
function(tactum_embed_scenes)
  set(entries "")
  foreach(name ${ARGN})
    set(file ${PROJECT_SOURCE_DIR}/scenes/${name}.toml)
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} text)
    string(APPEND entries "      {\"${name}\", R\"__toml__(${text})__toml__\"},\n")
  endforeach()
  set(generated ${PROJECT_BINARY_DIR}/generated/builtin_scenes_data.cpp)
  file(CONFIGURE OUTPUT ${generated} @ONLY CONTENT [[
// Made from scenes/*.toml by cmake/embed_scenes.cmake.
#include "tactum/scene/builtin_scenes.h"

const std::vector<tactum::BuiltinScene>& tactum::builtin_scenes() {
  static const std::vector<BuiltinScene> scenes = {
@entries@  };
  return scenes;
}
]])
  target_sources(tactum_scene PRIVATE ${generated})
endfunction()
