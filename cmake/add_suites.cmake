# ctest reads this file when it starts. It adds a test for each suite that `program` has at that time. Suites named
# ...Benchmark print figures that depend on the machine's speed. They have the label `benchmark`, which `./dev test`
# leaves out and `./dev bench waits` runs.
if(NOT EXISTS ${program})
  # This test fails because the command does not exist.
  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)
  return()
endif()
execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${program} --gtest_list_tests failed: ${failed}")
endif()
# In the list of --gtest_list_tests, the line of a suite ends in a dot. If the suite has a type parameter, a comment
# follows the dot. The lines of its test cases are indented.
string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\.[ \n]" lines "\n${listed}")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^\n(.+)\\..$" "\\1" suite "${line}")
  add_test(${name}.${suite} ${program} --gtest_brief=1 "--gtest_filter=${suite}.*")
  set_tests_properties(${name}.${suite} PROPERTIES ${properties})
  if(suite MATCHES "Benchmark$")
    set_tests_properties(${name}.${suite} PROPERTIES LABELS benchmark RUN_SERIAL TRUE)
  endif()
  list(FIND waiting ${suite} waits)
  if(NOT waits EQUAL -1)
    set_tests_properties(${name}.${suite} PROPERTIES ${waiting_properties})
    list(REMOVE_ITEM waiting ${suite})
  endif()
endforeach()
if(waiting)
  message(FATAL_ERROR "no suite of ${name}: ${waiting}")
endif()
