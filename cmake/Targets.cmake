# How a library or a program of Throng is made. throng_options: what whoever links with us needs, too;
# throng_warnings: for our own sources alone.
add_library(throng_options INTERFACE)
target_include_directories(throng_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_features(throng_options INTERFACE cxx_std_20)
# Same answer on every target: no contraction into fused multiply-add, no fast-math.
target_compile_options(throng_options INTERFACE -ffp-contract=off -pthread)

add_library(throng_warnings INTERFACE)
target_compile_options(throng_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion
  $<$<BOOL:${THRONG_WERROR}>:-Werror>
  # g++ 12 finds its own std::string out of bounds once it comes from a precompiled header.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${THRONG_PCH}>>:-Wno-array-bounds>)

# What nearly every file includes, compiled once: reading Eigen, fmt and the standard library takes
# longer than most files of ours.
if(THRONG_PCH)
  add_library(throng_precompiled STATIC ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
  target_link_libraries(throng_precompiled PRIVATE throng_options throng_warnings Eigen3::Eigen fmt::fmt)
  target_precompile_headers(throng_precompiled PRIVATE
    <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <filesystem> <fmt/format.h> <functional>
    <memory> <optional> <set> <span> <string> <string_view> <vector>)
  target_compile_options(throng_precompiled PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endif()

function(throng_precompile target)
  if(THRONG_PCH)
    # So that ccache can tell what a file depends on.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
    target_precompile_headers(${target} REUSE_FROM throng_precompiled)
    # Behind a precompiled header g++ 12 takes __OPTIMIZE__ for defined, without optimisation too, and the
    # compiler's headers of SIMD instructions then rest on inlining that does not happen.
    if(NOT CMAKE_BUILD_TYPE STREQUAL Release)
      get_target_property(sources ${target} SOURCES)
      list(FILTER sources INCLUDE REGEX "_simd\\.cpp$")
      set_source_files_properties(${sources} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endif()
endfunction()

# throng_library(NAME SOURCES FILE... [PUBLIC TARGET...] [PRIVATE TARGET...]): throng::NAME.
function(throng_library name)
  cmake_parse_arguments(L "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(throng_${name} STATIC ${L_SOURCES})
  add_library(throng::${name} ALIAS throng_${name})
  target_link_libraries(throng_${name} PUBLIC ${L_PUBLIC} PRIVATE throng_warnings ${L_PRIVATE})
  throng_precompile(throng_${name})
endfunction()

# throng_program(NAME SOURCES FILE... LIBS TARGET...), on a library of ours.
function(throng_program name)
  cmake_parse_arguments(P "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${P_SOURCES})
  target_link_libraries(${name} PRIVATE ${P_LIBS} throng_warnings)
  throng_precompile(${name})
endfunction()
