// Tests that a technique is a folder of server/renderers and of server/shaders. Only its own files,
// the list of techniques and the probes of measure/ include from it, and its bindings are there.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
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

// Returns the files of server/ that include a file of a technique but are not in its folder. `room`
// is the path that such includes begin with.
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

std::string TextOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// Returns the constants that `file` declares.
std::set<std::string> ConstantsOf(const fs::path& file) {
  const std::regex constant("const [a-z]+ (k[A-Za-z0-9_]+) =");
  const std::string text = TextOf(file);
  std::set<std::string> names;
  for (std::sregex_iterator at(text.begin(), text.end(), constant), end; at != end; ++at) {
    names.insert((*at)[1]);
  }
  return names;
}

// Returns the technique in whose folder a file is; empty for files that techniques share.
std::string TechniqueOf(const fs::path& file, const std::set<std::string>& techniques) {
  const std::string folder = file.parent_path().filename();
  const std::string room = file.parent_path().parent_path().filename();
  const bool is_technique =
      (room == "renderers" || room == "shaders") && techniques.contains(folder);
  return is_technique ? folder : "";
}

// Returns the users of each constant, by TechniqueOf, except the files that declare constants.
std::map<std::string, std::set<std::string>> UsersOf(const std::set<std::string>& constants,
                                                     const fs::path& server,
                                                     const std::set<std::string>& techniques) {
  const std::regex word("\\bk[A-Za-z0-9_]+\\b");
  std::map<std::string, std::set<std::string>> users;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(server)) {
    if (!entry.is_regular_file() || entry.path().filename() == "bindings.glsl") continue;
    const std::string technique = TechniqueOf(entry.path(), techniques);
    const std::string text = TextOf(entry.path());
    for (std::sregex_iterator at(text.begin(), text.end(), word), end; at != end; ++at) {
      if (constants.contains(at->str())) users[at->str()].insert(technique);
    }
  }
  return users;
}

const fs::path kServer = fs::path(THUNDERHEAD_SOURCE_DIR) / "server";

TEST(TechniqueFolders, AreIncludedByTheirOwnFilesTheirListAndTheProbesOfMeasure) {
  const std::set<std::string> techniques = Techniques(kServer / "renderers");
  EXPECT_THAT(techniques,
              ::testing::IsSupersetOf({"half_angle", "light_volume", "metaball", "cumulus"}));
  // measure/ reads the buffers of techniques, because the interface gives only pictures.
  EXPECT_THAT(ForeignFiles(kServer, "renderers/", techniques),
              ::testing::ElementsAre("measure/extremes_metaballs.cc", "measure/probe.cc",
                                     "measure/soundness.h", "renderers/built_in_techniques.cc"));
  EXPECT_THAT(ForeignFiles(kServer / "shaders", "", techniques), ::testing::IsEmpty());
}

TEST(TechniqueFolders, HaveTheBindingsThatTheyAloneUse) {
  const std::set<std::string> techniques = Techniques(kServer / "renderers");
  const std::set<std::string> shared = ConstantsOf(kServer / "shaders/common/bindings.glsl");
  const auto users = UsersOf(shared, kServer, techniques);
  EXPECT_THAT(shared, ::testing::Contains("kMediumPlaneUnit"));
  for (const std::string& constant : shared) {
    ASSERT_TRUE(users.contains(constant)) << constant << " is used by nobody";
    const std::set<std::string>& by = users.at(constant);
    EXPECT_TRUE(by.size() > 1 || by.contains("")) << constant << " belongs to " << *by.begin();
  }
}

}  // namespace
}  // namespace thunderhead::renderers
