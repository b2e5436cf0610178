# One static library per layer folder: tactum_layer(NAME [HOT] [ALONE] USES PUBLIC_DEPENDENCIES...
# PRIVATELY PRIVATE_DEPENDENCIES...).
# HOT: the frame runs there; -O3 inlines the small vector functions, which makes the contact core a third faster; packing
# scalars of three-vectors into pairs costs a tenth of that again. Nobody reads errno or the flags of floating-point
# exceptions, so choices may be computed instead of jumped to: a value never changes.
# ALONE: its files are not joined, since g++ -O3 would put their functions into each other for minutes and gigabytes.
# Position independent with hidden names, so that a shared library or a Python module can be made of the layers; calls
# inside them stay as direct as in a program.
# What the headers need of a program that includes them goes with the target: C++20, and no contraction of products and
# sums, which would give their inline functions other bits there. Warnings stay here.
option(TACTUM_POSITION_INDEPENDENT "Compile the layers so that shared libraries can hold them" ON)
function(tactum_layer name)
  cmake_parse_arguments(LAYER "HOT;ALONE" "" "USES;PRIVATELY" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tactum/${name}/*.cpp)
  if(sources)
    add_library(tactum_${name} STATIC ${sources})
    set(scope PUBLIC)
    target_compile_options(tactum_${name} PUBLIC -ffp-contract=off)
    target_link_libraries(tactum_${name} PUBLIC ${LAYER_USES}
      PRIVATE ${LAYER_PRIVATELY} $<BUILD_INTERFACE:tactum_warnings>)
    if(TACTUM_POSITION_INDEPENDENT)
      set_target_properties(tactum_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
        VISIBILITY_INLINES_HIDDEN ON)
    endif()
    if(LAYER_HOT)
      target_compile_options(tactum_${name} PRIVATE "$<$<CONFIG:Release>:-O3;-fno-tree-slp-vectorize;-fno-math-errno;-fno-trapping-math>")
      if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release")
        set_target_properties(tactum_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 6)  # compiles as long as two alone
        if(LAYER_ALONE)
          set_target_properties(tactum_${name} PROPERTIES UNITY_BUILD OFF)
        endif()
      endif()
    endif()
  else()  # a layer of headers only
    set(scope INTERFACE)
    add_library(tactum_${name} INTERFACE)
    target_compile_options(tactum_${name} INTERFACE -ffp-contract=off)
    target_link_libraries(tactum_${name} INTERFACE ${LAYER_USES})
  endif()
  target_include_directories(tactum_${name} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  target_compile_features(tactum_${name} ${scope} cxx_std_20)
  set_target_properties(tactum_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY TACTUM_LAYERS tactum_${name})
  add_library(tactum::${name} ALIAS tactum_${name})
endfunction()
