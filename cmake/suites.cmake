# Places of a test among ctest's, of which `./dev test` has four a processor. One that computes takes three, a browser's or a window's
# two, and one that mostly waits one; the longest come first, so that they do not wait one after another at the end.
set(THUNDERHEAD_BUSY_TEST PROCESSORS 3)
set(THUNDERHEAD_WINDOW_TEST PROCESSORS 2)
set(THUNDERHEAD_WAITING_TEST PROCESSORS 1 COST 100)
set(THUNDERHEAD_WAITING_LONG_TEST PROCESSORS 1 COST 2000)

# thunderhead_register_suites(TARGET [WAITING suites...] [PROPERTIES properties...]) registers each suite of a GoogleTest program with ctest, as
# PROGRAM.SUITE; those that are WAITING leave a processor to others. Not each case, as GoogleTest's module does: a case that draws would open
# a context and make its shaders for itself, which takes most of them longer than what they test.
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
