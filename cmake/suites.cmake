# Settings for running the tests with ctest. `./dev test` gives ctest three places per processor and one more (ctest
# -j). Places are units of ctest -j. A busy test takes two places and a test that mostly waits takes one. A busy test
# uses between half a processor and a whole one, because it also waits for its servers and browsers. On two processors
# three busy tests therefore run at once. The classes follow from measured processor time (docs/testing.md). COST only
# sets the order: the longest tests begin first.
#
# TIMEOUT is a limit against hangs, in seconds. It is not a performance requirement: the slowest test takes three
# minutes on an idle machine.
set(THUNDERHEAD_HANG_LIMIT_S 1800)
set(THUNDERHEAD_BUSY_TEST PROCESSORS 2 TIMEOUT ${THUNDERHEAD_HANG_LIMIT_S})
set(THUNDERHEAD_WAITING_TEST PROCESSORS 1 TIMEOUT ${THUNDERHEAD_HANG_LIMIT_S} COST 100)

# thunderhead_register_suites(TARGET [WAITING suites...] [PROPERTIES properties...]) registers each suite of a
# GoogleTest program with ctest, as PROGRAM.SUITE. Suites in WAITING mostly wait. GoogleTest's own CMake module would
# register each case. This function does not, because each process that draws opens a context and compiles its shaders.
# That takes longer than most cases.
function(thunderhead_register_suites target)
  cmake_parse_arguments(SUITES "" "" "WAITING;PROPERTIES" ${ARGN})
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  file(GENERATE OUTPUT ${suites} CONTENT
"set(name [==[${target}]==])
set(program [==[$<TARGET_FILE:${target}>]==])
set(properties [==[${SUITES_PROPERTIES}]==])
set(waiting [==[${SUITES_WAITING}]==])
set(waiting_properties [==[${THUNDERHEAD_WAITING_TEST}]==])
include([==[${CMAKE_SOURCE_DIR}/cmake/add_suites.cmake]==])
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${suites})
endfunction()
