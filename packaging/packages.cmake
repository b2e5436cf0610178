# Debian packages by CPack: `cmake --build FOLDER --target package` in a folder of the preset `package`, as
# tools/package.sh does it. What a package holds are components of `cmake --install`; what Debian's policy asks of every
# package beside them (copyright, changelog, overrides) is installed here and packed by finish_packages.cmake.
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(c_package libtactum-c${soversion})  # by the name of the shared library, as the policy has it
set(packages ${c_package} libtactum-dev tactum tactum-tools)
set(components_${c_package} c_shared)
set(components_libtactum-dev library c_link)
set(components_tactum program)
set(components_tactum-tools tools)
if(TARGET tactum_python)
  list(APPEND packages python3-tactum)
  set(components_python3-tactum python)
endif()

# The component `c` holds the library with its link and header; packages part them.
install(TARGETS tactum_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT c_shared NAMELINK_SKIP EXCLUDE_FROM_ALL)
install(TARGETS tactum_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT c_link NAMELINK_ONLY EXCLUDE_FROM_ALL)

set(CPACK_COMPONENTS_ALL)
foreach(name IN LISTS packages)
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${doc} COMPONENT papers_${name} EXCLUDE_FROM_ALL)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/changelog DESTINATION ${doc} RENAME changelog.Debian
    COMPONENT papers_${name} EXCLUDE_FROM_ALL)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME ${name}
    COMPONENT papers_${name} EXCLUDE_FROM_ALL)
  list(APPEND CPACK_COMPONENTS_ALL ${components_${name}} papers_${name})
endforeach()

# One changelog for all: its newest entry is about this version.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/changelog newest LIMIT_COUNT 1)
string(FIND "${newest}" "tactum (${PROJECT_VERSION}-1) " found)
if(NOT found EQUAL 0)
  message(FATAL_ERROR "packaging/changelog begins with \"${newest}\", expected an entry of ${PROJECT_VERSION}-1")
endif()

set(TACTUM_PACKAGE_MAINTAINER "The Tactum authors <maintainers@tactum.example.org>" CACHE STRING
  "Who answers for the packages; set your own name when you give them to others")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tactum)
set(CPACK_PACKAGE_CONTACT ${TACTUM_PACKAGE_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/finish_packages.cmake)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SOURCE tactum)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(full_version ${PROJECT_VERSION}-1)

# tactum_package(NAME SECTION DEPENDS "what dpkg-shlibdeps cannot know" SUMMARY "" TEXT "" [RECOMMENDS ""] [SUGGESTS ""])
macro(tactum_package name section)
  cmake_parse_arguments(PACKAGE "" "DEPENDS;RECOMMENDS;SUGGESTS;SUMMARY;TEXT" "" ${ARGN})
  string(TOUPPER ${name} NAME)
  foreach(component ${components_${name}} papers_${name})
    string(TOUPPER ${component} COMPONENT)
    set(CPACK_COMPONENT_${COMPONENT}_GROUP ${name})
  endforeach()
  set(CPACK_COMPONENT_GROUP_${NAME}_DESCRIPTION "${PACKAGE_SUMMARY}\n${PACKAGE_TEXT}")
  set(CPACK_DEBIAN_${NAME}_DESCRIPTION "${PACKAGE_SUMMARY}\n${PACKAGE_TEXT}")
  set(CPACK_DEBIAN_${NAME}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${NAME}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${NAME}_PACKAGE_DEPENDS "${PACKAGE_DEPENDS}")
  set(CPACK_DEBIAN_${NAME}_PACKAGE_RECOMMENDS "${PACKAGE_RECOMMENDS}")
  set(CPACK_DEBIAN_${NAME}_PACKAGE_SUGGESTS "${PACKAGE_SUGGESTS}")
endmacro()

set(about "Tactum lets a person feel polygonal models through a haptic device with\nsix degrees of freedom: force and torque come from exact contact, computed\na thousand times a second.")
tactum_package(${c_package} libs SUMMARY "six degree-of-freedom haptic rendering, C interface"
  TEXT "${about}\n\nThis package has the shared library that programs in C and other languages\nuse: parts, distance and clearance, scenes stepped frame by frame.")
string(TOUPPER ${c_package} NAME)
set(control ${PROJECT_BINARY_DIR}/generated/packaging)
file(CONFIGURE OUTPUT ${control}/shlibs CONTENT "libtactum_c ${soversion} ${c_package} (>= ${PROJECT_VERSION})\n")
file(CONFIGURE OUTPUT ${control}/triggers CONTENT "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_${NAME}_PACKAGE_CONTROL_EXTRA "${control}/shlibs;${control}/triggers")
set(CPACK_POST_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/without_ldconfig_calls.cmake)
# The library is static: what its layers link and its headers include, a program needs as well (tactumConfig.cmake).
tactum_package(libtactum-dev libdevel
  DEPENDS "${c_package} (= ${full_version}), libeigen3-dev (>= 3.4), libfmt-dev, libqhull-dev, libassimp-dev, libtomlplusplus-dev, libtinyxml2-dev, libzstd-dev, pkg-config"
  SUGGESTS "cmake (>= 3.25)"
  SUMMARY "six degree-of-freedom haptic rendering, development files"
  TEXT "${about}\n\nThis package has the static libraries and headers for C++, with their\nCMake package, and header and link for programs in C.")
tactum_package(tactum science SUGGESTS "tactum-tools" RECOMMENDS "bash-completion"
  SUMMARY "feel polygonal models through a haptic device or the mouse"
  TEXT "${about}\n\nThis package has the program: scenes to feel, a page for the browser on\nwhich the mouse is the hand, preparation of CAD parts, recordings.\nSimulated devices are built in.")
tactum_package(tactum-tools science RECOMMENDS "tactum (= ${full_version}), bash-completion" SUGGESTS "openmpi-bin"
  SUMMARY "STEP, VTK and MPI for Tactum, and its benchmarks"
  TEXT "${about}\n\nThis package has the programs that need large libraries: tactum-step reads\nSTEP, tactum-field makes force fields of VTK image data, tactum-sweep-mpi\nruns sweeps over MPI, tactum-bench measures beside other libraries.")
set(CPACK_DEBIAN_LIBTACTUM-DEV_PACKAGE_SHLIBDEPS OFF)
if(TARGET tactum_python)
  # The module is one for the minor version it was built with.
  execute_process(COMMAND ${PYTHON3} -c "import sys; print(sys.version_info[1])" OUTPUT_VARIABLE minor
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  math(EXPR next_minor "${minor} + 1")
  tactum_package(python3-tactum python
    DEPENDS "python3 (>= 3.${minor}), python3 (<< 3.${next_minor}), python3-numpy"
    RECOMMENDS "python3-matplotlib"
    SUMMARY "six degree-of-freedom haptic rendering, Python module"
    TEXT "${about}\n\nThis package has the module tactum: parts, distance and clearance, scenes\nstepped with their contacts, sessions, recordings and plots.")
  set(CPACK_DEBIAN_PYTHON3-TACTUM_PACKAGE_CONTROL_EXTRA
    "${CMAKE_CURRENT_LIST_DIR}/python3-tactum/postinst;${CMAKE_CURRENT_LIST_DIR}/python3-tactum/prerm")
endif()
include(CPack)
