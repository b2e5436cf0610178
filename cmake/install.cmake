# The library as others use it: tactum::tactum, all layers in one target, from a build (add_subdirectory) or installed
# (find_package(tactum CONFIG)). The layers stay targets of their own, tactum::collision for instance.
get_property(layers GLOBAL PROPERTY TACTUM_LAYERS)
add_library(tactum_library INTERFACE)
target_link_libraries(tactum_library INTERFACE ${layers})
set_target_properties(tactum_library PROPERTIES EXPORT_NAME tactum)
add_library(tactum::tactum ALIAS tactum_library)

if(TACTUM_INSTALL)
  include(GNUInstallDirs)
  include(CMakePackageConfigHelpers)
  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/tactum)
  install(TARGETS tactum_library ${layers} EXPORT tactumTargets COMPONENT library
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/tactum DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library
    FILES_MATCHING PATTERN "*.h" PATTERN "toml_reader.h" EXCLUDE PATTERN "read_description.h" EXCLUDE)  # these show toml++
  if(TARGET tactum_c)
    install(TARGETS tactum_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT c)
    install(FILES ${PROJECT_SOURCE_DIR}/src/tactum/embedding/tactum_c.h ${PROJECT_SOURCE_DIR}/src/tactum/embedding/tactum_client.h
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tactum/embedding COMPONENT c)
  endif()
  install(EXPORT tactumTargets NAMESPACE tactum:: DESTINATION ${package} COMPONENT library)
  configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tactumConfig.cmake.in
    ${PROJECT_BINARY_DIR}/generated/tactumConfig.cmake INSTALL_DESTINATION ${package})
  # While the major version is 0, a new minor version may change interfaces.
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/tactumConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/generated/tactumConfig.cmake
    ${PROJECT_BINARY_DIR}/generated/tactumConfigVersion.cmake DESTINATION ${package} COMPONENT library)
endif()
