# Builds TARGETS in the build folder BUILD, on one processor like any test.
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --parallel 1 --target ${TARGETS} RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "The toys of tests/extending cannot be built. Either docs/extending.md does not name every file that "
    "an extension changes, or a toy must be adapted to a changed file (tests/extending/toys.py).")
endif()
