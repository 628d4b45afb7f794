# Read by ctest when it starts: adds a test for each suite that `program` has then.
if(NOT EXISTS ${program})
  # Fails, since there is no such command.
  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)
  return()
endif()
execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${program} --gtest_list_tests failed: ${failed}")
endif()
# Lines of suites end in a dot or, with a parameter of a type, in a comment after it; those of cases are indented.
string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\.[ \n]" lines "\n${listed}")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^\n(.+)\\..$" "\\1" suite "${line}")
  add_test(${name}.${suite} ${program} --gtest_brief=1 "--gtest_filter=${suite}.*")
  set_tests_properties(${name}.${suite} PROPERTIES ${properties})
endforeach()
