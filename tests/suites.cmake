# A test for each suite of a program, PROGRAM.SUITE, for ctest, which reads this when it begins. A process for each case
# would take more time than most cases do, and what the cases of a suite share would be made for each of them.
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
    # Skipped is a suite of which every case is. ctest asks no further where it finds this, so it must not be
    # found where a case failed, too: nothing may follow the list of those that were skipped.
    set_tests_properties(${test} PROPERTIES LABELS ${label} WORKING_DIRECTORY ${folder} TIMEOUT ${patience_s}
      SKIP_REGULAR_EXPRESSION "PASSED  \\] 0 tests\\.\n(\\[  SKIPPED \\][^\n]*\n)+$")
  endforeach()
endfunction()
