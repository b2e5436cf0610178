# libtactum_c as others meet it: the names it shows, and a host that loads it when it runs.
if(TARGET tactum_c)
  add_test(NAME embedding.c_symbols COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/embedding/check_symbols.py
                                            $<TARGET_FILE:tactum_c> ${PROJECT_SOURCE_DIR}/src/tactum/embedding/tactum_c.h)
  add_executable(dlopen_host embedding/dlopen_host.c)
  target_include_directories(dlopen_host PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_compile_options(dlopen_host PRIVATE -Wall -Wextra -Wpedantic -Werror)
  set_target_properties(dlopen_host PROPERTIES C_STANDARD 11 C_EXTENSIONS OFF)
  target_link_libraries(dlopen_host PRIVATE ${CMAKE_DL_LIBS})
  add_dependencies(dlopen_host tactum_c)
  add_test(NAME embedding.dlopen_host COMMAND dlopen_host $<TARGET_FILE:tactum_c>)
endif()

# The client in C++17 over it, as a host of its own compiles it, with either compiler's warnings.
add_executable(client_host embedding/host/client_host.cpp)
target_include_directories(client_host PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(client_host PRIVATE -Wall -Wextra -Wpedantic -Werror)
set_target_properties(client_host PROPERTIES CXX_STANDARD 17 CXX_EXTENSIONS OFF)
target_link_libraries(client_host PRIVATE ${tactum_c_for_programs})
if(NOT TACTUM_SANITIZE STREQUAL "thread")
  add_test(NAME embedding.client_host COMMAND client_host)
endif()
