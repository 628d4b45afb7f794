// Tests of the program with a memory budget and more storms than fit in it.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/interacting.h"
#include "tests/service/served_program.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using Response = v1::InteractResponse;
using Stub = v1::ThunderheadService::Stub;

constexpr int kStorms = 24;
constexpr double kBudget_mib = 256.0;  // drawing one storm takes about half of it

// Returns a value of /proc/PID/status, in MiB.
double StatusMib(pid_t process, const std::string& name) {
  std::ifstream status(absl::StrCat("/proc/", process, "/status"));
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name + ":")) return std::stod(line.substr(name.size() + 1)) / 1024.0;
  }
  return 0.0;
}

std::string NameOf(int storm) { return absl::StrCat("storm", storm < 10 ? "0" : "", storm); }

bool HasPicture(const Interacting::Messages& messages) {
  return std::ranges::any_of(messages, [](const Response& message) { return message.has_frame(); });
}

// Checks that all problems so far are about memory.
void CheckProblems(Interacting& viewer) {
  for (const Response& message : viewer.All()) {
    if (!message.has_problem()) continue;
    EXPECT_THAT(message.problem().message(), ::testing::HasSubstr("of memory; "));
  }
}

TEST(MemoryLimitTest, SessionsOnDifferentLargeTimesKeepWithinTheBudget) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer's own memory is several times the budget";
#endif
  const TemporaryFolder folder;
  const std::string first = folder.File(NameOf(0) + ".nc");
  // 0.8 million cells: 10 MiB for each time. All times and the memory for drawing them
  // exceed the budget.
  WriteCf(ExtinctionFile(128, 128, 48, 250.0, 250.0, 250.0,
                         [](auto x, auto y, auto z) {
                           return z > 8 && z < 40 && (x / 16 + y / 16) % 2 == 0 ? 0.02 : 0.0;
                         }),
          first);
  std::vector<std::string> more = {"--memory-budget", "256MiB", "--max-sessions-each", "100",
                                   "--max-sessions",  "100",    "--read-deadline",     "600",
                                   "--data"};
  for (int i = 1; i < kStorms; ++i) {
    more.push_back(folder.File(NameOf(i) + ".nc"));
    std::filesystem::create_hard_link(first, more.back());
  }
  ServedProgram program(PROGRAM, first, "none", more);
  ASSERT_NE(program.stub(), nullptr);
  // After the first picture, the software renderer, the shader programs and gRPC have allocated
  // their memory. This memory does not count towards the budget.
  double shown_mib = 0.0;
  std::vector<std::unique_ptr<Interacting>> viewers;
  for (int i = 0; i < kStorms; ++i) {
    v1::CreateSessionRequest request;
    v1::Scene& scene = *request.mutable_scene();
    scene.set_storm_id(NameOf(i));
    scene.mutable_output()->set_width_px(64);
    scene.mutable_output()->set_height_px(36);
    // The camera is given, so that opening a session needs no fields.
    scene.mutable_camera()->mutable_top_down();
    v1::CreateSessionResponse created;
    grpc::Status status;
    // Clients that are told when to retry do so.
    WaitFor([&] {
      status = Call(*program.stub(), &Stub::CreateSession, request, &created);
      if (status.error_code() != grpc::StatusCode::RESOURCE_EXHAUSTED) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      return false;
    });
    ASSERT_TRUE(status.ok()) << status.error_message();
    viewers.push_back(std::make_unique<Interacting>(*program.stub(), created.session_id()));
    if (i > 0) continue;
    ASSERT_TRUE(viewers[0]->Await([](const Interacting::Messages& messages) {
      return std::ranges::any_of(messages, [](const Response& message) {
        return message.frame().modelled().traced_paths() > 0;
      });
    }));
    shown_mib = StatusMib(program.process(), "VmHWM");
  }
  // A viewer that is refused meanwhile is told why, and gets its turn later.
  std::size_t pictures = 0;
  for (const auto& viewer : viewers) {
    if (viewer->Await(HasPicture)) ++pictures;
    CheckProblems(*viewer);
  }
  const double most_mib = StatusMib(program.process(), "VmHWM");
  std::cout << pictures << " sessions have pictures; " << shown_mib
            << " MiB with the first, at most " << most_mib << " MiB\n";
  EXPECT_EQ(pictures, static_cast<std::size_t>(kStorms));
  EXPECT_LE(most_mib, shown_mib + kBudget_mib);
}

}  // namespace
}  // namespace thunderhead::testing
