# Precompiled headers: headers that many files include are compiled once per set instead of once per file (decision 50).
# Every file still includes what it uses, because the builds of ./dev lint and builds without GCC have no precompiled
# headers.

# thunderhead_headers(NAME DEPENDS libraries... [OPTIONS options...] HEADERS headers...) makes the set of precompiled
# headers thunderhead_NAME, for targets that have the same options.
function(thunderhead_headers name)
  cmake_parse_arguments(SET "" "" "DEPENDS;OPTIONS;HEADERS" ${ARGN})
  set(source ${CMAKE_BINARY_DIR}/headers/${name}.cc)
  file(CONFIGURE OUTPUT ${source} CONTENT "")
  add_library(thunderhead_${name} OBJECT ${source})
  target_link_libraries(thunderhead_${name} PRIVATE thunderhead_options ${SET_DEPENDS})
  target_compile_options(thunderhead_${name} PRIVATE ${SET_OPTIONS})
  target_precompile_headers(thunderhead_${name} PRIVATE ${SET_HEADERS})
endfunction()

set(THUNDERHEAD_STANDARD_HEADERS
  <algorithm> <array> <atomic> <chrono> <cmath> <condition_variable> <cstdint> <filesystem> <fstream> <functional> <limits> <map>
  <memory> <mutex> <numbers> <numeric> <optional> <set> <span> <stop_token> <string> <string_view> <thread> <utility> <variant> <vector>
  <absl/status/status.h> <absl/status/statusor.h> <absl/strings/match.h> <absl/strings/str_cat.h> <absl/strings/str_format.h>
  <absl/strings/str_join.h> <absl/strings/str_split.h> <absl/time/time.h> <spdlog/spdlog.h>
  <glm/common.hpp> <glm/geometric.hpp> <glm/mat3x3.hpp> <glm/trigonometric.hpp> <glm/vec2.hpp> <glm/vec3.hpp> <glm/vec4.hpp>)
set(THUNDERHEAD_STANDARD_LIBRARIES absl::status absl::statusor absl::strings absl::str_format absl::time spdlog::spdlog
  thunderhead_glm Threads::Threads)

thunderhead_headers(headers DEPENDS ${THUNDERHEAD_STANDARD_LIBRARIES} HEADERS ${THUNDERHEAD_STANDARD_HEADERS})
if(THUNDERHEAD_TESTS)
  thunderhead_headers(test_headers DEPENDS ${THUNDERHEAD_STANDARD_LIBRARIES} GTest::gmock OPTIONS ${THUNDERHEAD_TEST_OPTIONS}
    HEADERS ${THUNDERHEAD_STANDARD_HEADERS} <gmock/gmock.h> <gtest/gtest.h>)
endif()
if(THUNDERHEAD_SERVICE)
  set(rpc <grpcpp/grpcpp.h> <grpcpp/support/server_callback.h>
    <thunderhead/v1/interact.pb.h> <thunderhead/v1/job.grpc.pb.h> <thunderhead/v1/thunderhead.grpc.pb.h>)
  thunderhead_headers(rpc_headers DEPENDS ${THUNDERHEAD_STANDARD_LIBRARIES} thunderhead::proto
    HEADERS ${THUNDERHEAD_STANDARD_HEADERS} ${rpc})
  add_dependencies(thunderhead_rpc_headers thunderhead_proto_generated)
  if(THUNDERHEAD_TESTS)
    thunderhead_headers(rpc_test_headers DEPENDS ${THUNDERHEAD_STANDARD_LIBRARIES} thunderhead::proto GTest::gmock
      OPTIONS ${THUNDERHEAD_TEST_OPTIONS}
      HEADERS ${THUNDERHEAD_STANDARD_HEADERS} ${rpc} <gmock/gmock.h> <gtest/gtest.h>)
    add_dependencies(thunderhead_rpc_test_headers thunderhead_proto_generated)
  endif()
endif()
