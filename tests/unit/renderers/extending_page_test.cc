// Tests that docs/extending.md names only existing files. For each kind of extension the page may
// name only as many files as the project's rules allow.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead {
namespace {

namespace fs = std::filesystem;
using ::testing::Le;

const fs::path kSource = THUNDERHEAD_SOURCE_DIR;

// Returns the files named by the numbered steps of each section of the page. New files, which have
// NAME in their path, are left out.
std::map<std::string, std::set<std::string>> FilesBySection() {
  const std::regex file("`((?:server|proto|client-web|data|docs|tests)/[A-Za-z0-9_./-]+)`");
  std::ifstream page(kSource / "docs/extending.md");
  std::map<std::string, std::set<std::string>> sections;
  std::string section;
  bool in_step = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) section = line.substr(3);
    if (line.empty() || line.starts_with("#")) in_step = false;
    if (std::regex_search(line, std::regex("^[0-9]+\\. "))) in_step = true;
    for (std::sregex_iterator at(line.begin(), line.end(), file), end; at != end; ++at) {
      const std::string path = (*at)[1];
      if (path.find("NAME") != std::string::npos) continue;
      EXPECT_TRUE(fs::exists(kSource / path)) << section << ": " << path;
      if (in_step && !path.starts_with("tests/") && !path.ends_with("/"))
        sections[section].insert(path);
    }
  }
  return sections;
}

// The count includes existing files that a developer edits, without new files and tests. For a
// hydrometeor these are two, and one for each of the three formats that name their fields.
TEST(ExtendingPage, NamesFilesThatExistAndNoMoreThanAllowed) {
  auto files = FilesBySection();
  const std::map<std::string, std::size_t> allowed = {{"A technique (a renderer)", 4},
                                                      {"A storm format", 2},
                                                      {"A hydrometeor field", 5},
                                                      {"A parameter of a scene", 4},
                                                      {"A call (rpc)", 4},
                                                      {"A phase function by a formula", 3},
                                                      {"A phase function by a table", 3}};
  EXPECT_EQ(files.size(), allowed.size());
  for (const auto& [section, most] : allowed) {
    EXPECT_GT(files[section].size(), 0U) << section;
    EXPECT_THAT(files[section].size(), Le(most)) << section;
  }
}

}  // namespace
}  // namespace thunderhead
