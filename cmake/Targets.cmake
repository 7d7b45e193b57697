# How a library or a program of Throng is made. throng_options: what whoever links with us needs, too;
# throng_warnings: for our own sources alone.
add_library(throng_options INTERFACE)
target_include_directories(throng_options INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
if(THRONG_INSTALL)
  target_include_directories(throng_options INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/throng>)
endif()
target_compile_features(throng_options INTERFACE cxx_std_20)
# Same answer on every target: no contraction into fused multiply-add, no fast-math.
target_compile_options(throng_options INTERFACE -ffp-contract=off -pthread)
# Nobody reads errno or the traps of arithmetic: a root is one instruction. The values are the same.
target_compile_options(throng_options INTERFACE $<BUILD_INTERFACE:-fno-math-errno -fno-trapping-math>)

add_library(throng_warnings INTERFACE)
target_compile_options(throng_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion
  $<$<BOOL:${THRONG_WERROR}>:-Werror>
  # g++ 12 finds its own std::string out of bounds once it comes from a precompiled header.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${THRONG_PCH}>>:-Wno-array-bounds>)

# Libraries go into the command and into the Python module alike. What a file defines it may still take for
# the one definition there is, so that it inlines as without -fPIC: the command pays nothing. Not where
# definitions are compared to the byte (preset lto): under -fPIC a class's own file refers to its vtable in
# fewer bytes than others do.
if(NOT CMAKE_CXX_FLAGS MATCHES "-flto")
  add_compile_options(-fPIC -fvisibility=hidden -ftls-model=initial-exec)
endif()

# What a frame does not wait for is compiled without the optimisations that take longest: two thirds of the
# time, and the same results.
if(CMAKE_BUILD_TYPE STREQUAL Release OR CMAKE_CXX_FLAGS MATCHES "-O2")
  set(THRONG_COLD -O1)
endif()

# throng_precompiled(NAME HEADER OPTION...): a header of cmake/, compiled once for each optimisation: g++
# takes that of the precompiled header, whatever a file asks for.
function(throng_precompiled name header)
  add_library(${name} STATIC EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
  target_link_libraries(${name} PRIVATE throng_options throng_warnings Eigen3::Eigen fmt::fmt)
  target_precompile_headers(${name} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/${header})
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess> ${ARGN})
endfunction()
if(THRONG_PCH)
  throng_precompiled(throng_precompiled precompiled.h)
  throng_precompiled(throng_precompiled_cold precompiled.h ${THRONG_COLD})
endif()

# throng_sources_for_several(TARGET VARIABLE): those that are compiled once for each SIMD target, by
# including themselves.
function(throng_sources_for_several target variable)
  set(found)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(source MATCHES "\\.cpp$" AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source})
      file(STRINGS ${source} marks REGEX "<hwy/foreach_target.h>" LIMIT_COUNT 1)
      if(marks)
        list(APPEND found ${source})
      endif()
    endif()
  endforeach()
  set(${variable} "${found}" PARENT_SCOPE)
endfunction()

# throng_unite(TARGET [MOST]): reading headers takes longer than compiling what most files say themselves, so
# up to eight of a folder are read at once: half of the time. What stands in unnamed namespaces has a name of
# its own within a folder.
function(throng_unite target)
  set(most 8)
  if(ARGC GREATER 1)
    set(most ${ARGV1})
  endif()
  if(NOT THRONG_UNITY)
    return()
  endif()
  throng_sources_for_several(${target} alone)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(source MATCHES "\\.cpp$" AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source} AND NOT source IN_LIST alone)
      cmake_path(GET source PARENT_PATH folder)
      if(NOT DEFINED of_${folder})
        set(of_${folder} 0)
      endif()
      math(EXPR batch "${of_${folder}} / ${most}")
      math(EXPR of_${folder} "${of_${folder}} + 1")
      string(MAKE_C_IDENTIFIER "${folder}_${batch}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

function(throng_precompile target precompiled)
  if(THRONG_PCH)
    # The first so that ccache can tell what a file depends on. The second, 512 MB, because g++ goes through
    # all that is precompiled whenever it collects garbage: a tenth of its time.
    target_compile_options(${target} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess> $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)
    target_precompile_headers(${target} REUSE_FROM ${precompiled})
    # Behind a precompiled header g++ 12 takes __OPTIMIZE__ for defined, without optimisation too, and the
    # compiler's headers of SIMD instructions then rest on inlining that does not happen. And a precompiled
    # header is for the options that it was compiled with, see throng_copy_by_vectors.
    throng_sources_for_several(${target} alone)
    set_source_files_properties(${alone} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  endif()
endfunction()

# throng_copy_by_vectors(TARGET): sources for several SIMD targets copy and clear with vector instructions.
# g++ 12 prefers `rep movs` for some hundred bytes, which takes longer than the kernel around it;
# tests/structure/simd_copies_test.sh reads the objects, whose paths are collected here.
function(throng_copy_by_vectors target)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU OR NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    return()
  endif()
  throng_sources_for_several(${target} sources)
  foreach(source IN LISTS sources)
    set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS
      -mmemcpy-strategy=vector_loop:-1:noalign -mmemset-strategy=vector_loop:-1:noalign)
    set_property(GLOBAL APPEND PROPERTY THRONG_SIMD_OBJECTS
      ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/${source}.o)
  endforeach()
endfunction()

# throng_library(NAME [COLD] SOURCES FILE... [PUBLIC TARGET...] [PRIVATE TARGET...]): throng::NAME. COLD: no
# frame waits for any of it.
function(throng_library name)
  cmake_parse_arguments(L "COLD" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(throng_${name} STATIC ${L_SOURCES})
  add_library(throng::${name} ALIAS throng_${name})
  target_link_libraries(throng_${name} PUBLIC ${L_PUBLIC} PRIVATE $<BUILD_INTERFACE:throng_warnings> ${L_PRIVATE})
  if(L_COLD)
    target_compile_options(throng_${name} PRIVATE ${THRONG_COLD})
    throng_precompile(throng_${name} throng_precompiled_cold)
  else()
    throng_precompile(throng_${name} throng_precompiled)
  endif()
  throng_copy_by_vectors(throng_${name})
  throng_unite(throng_${name})
endfunction()

# throng_program(NAME SOURCES FILE... LIBS TARGET...), on a library of ours.
function(throng_program name)
  cmake_parse_arguments(P "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${P_SOURCES})
  target_link_libraries(${name} PRIVATE ${P_LIBS} throng_warnings)
  throng_precompile(${name} throng_precompiled)
endfunction()

# throng_cold(TARGET FILE...): more files of a target, for which no frame waits.
function(throng_cold target)
  add_library(${target}_cold OBJECT ${ARGN})
  get_target_property(libraries ${target} LINK_LIBRARIES)
  target_link_libraries(${target}_cold PRIVATE ${libraries})
  target_compile_options(${target}_cold PRIVATE ${THRONG_COLD})
  throng_precompile(${target}_cold throng_precompiled_cold)
  throng_unite(${target}_cold)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_cold>)
endfunction()
