# The rules of the house, as tests. Those labelled `house` need nothing built.
find_program(PYTHON3 python3 HINTS /usr/bin REQUIRED)
find_program(CLANG_FORMAT clang-format REQUIRED)
find_program(CLANG_TIDY clang-tidy REQUIRED)
set(tools ${PROJECT_SOURCE_DIR}/tools)

add_test(NAME house.layers COMMAND ${PYTHON3} ${tools}/check_layers.py)
add_test(NAME house.docs COMMAND ${PYTHON3} ${tools}/check_docs.py)
add_test(NAME house.sources COMMAND ${PYTHON3} ${tools}/check_sources.py)
add_test(NAME house.words COMMAND ${PYTHON3} ${tools}/check_words.py)
add_test(NAME house.mutations COMMAND ${PYTHON3} ${tools}/mutations.py --check)
add_test(NAME house.format COMMAND ${tools}/format.sh --check)
add_test(NAME house.tools COMMAND ${PYTHON3} -m unittest discover -s ${CMAKE_CURRENT_SOURCE_DIR}/tools)
set_tests_properties(house.layers house.docs house.sources house.words house.mutations house.format house.tools
  PROPERTIES LABELS house)

add_test(NAME house.tidy COMMAND ${PYTHON3} ${tools}/tidy.py ${PROJECT_BINARY_DIR})
set_tests_properties(house.tidy PROPERTIES LABELS slow PROCESSORS 2 TIMEOUT 1500)

# Every header compiles alone: in ./test --full, each in a unit of its own. Else all at once, which clang-tidy reads as well, and
# all twice, which one without #pragma once does not stand.
option(TACTUM_HEADERS_ALONE "Compile every header alone" OFF)
file(GLOB headers RELATIVE ${PROJECT_SOURCE_DIR}/src CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tactum/*.h
  ${PROJECT_SOURCE_DIR}/src/tactum/*/*.h)
set(header_sources every_header every_header_twice)
foreach(header IN LISTS headers)
  string(APPEND every_header "#include \"${header}\"\n")
  if(TACTUM_HEADERS_ALONE)
    string(REGEX REPLACE "[/.]" "_" name ${header})
    file(CONFIGURE OUTPUT headers/${name}.cpp CONTENT "#include \"${header}\"\n" @ONLY)
    list(APPEND header_sources ${name})
  endif()
endforeach()
file(CONFIGURE OUTPUT headers/every_header.cpp CONTENT "${every_header}" @ONLY)
file(CONFIGURE OUTPUT headers/every_header_twice.cpp CONTENT "${every_header}${every_header}" @ONLY)
list(TRANSFORM header_sources REPLACE ".+" "${CMAKE_CURRENT_BINARY_DIR}/headers/\\0.cpp")
add_library(header_selfcheck OBJECT ${header_sources})
target_compile_options(header_selfcheck PRIVATE -O0)
set_property(TARGET header_selfcheck PROPERTY UNITY_BUILD OFF)
target_link_libraries(header_selfcheck PRIVATE tactum_session tactum_warnings)

# The frames of every shipped scene are the committed ones.
add_test(NAME golden.frames COMMAND ${PYTHON3} ${tools}/golden_frames.py $<TARGET_FILE:tactum>)
# The tutorial as a reader takes it: its commands, and what it says they print.
add_test(NAME docs.tutorial COMMAND ${PYTHON3} ${tools}/run_tutorial.py $<TARGET_FILE:tactum>)
# Nothing that is compiled for newer processors is called on others. Only where functions are inlined: without that the
# wide files hold copies of everything they use.
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_test(NAME house.wide_symbols COMMAND ${PYTHON3} ${tools}/check_wide_symbols.py ${PROJECT_BINARY_DIR})
endif()

# One frame, the same bits: g++ and clang++, optimised or not, sanitized or not. ./test builds them all.
set(builds ${PROJECT_SOURCE_DIR}/build)
add_test(NAME house.same_bits COMMAND ${PYTHON3} ${tools}/same_bits.py ${builds}/release/tests/frame_hashes
  ${builds}/clang/tests/frame_hashes ${builds}/plain/tests/frame_hashes ${builds}/asan/tests/frame_hashes)
set_tests_properties(house.same_bits PROPERTIES LABELS slow SKIP_RETURN_CODE 77)
