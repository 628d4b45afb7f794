# Compiler settings of all our targets. Generated code (proto/) disables the warnings.
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# Every x86 server since 2015 supports x86-64-v3 (AVX2, FMA, F16C). Conversion of half floats is fast only with these
# instructions.
option(THUNDERHEAD_X86_64_V3 "Compile for x86-64-v3 processors" OFF)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
find_program(MOLD_PROGRAM mold)
if(MOLD_PROGRAM)
  add_link_options(-fuse-ld=mold)
endif()

# The tests' own files are compiled without optimisation, because they compute little and are a third of the compiled
# code. The libraries that they test are optimised.
set(THUNDERHEAD_TEST_OPTIONS $<$<CONFIG:Release>:-O0>)

# GCC 12 reports overlaps and overruns inside std::string's own code (GCC bug 105651). In code from precompiled headers,
# GCC cannot distinguish these false warnings from warnings about our code.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  add_compile_options(-Wno-restrict -Wno-array-bounds -Wno-stringop-overread)
  # The same false warnings appear for literals joined to strings, in tests and where sanitizers change the inlining.
  list(APPEND THUNDERHEAD_TEST_OPTIONS -Wno-stringop-overflow)
  if(THUNDERHEAD_SANITIZE)
    add_compile_options(-Wno-stringop-overflow)
  endif()
endif()

# Targets can share a precompiled header only if they are compiled with the same flags, so all targets get -pthread. The
# flag -fpch-preprocess lets ccache find the files of a precompiled header.
add_compile_options(-pthread)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
  # GCC collects its garbage only beyond 500 MB of memory (given in kB) instead of 128 MB. Test files then compile in 15 %
  # less processor time, and take a quarter more memory (1.4 GB at most).
  add_compile_options(--param=ggc-min-heapsize=500000)
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
  # With sanitizers, GCC 12 takes copies of a std::variant for uses of uninitialised memory.
  add_compile_options(-fsanitize=${THUNDERHEAD_SANITIZE} -fno-omit-frame-pointer -Wno-error=maybe-uninitialized)
  add_link_options(-fsanitize=${THUNDERHEAD_SANITIZE})
  if(THUNDERHEAD_SANITIZE MATCHES "thread")
    # ThreadSanitizer does not support fences. Asio's fences are switched off, because they only repeat the order that
    # its locks already guarantee.
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
