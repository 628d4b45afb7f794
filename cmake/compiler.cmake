# Compiler settings of every target of ours; generated code (proto/) opts out of the warnings.
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# x86-64-v3 (AVX2, FMA, F16C) is every x86 server since 2015; half-float conversion needs it to be fast.
option(THUNDERHEAD_X86_64_V3 "Compile for x86-64-v3 processors" OFF)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
find_program(MOLD_PROGRAM mold)
if(MOLD_PROGRAM)
  add_link_options(-fuse-ld=mold)
endif()

# Tests call more than they compute, and are a third of what is compiled. Only their own files: libraries are optimised.
set(THUNDERHEAD_TEST_OPTIONS $<$<CONFIG:Release>:-O0>)

# GCC 12 reports overlaps and overruns inside std::string's own code (GCC bug 105651); that of precompiled headers is not
# told apart from ours.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  add_compile_options(-Wno-restrict -Wno-array-bounds -Wno-stringop-overread)
  # The same of literals joined to strings, in tests and where sanitizers change what is inlined.
  list(APPEND THUNDERHEAD_TEST_OPTIONS -Wno-stringop-overflow)
  if(THUNDERHEAD_SANITIZE)
    add_compile_options(-Wno-stringop-overflow)
  endif()
endif()

# One set of precompiled headers serves all only if all are compiled alike; ccache knows their files by the second flag.
add_compile_options(-pthread)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
endif()

add_library(thunderhead_warnings INTERFACE)
target_compile_options(thunderhead_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  -Wno-missing-field-initializers)
add_library(thunderhead_options INTERFACE)
target_include_directories(thunderhead_options INTERFACE ${CMAKE_SOURCE_DIR}/server)
target_link_libraries(thunderhead_options INTERFACE thunderhead_warnings)

if(THUNDERHEAD_X86_64_V3)
  add_compile_options(-march=x86-64-v3)
endif()
if(THUNDERHEAD_SANITIZE)
  # GCC 12 then takes copies of a std::variant for uses of what is uninitialised.
  add_compile_options(-fsanitize=${THUNDERHEAD_SANITIZE} -fno-omit-frame-pointer -Wno-error=maybe-uninitialized)
  add_link_options(-fsanitize=${THUNDERHEAD_SANITIZE})
  if(THUNDERHEAD_SANITIZE MATCHES "thread")
    # ThreadSanitizer does not know fences; Asio's only back up what its locks already order.
    add_compile_definitions(BOOST_ASIO_DISABLE_FENCED_BLOCK)
  endif()
  if(THUNDERHEAD_SANITIZE MATCHES "undefined")
    add_compile_options(-fno-sanitize-recover=undefined -fno-sanitize=vptr)
  endif()
endif()
if(THUNDERHEAD_FUZZ)
  add_compile_options(-fsanitize-coverage=trace-pc,trace-cmp)
endif()
if(THUNDERHEAD_COVERAGE)
  add_compile_options(--coverage)
  add_link_options(--coverage)
endif()
