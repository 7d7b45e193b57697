# The presets asan and tsan: every program carries the options of cmake/sanitizers/options.cpp, so that
# `ctest` needs no environment. A program under a sanitizer is slower, and what waits for it waits longer.
set(THRONG_SLOWNESS 1)
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=(address|thread)")
  add_library(throng_sanitizer_options OBJECT cmake/sanitizers/options.cpp)
  target_compile_definitions(throng_sanitizer_options PRIVATE
    THRONG_TSAN_SUPPRESSIONS="${PROJECT_SOURCE_DIR}/cmake/sanitizers/tsan.supp")
  link_libraries(throng_sanitizer_options)
  # g++ 12 takes instrumented code of the standard library (std::regex) for uninitialised.
  target_compile_options(throng_warnings INTERFACE -Wno-maybe-uninitialized)
  set(THRONG_SLOWNESS 10)
  set(THRONG_INSTALL OFF)  # nobody links with such libraries
endif()
