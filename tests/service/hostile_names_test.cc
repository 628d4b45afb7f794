// Tests of the program on data folders whose names, titles and links come from an attacker.
#include <google/protobuf/reflection.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/utf8.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/service/running_program.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using Stub = v1::ThunderheadService::Stub;

// A second line that imitates an audit line, and an escape sequence that changes a terminal's
// title.
constexpr char kForged[] =
    "z\naudit time=2026-01-02T03:04:05.678Z identity=\"anna\" role=operator act=CloseSession\nx"
    "\x1b]0;owned\x07";

// Adds the strings of a message that are not one line of valid UTF-8, with their fields.
void FindUnprintable(const google::protobuf::Message& message, std::vector<std::string>* found) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const auto* field : fields) {
    const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
    for (int i = 0; i < count; ++i) {
      if (field->type() == google::protobuf::FieldDescriptor::TYPE_MESSAGE) {
        FindUnprintable(field->is_repeated() ? reflection.GetRepeatedMessage(message, field, i)
                                             : reflection.GetMessage(message, field),
                        found);
      } else if (field->type() == google::protobuf::FieldDescriptor::TYPE_STRING) {
        const std::string text = field->is_repeated()
                                     ? reflection.GetRepeatedString(message, field, i)
                                     : reflection.GetString(message, field);
        if (base::Printable(text) != text) {
          found->push_back(absl::StrCat(field->full_name(), ": ", text));
        }
      }
    }
  }
}

class HostileNamesTest : public ::testing::Test {
 protected:
  HostileNamesTest() { fs::create_directories(data_ / "sub"); }

  // Writes a storm. A title that is not empty is written into both attributes that the server
  // reports to clients.
  static void WriteStorm(const fs::path& path, const std::string& title = "") {
    SyntheticCf storm =
        ExtinctionFile(6, 6, 6, 500.0, 500.0, 500.0, [](auto, auto, auto) { return 1e-3; });
    if (!title.empty()) storm.attributes["title"] = storm.attributes["source"] = title;
    WriteCf(storm, path.string());
  }

  // Serves the data folder, and waits until the program is ready.
  void Serve(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"serve",       "--device", "software",    "--http",
                                       "127.0.0.1:0", "--grpc",   "127.0.0.1:0", "--state",
                                       "none",        "--data",   data_.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    program_ = std::make_unique<RunningProgram>(PROGRAM, arguments, out_, err_);
    std::smatch address;
    std::string output;
    ASSERT_TRUE(WaitFor([&] {
      output = Contents(out_);
      return std::regex_search(output, address, std::regex("gRPC ([0-9.:]+)")) || !program_->Runs();
    }));
    ASSERT_FALSE(address.empty()) << Contents(err_);
    stub_ = v1::ThunderheadService::NewStub(
        grpc::CreateChannel(address[1].str(), grpc::InsecureChannelCredentials()));
  }

  v1::ListStormsResponse Storms() {
    v1::ListStormsResponse storms;
    const grpc::Status status = Call(*stub_, &Stub::ListStorms, v1::ListStormsRequest(), &storms);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return storms;
  }

  static std::string Contents(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TemporaryFolder folder_;
  const fs::path data_ = folder_.Path() / "data";
  const std::string out_ = folder_.File("out");
  const std::string err_ = folder_.File("err");
  std::unique_ptr<RunningProgram> program_;
  std::unique_ptr<v1::ThunderheadService::Stub> stub_;
};

TEST_F(HostileNamesTest, WhatClientsAreToldIsPrintable) {
  WriteStorm(data_ / "M\xfcnchen.nc");
  WriteStorm(data_ / "a\nb.nc",
             "Gewitter \xfc"
             "ber M\xfcnchen");
  WriteStorm(data_ / "\xe2\x80\xaegpj.nc", "a\x1b[31m\nb");
  WriteStorm(data_ / "\u200fpng.\u061c1\U000e0041.nc", "a\u200eb\u3164");
  WriteStorm(data_ / std::string(240, 'x'), std::string(600, '\xc3'));
  WriteStorm(data_ / "long.nc", std::string(100'000, 'x'));
  Serve();
  const v1::ListStormsResponse storms = Storms();
  EXPECT_EQ(storms.storms_size(), 6);
  std::vector<std::string> unprintable;
  FindUnprintable(storms, &unprintable);
  for (const v1::StormSummary& storm : storms.storms()) {
    v1::DescribeStormRequest request;
    request.set_storm_id(storm.id());
    v1::DescribeStormResponse described;
    const grpc::Status status = Call(*stub_, &Stub::DescribeStorm, request, &described);
    EXPECT_TRUE(status.ok()) << storm.id() << ": " << status.error_message();
    FindUnprintable(described, &unprintable);
  }
  EXPECT_THAT(unprintable, ::testing::IsEmpty());
}

TEST_F(HostileNamesTest, ANameForgesNoLineOfTheLog) {
  WriteStorm(data_ / "good.nc");
  std::ofstream(data_ / kForged) << "no storm";
  std::ofstream(data_ / (std::string(kForged) + ".nc")) << "CDF\x01 cut short";
  fs::create_symlink("nowhere", data_ / (std::string(kForged) + "link.nc"));
  Serve();
  EXPECT_EQ(Storms().storms_size(), 1);
  program_->Signal(SIGTERM);
  EXPECT_EQ(program_->Wait().code, 0);
  const std::string log = Contents(err_);
  EXPECT_THAT(log, HasSubstr("z?audit time=2026-01-02"));
  EXPECT_THAT(log, Not(HasSubstr("\naudit time=2026-01-02")));
  EXPECT_EQ(log.find('\x1b'), std::string::npos);
}

TEST_F(HostileNamesTest, ItStartsWhereLinksLeadInCirclesAndOut) {
  const fs::path outside = folder_.Path() / "outside";
  fs::create_directories(outside / "private");
  WriteStorm(outside / "private" / "secret.nc");
  WriteStorm(data_ / "good.nc");
  for (const char* name : {"a", "b", "c"}) fs::create_symlink(".", data_ / name);
  fs::create_symlink("..", data_ / "sub" / "up");
  fs::create_symlink(outside, data_ / "sub" / "out");
  fs::create_symlink("/", data_ / "root");
  fs::create_symlink(outside / "private" / "secret.nc", data_ / "secret.nc");
  Serve({"--untrusted", data_.string()});
  const v1::ListStormsResponse storms = Storms();
  ASSERT_EQ(storms.storms_size(), 1);
  EXPECT_EQ(storms.storms(0).id(), "good");
}

}  // namespace
}  // namespace thunderhead::testing
