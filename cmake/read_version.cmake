# Sets tactum_version to the version that src/tactum/version.h defines.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/../src/tactum/version.h)
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../src/tactum/version.h tactum_version_lines REGEX "VERSION_(MAJOR|MINOR|PATCH) [0-9]+$")
list(TRANSFORM tactum_version_lines REPLACE "^.* " "")
list(JOIN tactum_version_lines "." tactum_version)
