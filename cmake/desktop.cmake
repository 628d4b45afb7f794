# The libraries of the C++ client and the native client. They are Debian 12 packages (deploy/packages/desktop.txt).
find_package(Threads REQUIRED)
find_package(absl REQUIRED)
find_package(Protobuf REQUIRED)
find_package(gRPC CONFIG REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(OpenGL REQUIRED COMPONENTS OpenGL)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(VPX REQUIRED IMPORTED_TARGET vpx)
pkg_check_modules(AVIF REQUIRED IMPORTED_TARGET libavif)
pkg_check_modules(SDL2 REQUIRED IMPORTED_TARGET sdl2)
pkg_check_modules(IMGUI REQUIRED IMPORTED_TARGET imgui)
# libyuv has neither a CMake nor a pkg-config file.
find_path(YUV_INCLUDE_DIR libyuv.h REQUIRED)
find_library(YUV_LIBRARY yuv REQUIRED)
if(THUNDERHEAD_TESTS)
  find_package(GTest REQUIRED)
  include(suites)
  # These tests are not compiled with -O0 like other tests, because they share the library's precompiled header, which
  # is optimised.
  set(THUNDERHEAD_CLIENT_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)
endif()
