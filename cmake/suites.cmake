# thunderhead_register_suites(TARGET [properties...]) registers each suite of a GoogleTest program with ctest, as PROGRAM.SUITE. Not
# each case, as GoogleTest's module does: a case that draws would open a context and make its shaders for itself, which
# takes most of them longer than what they test.
function(thunderhead_register_suites target)
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  file(GENERATE OUTPUT ${suites} CONTENT
"set(name [==[${target}]==])
set(program [==[$<TARGET_FILE:${target}>]==])
set(properties [==[${ARGN}]==])
include([==[${CMAKE_SOURCE_DIR}/cmake/add_suites.cmake]==])
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${suites})
endfunction()
