# Installs the programs, each with its manual page and its completions, which it prints itself: `PROGRAM help --man`,
# `help --bash` and `help --fish`. So none of them can know other options than the program.
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
  add_custom_command(OUTPUT ${manuals}/${program}.1 ${manuals}/${program}.bash ${manuals}/${program}.fish
    COMMAND ${program} help --man > ${manuals}/${program}.1
    COMMAND ${program} help --bash > ${manuals}/${program}.bash
    COMMAND ${program} help --fish > ${manuals}/${program}.fish
    DEPENDS ${program} COMMENT "The manual page of ${program}" VERBATIM)
  list(APPEND printed ${manuals}/${program}.1 ${manuals}/${program}.bash ${manuals}/${program}.fish)
  install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  install(FILES ${manuals}/${program}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${manuals}/${program}.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME ${program} COMPONENT ${component})
  install(FILES ${manuals}/${program}.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    COMPONENT ${component})
endforeach()
add_custom_target(manuals ALL DEPENDS ${printed})
