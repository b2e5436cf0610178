# Installs the programs, each with its manual page and its completion, which it prints itself: `PROGRAM help --man` and
# `help --bash`. So neither can know other options than the program.
include(GNUInstallDirs)
set(manuals ${PROJECT_BINARY_DIR}/manuals)
file(MAKE_DIRECTORY ${manuals})
set(printed)
foreach(program tactum tactum-bench tactum-step tactum-field tactum-sweep-mpi)
  if(NOT TARGET ${program})
    continue()
  endif()
  set(component tools)
  if(program STREQUAL "tactum")
    set(component program)
  endif()
  add_custom_command(OUTPUT ${manuals}/${program}.1 ${manuals}/${program}.bash
    COMMAND ${program} help --man > ${manuals}/${program}.1
    COMMAND ${program} help --bash > ${manuals}/${program}.bash
    DEPENDS ${program} COMMENT "The manual page of ${program}" VERBATIM)
  list(APPEND printed ${manuals}/${program}.1 ${manuals}/${program}.bash)
  install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  install(FILES ${manuals}/${program}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${manuals}/${program}.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME ${program} COMPONENT ${component})
endforeach()
add_custom_target(manuals ALL DEPENDS ${printed})
