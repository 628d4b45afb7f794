# A room is one folder of server/ built as one static library, `thunderhead::NAME`.
# thunderhead_room(NAME [DEPENDS rooms and libraries...]) takes every .cc file of the folder.
function(thunderhead_room name)
  cmake_parse_arguments(ROOM "" "" "DEPENDS;SOURCES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  list(APPEND sources ${ROOM_SOURCES})
  if(sources)
    add_library(thunderhead_${name} STATIC ${sources})
    target_link_libraries(thunderhead_${name} PUBLIC thunderhead_options ${ROOM_DEPENDS})
  else()
    add_library(thunderhead_${name} INTERFACE)
    target_link_libraries(thunderhead_${name} INTERFACE thunderhead_options ${ROOM_DEPENDS})
  endif()
  add_library(thunderhead::${name} ALIAS thunderhead_${name})
endfunction()

# The environment of tests that open a context, or start a program that does: Mesa unloads its driver at the end with
# memory that it still holds, which LeakSanitizer cannot tell from ours by name.
set(THUNDERHEAD_GL_ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)

# thunderhead_test(NAME DEPENDS libraries...) builds the .cc files of the current folder, or SOURCES, into one
# GoogleTest program and registers each of its cases with ctest under LABEL, those that are GL in its environment and with
# strict programs.
function(thunderhead_test name)
  cmake_parse_arguments(TEST "GL" "LABEL" "DEPENDS;SOURCES;PROPERTIES" ${ARGN})
  if(NOT TEST_SOURCES)
    file(GLOB TEST_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  endif()
  if(TEST_GL)
    list(APPEND TEST_SOURCES ${CMAKE_SOURCE_DIR}/tests/support/strict_programs.cc)
  endif()
  add_executable(${name} ${TEST_SOURCES})
  target_link_libraries(${name} PRIVATE thunderhead_options ${TEST_DEPENDS} GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_compile_definitions(${name} PRIVATE THUNDERHEAD_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  if(TEST_GL)
    list(APPEND TEST_PROPERTIES ENVIRONMENT ${THUNDERHEAD_GL_ENVIRONMENT})
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES LABELS "${TEST_LABEL}" TIMEOUT 300
    ${TEST_PROPERTIES})
endfunction()
