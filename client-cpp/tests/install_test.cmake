# Installs the library in a prefix, and builds the example against it outside the tree:
#   cmake -DBUILD=build/desktop -DEXAMPLES=client-cpp/examples -DWORK=folder -P install_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failure OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(failure)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "${command}: ${failure}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --component client-dev --prefix ${WORK}/prefix)
file(COPY ${EXAMPLES}/ DESTINATION ${WORK}/example)
set(configure ${CMAKE_COMMAND} -S ${WORK}/example -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(${configure} -B ${WORK}/build)
run(${CMAKE_COMMAND} --build ${WORK}/build)
execute_process(COMMAND ${WORK}/build/save_picture RESULT_VARIABLE status ERROR_VARIABLE said)
if(NOT status EQUAL 64 OR NOT said MATCHES "usage:")
  message(FATAL_ERROR "the example ends with ${status}: ${said}")
endif()

# No installed file may contain the path of the source tree in which the library was built.
get_filename_component(source ${EXAMPLES}/../.. REALPATH)
file(GLOB_RECURSE texts ${WORK}/prefix/*.cmake ${WORK}/prefix/*.h)
foreach(text IN LISTS texts)
  file(READ ${text} content)
  string(FIND "${content}" ${source} at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR "${text} names ${source}")
  endif()
endforeach()

# Tests a program that has already found gRPC and Protobuf itself.
file(WRITE ${WORK}/dependencies.cmake "find_package(Protobuf REQUIRED)\nfind_package(gRPC CONFIG REQUIRED)\n")
run(${configure} -B ${WORK}/build_after -DCMAKE_PROJECT_INCLUDE=${WORK}/dependencies.cmake)

# The desktop client's package must contain only the desktop client.
run(${CMAKE_COMMAND} --install ${BUILD} --component desktop --prefix ${WORK}/package)
foreach(folder include lib)
  if(EXISTS ${WORK}/package/${folder})
    message(FATAL_ERROR "the package of the window has ${folder}/")
  endif()
endforeach()
