# Presets asan and tsan: every program contains the options of cmake/sanitizers/options.cpp, so `ctest` needs no
# environment. Timeouts are longer by THRONG_SLOWNESS, because sanitizers slow programs down.
set(THRONG_SLOWNESS 1)
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=(address|thread)")
  add_library(throng_sanitizer_options OBJECT cmake/sanitizers/options.cpp)
  target_compile_definitions(throng_sanitizer_options PRIVATE
    THRONG_TSAN_SUPPRESSIONS="${PROJECT_SOURCE_DIR}/cmake/sanitizers/tsan.supp")
  link_libraries(throng_sanitizer_options)
  # g++ 12 reports instrumented code of the standard library (std::regex) as uninitialised.
  target_compile_options(throng_warnings INTERFACE -Wno-maybe-uninitialized)
  set(THRONG_SLOWNESS 10)
  set(THRONG_INSTALL OFF)  # instrumented libraries are of no use to others
endif()
