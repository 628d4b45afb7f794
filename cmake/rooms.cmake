# A room is one folder of server/ that is built as one static library, `thunderhead::NAME`. The function
# thunderhead_room(NAME [HEADERS set] [FILES files...] [SOURCES paths...] [DEPENDS rooms and libraries...]) makes this
# library from FILES. Without FILES it takes every .cc file of the folder that is not yet in another library. SOURCES
# are further files, for example in subfolders. HEADERS is the set of precompiled headers (cmake/headers.cmake), by
# default `headers`.
function(thunderhead_room name)
  cmake_parse_arguments(ROOM "" "HEADERS" "DEPENDS;SOURCES;FILES" ${ARGN})
  if(NOT ROOM_HEADERS)
    set(ROOM_HEADERS headers)
  endif()
  if(ROOM_FILES)
    list(TRANSFORM ROOM_FILES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE sources)
  else()
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
    get_property(taken DIRECTORY PROPERTY THUNDERHEAD_TAKEN)
    if(taken)
      list(REMOVE_ITEM sources ${taken})
    endif()
  endif()
  set_property(DIRECTORY APPEND PROPERTY THUNDERHEAD_TAKEN ${sources})
  list(APPEND sources ${ROOM_SOURCES})
  if(sources)
    add_library(thunderhead_${name} STATIC ${sources})
    target_link_libraries(thunderhead_${name} PUBLIC thunderhead_options ${ROOM_DEPENDS})
    target_precompile_headers(thunderhead_${name} REUSE_FROM thunderhead_${ROOM_HEADERS})
  else()
    add_library(thunderhead_${name} INTERFACE)
    target_link_libraries(thunderhead_${name} INTERFACE thunderhead_options ${ROOM_DEPENDS})
  endif()
  add_library(thunderhead::${name} ALIAS thunderhead_${name})
endfunction()

# Environment of tests that open a context, or that start a program that opens one. When Mesa unloads its driver, the
# driver has not freed all its memory. LeakSanitizer then cannot name the driver, so this memory looks like a leak of
# our code. These tests therefore run without LeakSanitizer.
set(THUNDERHEAD_GL_ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)

# thunderhead_test(NAME DEPENDS libraries...) builds the .cc files of the current folder, or SOURCES, into one
# GoogleTest program. It registers each of the suites with ctest under LABEL. The suites of a program with the option GL
# get the GL environment and the checks of gl/strict_programs.h. A program with the option WAITS, and the suites in
# WAITING, mostly wait, so they occupy only one place of ctest. HEADERS is the set of precompiled headers, by default
# `test_headers`.
function(thunderhead_test name)
  cmake_parse_arguments(TEST "GL;WAITS" "LABEL;HEADERS" "DEPENDS;SOURCES;WAITING;PROPERTIES" ${ARGN})
  if(NOT TEST_SOURCES)
    file(GLOB TEST_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  endif()
  if(TEST_GL)
    list(APPEND TEST_SOURCES ${CMAKE_SOURCE_DIR}/tests/support/strict_programs.cc)
  endif()
  if(NOT TEST_HEADERS)
    set(TEST_HEADERS test_headers)
  endif()
  set_property(DIRECTORY APPEND PROPERTY THUNDERHEAD_TAKEN ${TEST_SOURCES})
  add_executable(${name} ${TEST_SOURCES})
  target_precompile_headers(${name} REUSE_FROM thunderhead_${TEST_HEADERS})
  target_link_libraries(${name} PRIVATE thunderhead_options ${TEST_DEPENDS} GTest::gmock GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${THUNDERHEAD_TEST_OPTIONS})
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_compile_definitions(${name} PRIVATE THUNDERHEAD_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  if(TEST_GL)
    list(APPEND TEST_PROPERTIES ENVIRONMENT ${THUNDERHEAD_GL_ENVIRONMENT})
  endif()
  if(TEST_WAITS)
    list(PREPEND TEST_PROPERTIES ${THUNDERHEAD_WAITING_TEST})
  else()
    list(PREPEND TEST_PROPERTIES ${THUNDERHEAD_BUSY_TEST})
  endif()
  thunderhead_register_suites(${name} WAITING ${TEST_WAITING} PROPERTIES LABELS ${TEST_LABEL} ${TEST_PROPERTIES})
endfunction()

# Fails if a test file of the current folder is in none of its programs.
function(thunderhead_no_test_is_left_out)
  file(GLOB tests CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *_test.cc)
  get_property(taken DIRECTORY PROPERTY THUNDERHEAD_TAKEN)
  list(REMOVE_ITEM tests ${taken})
  if(tests)
    message(FATAL_ERROR "in none of the test programs of ${CMAKE_CURRENT_SOURCE_DIR}: ${tests}")
  endif()
endfunction()
