#include "app/config_file.h"

#include <fstream>
#include <string>

#include "app/serve_flags.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ConfigFileTest : public ::testing::Test {
 protected:
  ConfigFileTest() { AddServeFlags(*serve_, flags_); }

  // Returns whether a settings file may have this setting.
  bool Accepts(const std::string& setting) {
    const std::string file = folder_.File("serve.conf");
    std::ofstream(file) << setting << "=\"\"\n";  // an empty value keeps the default
    const absl::Status read = ReadConfigFile(*serve_, file);
    if (!read.ok()) {
      EXPECT_THAT(std::string(read.message()), HasSubstr("there is no setting"));
    }
    return read.ok();
  }

  const testing::TemporaryFolder folder_;
  ServeFlags flags_;
  CLI::App app_;
  CLI::App* const serve_ = app_.add_subcommand("serve");
};

TEST_F(ConfigFileTest, EverySettingThatAFileMayHaveIsPrinted) {
  const std::string printed = ConfigFileOf(*serve_);
  int accepted = 0;
  for (const CLI::Option* option : serve_->get_options({})) {
    const std::string name = option->get_single_name();
    const bool is_printed = printed.find("\n" + name + "=") != std::string::npos;
    EXPECT_EQ(is_printed, Accepts(name)) << name;
    accepted += is_printed ? 1 : 0;
  }
  EXPECT_GT(accepted, 60);
  EXPECT_TRUE(Accepts("roster-timeouts"));
  EXPECT_FALSE(Accepts("print-config"));
}

TEST_F(ConfigFileTest, HeadingsArePlain) {
  const std::string printed = ConfigFileOf(*serve_);
  EXPECT_THAT(printed, HasSubstr("; Settings of `thunderhead serve`"));
  for (const char* const heading : {"Rarely changed settings", "Access", "Render jobs"}) {
    EXPECT_THAT(printed, HasSubstr("\n; ---- " + std::string(heading) + " ----\n"));
  }
  EXPECT_THAT(printed, Not(HasSubstr(" Options\n")));
}

}  // namespace
}  // namespace thunderhead::app
