# Writes base/version.cpp of the build folder: cmake -DOUT=... -DSOURCE=... -DTHRONG_VERSION=... -P.
# It runs with every build, and leaves a file alone that says the same already: nothing is compiled then.
set(THRONG_COMMIT unknown)
find_program(GIT git)
if(GIT)
  # Sources unpacked from an archive inside somebody else's checkout are not of that one's commit.
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
