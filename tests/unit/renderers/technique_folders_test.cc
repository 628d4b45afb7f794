// A technique is a folder of server/renderers, and of server/shaders. Only its own files, and the
// files that choose between techniques, may include from it.
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

namespace fs = std::filesystem;

std::set<std::string> Techniques(const fs::path& renderers) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(renderers)) {
    if (entry.is_directory()) names.insert(entry.path().filename());
  }
  return names;
}

// "file includes what" for each include below `room` of a technique whose folder the file is not
// in. `room` is the path that includes begin with.
std::vector<std::string> ForeignIncludes(const fs::path& folder, const std::string& room,
                                         const std::set<std::string>& techniques) {
  const std::regex include("^#include \"" + room + "([a-z_]+)/.*\"");
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string file = fs::relative(entry.path(), folder);
    if (file == "built_in_techniques.cc") continue;
    std::ifstream lines(entry.path());
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (!std::regex_search(line, match, include) || !techniques.contains(match[1])) continue;
      if (absl::StartsWith(file, absl::StrCat(match[1].str(), "/"))) continue;
      found.push_back(absl::StrCat(file, ": ", line));
    }
  }
  return found;
}

const fs::path kServer = fs::path(THUNDERHEAD_SOURCE_DIR) / "server";

TEST(TechniqueFolders, AreIncludedByTheirOwnFilesOnly) {
  const std::set<std::string> techniques = Techniques(kServer / "renderers");
  EXPECT_THAT(techniques,
              ::testing::IsSupersetOf({"half_angle", "light_volume", "metaball", "cumulus"}));
  EXPECT_THAT(ForeignIncludes(kServer / "renderers", "renderers/", techniques),
              ::testing::IsEmpty());
  EXPECT_THAT(ForeignIncludes(kServer / "shaders", "", techniques), ::testing::IsEmpty());
}

}  // namespace
}  // namespace thunderhead::renderers
