# libtactum_c: the C interface (src/tactum/embedding/tactum_c.h) as a shared library that shows no name but its own. Where the
# layers cannot be in one, as in the sanitized builds, programs in C link the layer itself: tactum_c_for_programs is either.
math(EXPR version_number "10000 * ${PROJECT_VERSION_MAJOR} + 100 * ${PROJECT_VERSION_MINOR} + ${PROJECT_VERSION_PATCH}")
target_compile_definitions(tactum_embedding PRIVATE TACTUM_LIBRARY_VERSION=${version_number})
option(TACTUM_C_LIBRARY "Build libtactum_c" ${TACTUM_POSITION_INDEPENDENT})
if(TACTUM_C_LIBRARY)
  add_library(tactum_c SHARED $<TARGET_OBJECTS:tactum_embedding>)
  set(exported ${CMAKE_CURRENT_LIST_DIR}/tactum_c.map)
  target_link_libraries(tactum_c PRIVATE tactum_session)
  target_link_options(tactum_c PRIVATE "LINKER:--version-script=${exported}" LINKER:--no-undefined LINKER:--gc-sections)
  target_include_directories(tactum_c INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  # While the major version is 0, a new minor version may change interfaces.
  set_target_properties(tactum_c PROPERTIES LINK_DEPENDS ${exported} VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LINKER_LANGUAGE CXX)
  add_library(tactum::c ALIAS tactum_c)
  set(tactum_c_for_programs tactum_c)
else()
  set(tactum_c_for_programs tactum_embedding)
endif()
