# Adds a test PROGRAM.SUITE for each suite of a program; ctest reads this file when it starts. A process for each case
# would take longer than most cases, and would compute the shared data of a suite for each case.
function(throng_suites program label folder patience_s)
  if(NOT EXISTS ${program})
    add_test(${label}_NOT_BUILT ${label}_NOT_BUILT)
    return()
  endif()
  execute_process(COMMAND ${program} --gtest_list_tests WORKING_DIRECTORY ${folder}
    OUTPUT_VARIABLE listed RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${program} --gtest_list_tests: expected exit code 0, found ${status}")
  endif()
  string(REGEX MATCHALL "(^|\n)[A-Za-z][^ \n]*\\." suites "${listed}")
  foreach(suite IN LISTS suites)
    string(REGEX REPLACE "^\n|\\.$" "" suite "${suite}")
    set(test ${label}.${suite})
    add_test(${test} ${program} --gtest_filter=${suite}.*)
    # A suite is skipped if all of its cases are. The pattern must not match if a case failed, because ctest then
    # ignores the exit code: nothing may follow the list of skipped cases.
    set_tests_properties(${test} PROPERTIES LABELS ${label} WORKING_DIRECTORY ${folder} TIMEOUT ${patience_s}
      SKIP_REGULAR_EXPRESSION "PASSED  \\] 0 tests\\.\n(\\[  SKIPPED \\][^\n]*\n)+$")
  endforeach()
endfunction()
