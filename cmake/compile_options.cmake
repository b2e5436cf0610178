# How the project's own files are compiled. The same bits everywhere: no fused multiply-add (layers.cmake), no fast math,
# and Eigen's vector paths off (the math layer, in CMakeLists.txt), so that g++ and clang++, debug and release, compute one
# and the same frame. Three-vectors gain nothing from them.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")  # and -O3 for the layers of the frame: see layers.cmake

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_library(tactum_warnings INTERFACE)
target_compile_options(tactum_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual)
# Where files are joined, a name of one is in the function of another. Files that are compiled alone are checked.
target_compile_options(tactum_warnings INTERFACE $<$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>:-Wno-shadow>)
option(TACTUM_WARNINGS_ARE_ERRORS "Stop at warnings of the project's own files" ${PROJECT_IS_TOP_LEVEL})
if(TACTUM_WARNINGS_ARE_ERRORS)
  target_compile_options(tactum_warnings INTERFACE -Werror)
endif()

# Sanitizers: -DTACTUM_SANITIZE=address,undefined or =thread (see CMakePresets.json).
set(TACTUM_SANITIZE "" CACHE STRING "Comma-separated sanitizers")
set(CMAKE_CXX_FLAGS_DEBUG "-O0 -g")
if(TACTUM_SANITIZE)
  set(CMAKE_CXX_FLAGS_DEBUG "-O2 -g1")  # compiles as fast as -O1, runs several times faster than -O0
  add_compile_options(-fsanitize=${TACTUM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${TACTUM_SANITIZE})
endif()
option(TACTUM_COVERAGE "Count executed lines (gcov)" OFF)
if(TACTUM_COVERAGE)
  add_compile_options(--coverage)
  add_link_options(--coverage)
endif()

option(TACTUM_BUILD_FUZZERS "Build the fuzzers under fuzz/ (libFuzzer, clang only)" OFF)
if(TACTUM_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "libFuzzer comes with clang: use the fuzz preset")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link)
  add_link_options(-fsanitize=fuzzer-no-link)
endif()
