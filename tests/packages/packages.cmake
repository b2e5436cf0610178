# What is installed and packed (docs/packages.md). The manuals and completions against the programs' own --help: 5 s.
set(programs)
foreach(program tactum tactum-bench tactum-step tactum-field tactum-sweep-mpi)
  if(TARGET ${program})
    list(APPEND programs $<TARGET_FILE:${program}>)
  endif()
endforeach()
add_test(NAME packages.manuals COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/packages/check_manuals.py
                                       ${PROJECT_BINARY_DIR}/manuals-checked ${programs})
set_tests_properties(packages.manuals PROPERTIES LABELS packages)
