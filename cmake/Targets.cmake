# Functions that define libraries and programs. throng_options: options for all users of the libraries;
# throng_warnings: for Throng's own sources only.
add_library(throng_options INTERFACE)
target_include_directories(throng_options INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
if(THRONG_INSTALL)
  target_include_directories(throng_options INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/throng>)
endif()
target_compile_features(throng_options INTERFACE cxx_std_20)
# Equal results on every target: no contraction into fused multiply-add, no fast-math.
target_compile_options(throng_options INTERFACE -ffp-contract=off -pthread)
# No code reads errno or traps of arithmetic, so a square root is one instruction with the same value.
target_compile_options(throng_options INTERFACE $<BUILD_INTERFACE:-fno-math-errno -fno-trapping-math>)

add_library(throng_warnings INTERFACE)
target_compile_options(throng_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion
  $<$<BOOL:${THRONG_WERROR}>:-Werror>
  # g++ 12 reports std::string as out of bounds if it comes from a precompiled header.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${THRONG_PCH}>>:-Wno-array-bounds>)

# Libraries are linked into the command and the Python module. These options allow inlining as without -fPIC, at
# no cost for the command. The preset lto compares definitions byte by byte and leaves them out: with -fPIC the
# file of a class refers to its vtable in fewer bytes than other files.
if(NOT CMAKE_CXX_FLAGS MATCHES "-flto")
  add_compile_options(-fPIC -fvisibility=hidden -ftls-model=initial-exec)
endif()

# Cold sources, which no frame waits for, skip the slowest optimisations: two thirds of the time, equal results.
if(CMAKE_BUILD_TYPE STREQUAL Release OR CMAKE_CXX_FLAGS MATCHES "-O2")
  set(THRONG_COLD -O1)
endif()

# throng_precompiled(NAME HEADER OPTION...): a header of cmake/, compiled once per optimisation level: g++ uses
# the level of the precompiled header for all files.
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

# throng_sources_for_several(TARGET VARIABLE): sources that are compiled once per SIMD target, by including
# themselves.
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

# throng_unite(TARGET [MAX]): compiles up to eight sources of a folder together, in half of the time, because
# headers take longer than most sources. Names in unnamed namespaces must be unique within a folder.
function(throng_unite target)
  set(max_batch 8)
  if(ARGC GREATER 1)
    set(max_batch ${ARGV1})
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
      math(EXPR batch "${of_${folder}} / ${max_batch}")
      math(EXPR of_${folder} "${of_${folder}} + 1")
      string(MAKE_C_IDENTIFIER "${folder}_${batch}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

function(throng_precompile target precompiled)
  if(THRONG_PCH)
    # The first option lets ccache see a file's dependencies. The second (512 MB) avoids garbage collections, each
    # of which scans the precompiled headers: a tenth of g++'s time.
    target_compile_options(${target} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess> $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)
    target_precompile_headers(${target} REUSE_FROM ${precompiled})
    # After a precompiled header g++ 12 considers __OPTIMIZE__ defined even without optimisation, and headers of
    # SIMD instructions then rely on missing inlining. A precompiled header also requires equal options, see
    # throng_copy_by_vectors.
    throng_sources_for_several(${target} alone)
    set_source_files_properties(${alone} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  endif()
endfunction()

# throng_copy_by_vectors(TARGET): makes sources for several SIMD targets copy and clear memory with vector
# instructions. g++ 12 prefers `rep movs` for some hundred bytes, which takes longer than the kernel around it.
# tests/structure/simd_copies_test.sh checks the objects, whose paths are collected here.
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
# frame waits for its code.
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

# throng_program(NAME SOURCES FILE... LIBS TARGET...): a program on Throng's libraries.
function(throng_program name)
  cmake_parse_arguments(P "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${P_SOURCES})
  target_link_libraries(${name} PRIVATE ${P_LIBS} throng_warnings)
  throng_precompile(${name} throng_precompiled)
endfunction()

# throng_cold(TARGET FILE...): more sources of a target, for which no frame waits.
function(throng_cold target)
  add_library(${target}_cold OBJECT ${ARGN})
  get_target_property(libraries ${target} LINK_LIBRARIES)
  target_link_libraries(${target}_cold PRIVATE ${libraries})
  target_compile_options(${target}_cold PRIVATE ${THRONG_COLD})
  throng_precompile(${target}_cold throng_precompiled_cold)
  throng_unite(${target}_cold)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_cold>)
endfunction()
