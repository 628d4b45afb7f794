// A technique is a folder of server/renderers, and of server/shaders. Only its own files, the list
// of techniques and the probes of measure/ include from it.
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>

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

// The files of server/ that include a file of a technique in whose folder they are not. `room` is
// the path that such includes begin with.
std::set<std::string> ForeignFiles(const fs::path& server, const std::string& room,
                                   const std::set<std::string>& techniques) {
  const std::regex include("^#include \"" + room + "([a-z_]+)/.*\"");
  std::set<std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(server)) {
    if (!entry.is_regular_file()) continue;
    const std::string file = fs::relative(entry.path(), server);
    const std::string folder = entry.path().parent_path().filename();
    std::ifstream lines(entry.path());
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (!std::regex_search(line, match, include) || !techniques.contains(match[1])) continue;
      if (folder != match[1].str()) found.insert(file);
    }
  }
  return found;
}

const fs::path kServer = fs::path(THUNDERHEAD_SOURCE_DIR) / "server";

TEST(TechniqueFolders, AreIncludedByTheirOwnFilesTheirListAndTheProbesOfMeasure) {
  const std::set<std::string> techniques = Techniques(kServer / "renderers");
  EXPECT_THAT(techniques,
              ::testing::IsSupersetOf({"half_angle", "light_volume", "metaball", "cumulus"}));
  // measure/ looks into the buffers of techniques, where the interface shows only pictures.
  EXPECT_THAT(ForeignFiles(kServer, "renderers/", techniques),
              ::testing::ElementsAre("measure/extremes_metaballs.cc", "measure/probe.cc",
                                     "measure/soundness.h", "renderers/built_in_techniques.cc"));
  EXPECT_THAT(ForeignFiles(kServer / "shaders", "", techniques), ::testing::IsEmpty());
}

}  // namespace
}  // namespace thunderhead::renderers
