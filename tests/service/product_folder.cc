#include "tests/service/product_folder.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pipeline/sha256.h"

namespace thunderhead::testing {

namespace fs = std::filesystem;

std::string Contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::map<std::string, pipeline::ManifestEntry> EntriesOf(const std::string& manifest) {
  std::map<std::string, pipeline::ManifestEntry> entries;
  const std::string text = Contents(manifest);
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  for (std::string line; std::getline(lines, line);) {
    const auto entry = pipeline::FromLine(line);
    EXPECT_TRUE(entry.ok()) << line;
    if (!entry.ok()) continue;
    EXPECT_TRUE(entries.emplace(entry->file, *entry).second) << entry->file << " is there twice";
  }
  return entries;
}

void ExpectWholePictures(const std::string& folder) {
  if (!fs::exists(folder)) return;
  for (const auto& file : fs::directory_iterator(folder)) {
    if (file.path().extension() != ".png") continue;
    EXPECT_TRUE(frame::DecodePng(Contents(file.path().string())).ok()) << file.path();
  }
}

void ExpectFinished(const std::string& folder, const std::vector<std::string>& products,
                    const std::vector<std::string>& others) {
  const auto entries = EntriesOf((fs::path(folder) / "manifest.jsonl").string());
  std::vector<std::string> expected = products;
  expected.push_back("manifest.jsonl");
  expected.insert(expected.end(), others.begin(), others.end());
  std::vector<std::string> there;
  for (const auto& file : fs::directory_iterator(folder)) {
    there.push_back(file.path().filename().string());
  }
  EXPECT_THAT(there, ::testing::UnorderedElementsAreArray(expected));
  EXPECT_EQ(entries.size(), products.size());
  for (const std::string& product : products) {
    ASSERT_TRUE(entries.contains(product)) << product;
    const std::string bytes = Contents((fs::path(folder) / product).string());
    EXPECT_EQ(entries.at(product).sha256, pipeline::Sha256(bytes)) << product;
    EXPECT_EQ(entries.at(product).bytes, bytes.size()) << product;
  }
  ExpectWholePictures(folder);
}

}  // namespace thunderhead::testing
