# Writes base/version.cpp of the build folder: cmake -DOUT=... -DSOURCE=... -DTHRONG_VERSION=... -P.
# Runs at every build and keeps an unchanged file, so that nothing is compiled again.
set(THRONG_COMMIT unknown)
find_program(GIT git)
if(GIT)
  # An unpacked archive inside another project's checkout does not have that project's commit.
  cmake_path(GET SOURCE PARENT_PATH above)
  set(ENV{GIT_CEILING_DIRECTORIES} "${above}")
  set(ENV{GIT_OPTIONAL_LOCKS} 0)
  execute_process(COMMAND ${GIT} describe --always --dirty --abbrev=12 --exclude=*
    WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE result
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(result EQUAL 0 AND found MATCHES "^[0-9a-f]+(-dirty)?$")
    set(THRONG_COMMIT ${found})
  endif()
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/version.cpp.in ${OUT} @ONLY)
