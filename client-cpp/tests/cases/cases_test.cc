// Runs the cases that all clients share: tests/clients/README.md.
#include <cctype>

#include "client-cpp/tests/cases/runners.h"
#include "gmock/gmock.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"

namespace thunderhead::client::testing {

// Prints a case in messages of GoogleTest.
void PrintTo(const Case& each, std::ostream* out) { *out << each.file << ": " << each.name; }

namespace {

const std::map<std::string, Runner>& Runners() {
  static const std::map<std::string, Runner> runners{
      {"back_off", RunBackOff},     {"camera", RunCamera},
      {"clamp", RunClamp},          {"control_resumption", RunControlResumption},
      {"limits", RunLimits},        {"parameters", RunParameters},
      {"playback", RunPlayback},    {"projection", RunProjection},
      {"scene_sync", RunSceneSync}, {"session_state", RunSessionState},
  };
  return runners;
}

class CasesTest : public ::testing::TestWithParam<Case> {};

TEST_P(CasesTest, DoesWhatIsExpected) {
  const auto runner = Runners().find(GetParam().file);
  ASSERT_NE(runner, Runners().end()) << "client-cpp has no runner of " << GetParam().file;
  EXPECT_NO_THROW(RunCase(runner->second, GetParam()));
}

std::string NameOf(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.file + "_";
  for (const char letter : info.param.name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0;
    if (plain || name.back() != '_') name += plain ? letter : '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(ClientCases, CasesTest, ::testing::ValuesIn(CasesOf("cpp")), NameOf);

TEST(CaseFilesTest, EveryRunnerHasAFile) {
  std::set<std::string> files;
  for (const Case& each : CasesOf("cpp")) files.insert(each.file);
  for (const auto& [name, runner] : Runners()) EXPECT_TRUE(files.contains(name)) << name;
}

// Runs a case with this one step and returns the text of the failure; empty if it passes. The
// runner knows one action, "add". Its result "sum" is its argument "by".
std::string FailureOf(const std::string& step, const std::string& given = "{}") {
  Case each;
  each.steps.emplace_back();
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(step, &each.steps.front()).ok());
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(given, &each.given).ok());
  const Runner runner = [](Arguments&) -> Actions {
    return {{"add", [](Arguments& arguments) -> Results {
               return {{"sum", JsonOf(arguments.Number("by"))}};
             }}};
  };
  try {
    RunCase(runner, each);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(CaseFilesTest, ACaseThatTheRunnerDoesNotUnderstandFails) {
  using ::testing::HasSubstr;
  EXPECT_EQ(FailureOf(R"({"do": "add", "by": 1, "expect": {"sum": 1}})"), "");
  EXPECT_THAT(FailureOf(R"({"do": "divide", "expect": {}})"),
              HasSubstr("does not know the action"));
  EXPECT_THAT(FailureOf(R"({"do": "add", "by": 1, "slow": true, "expect": {}})"),
              HasSubstr("does not know: slow"));
  EXPECT_THAT(FailureOf(R"({"do": "add", "by": 1, "expect": {"rest": 0}})"),
              HasSubstr("does not know the result"));
  EXPECT_THAT(FailureOf(R"({"do": "add", "by": 1, "expect": {"sum": 2}})"),
              HasSubstr("is 1 in place of 2"));
  EXPECT_THAT(FailureOf(R"({"do": "add", "by": "1", "expect": {}})"), HasSubstr("is no number"));
  EXPECT_THAT(FailureOf(R"({"do": "add", "by": 1, "expect": {}})", R"({"from": 1})"),
              HasSubstr("does not know: from"));
  EXPECT_THAT(FailureOf(R"({"do": "add", "by": 1})"), HasSubstr("expects nothing"));
}

}  // namespace
}  // namespace thunderhead::client::testing
