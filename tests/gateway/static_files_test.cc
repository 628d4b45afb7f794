#include "gateway/static_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace thunderhead::gateway {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void Write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

// A fixture with a page next to secret files that no request may reach.
class StaticFilesTest : public ::testing::Test {
 protected:
  StaticFilesTest() {
    Write(root_ / "index.html", "<html>");
    Write(root_ / "favicon.svg", "<svg>");
    Write(root_ / "assets/index-Ab12.js", "1");
    Write(root_ / "a b.txt", "spaced");
    Write(root_ / ".built", "hidden");
    Write(folder_.Path() / "secret.txt", "secret");
    // The name of this folder begins with the page's name.
    Write(folder_.Path() / "page-secret/key", "secret");
    fs::create_symlink(folder_.Path() / "secret.txt", root_ / "leak.txt");
    fs::create_directory_symlink(folder_.Path() / "page-secret", root_ / "leak");
    fs::create_symlink("favicon.svg", root_ / "alias.svg");
  }

  std::optional<StaticFile> Find(const std::string& path,
                                 const std::string& accept_encoding = "") const {
    return StaticFiles::Open(root_.string())->Find(path, accept_encoding);
  }

  testing::TemporaryFolder folder_;
  fs::path root_ = folder_.Path() / "page";
};

TEST_F(StaticFilesTest, FindsThePageAndItsFiles) {
  ASSERT_TRUE(Find("/").has_value());
  EXPECT_EQ(Find("/")->content_type, "text/html; charset=utf-8");
  EXPECT_EQ(Find("/")->path, Find("/index.html")->path);
  EXPECT_EQ(Find("/favicon.svg")->content_type, "image/svg+xml");
  EXPECT_EQ(Find("/assets/index-Ab12.js")->content_type, "text/javascript; charset=utf-8");
  EXPECT_TRUE(Find("/a%20b.txt").has_value());
  // A link within the page works like any other file.
  EXPECT_TRUE(Find("/alias.svg").has_value());
}

TEST_F(StaticFilesTest, OnlyHashedAssetsAreKeptForever) {
  EXPECT_THAT(Find("/assets/index-Ab12.js")->cache_control, HasSubstr("immutable"));
  EXPECT_EQ(Find("/")->cache_control, "no-cache");
  EXPECT_EQ(Find("/favicon.svg")->cache_control, "no-cache");
}

TEST_F(StaticFilesTest, NeverLeavesThePage) {
  for (const char* path :
       {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
        "/%2e%2e%2fsecret.txt", "/assets/..%2f..%2fsecret.txt", "/..\\secret.txt",
        "/..%5csecret.txt", "//secret.txt", "/leak.txt", "/leak/key", "/../page-secret/key",
        "/%252e%252e/secret.txt", "/favicon.svg%00.txt", "/./favicon.svg", "secret.txt", ""}) {
    EXPECT_FALSE(Find(path).has_value()) << path;
  }
}

TEST_F(StaticFilesTest, FindsNoFoldersHiddenOrMissingFiles) {
  for (const char* path : {"/assets", "/assets/", "/.built", "/nothing", "/favicon.svg/", "/%",
                           "/%2", "/%zz", "/assets/%2ehidden"}) {
    EXPECT_FALSE(Find(path).has_value()) << path;
  }
}

TEST_F(StaticFilesTest, EntityTagFollowsTheFile) {
  const std::string before = Find("/favicon.svg")->entity_tag;
  EXPECT_EQ(before, Find("/favicon.svg")->entity_tag);
  const fs::path path = root_ / "favicon.svg";
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(1));
  EXPECT_NE(before, Find("/favicon.svg")->entity_tag);
}

TEST_F(StaticFilesTest, FilesWithAGzipFileBesideThemHaveTwoEncodings) {
  const fs::path script = root_ / "assets/index-Ab12.js";
  Write(fs::path(script) += ".gz", "packed");
  const StaticFile plain = Find("/assets/index-Ab12.js").value();
  const StaticFile packed = Find("/assets/index-Ab12.js", "gzip, deflate, br").value();
  EXPECT_EQ(plain.path, fs::canonical(script));
  EXPECT_EQ(plain.content_encoding, "");
  EXPECT_EQ(packed.path, fs::canonical(script) += ".gz");
  EXPECT_EQ(packed.content_encoding, "gzip");
  EXPECT_TRUE(plain.varies);
  EXPECT_TRUE(packed.varies);
  EXPECT_EQ(packed.content_type, plain.content_type);
  EXPECT_EQ(packed.cache_control, plain.cache_control);
  EXPECT_NE(packed.entity_tag, plain.entity_tag);

  const StaticFile alone = Find("/favicon.svg", "gzip").value();
  EXPECT_EQ(alone.content_encoding, "");
  EXPECT_FALSE(alone.varies);
}

TEST_F(StaticFilesTest, AGzipFileOfAnotherContentIsNotSent) {
  const fs::path icon = root_ / "favicon.svg";
  const fs::path packed = fs::path(icon) += ".gz";
  Write(packed, "packed");
  fs::last_write_time(packed, fs::last_write_time(icon) - std::chrono::milliseconds(1));
  EXPECT_EQ(Find("/favicon.svg", "gzip")->content_encoding, "");
  EXPECT_FALSE(Find("/favicon.svg", "gzip")->varies);
  fs::last_write_time(packed, fs::last_write_time(icon));
  EXPECT_EQ(Find("/favicon.svg", "gzip")->content_encoding, "gzip");
}

TEST_F(StaticFilesTest, AGzipFileNeverLeadsOutOfThePage) {
  fs::create_symlink(folder_.Path() / "secret.txt", root_ / "favicon.svg.gz");
  fs::create_directory(root_ / "index.html.gz");
  EXPECT_EQ(Find("/favicon.svg", "gzip")->content_encoding, "");
  EXPECT_EQ(Find("/", "gzip")->content_encoding, "");
}

TEST_F(StaticFilesTest, OpenWantsAPage) {
  const absl::Status missing = StaticFiles::Open((root_ / "no").string()).status();
  EXPECT_EQ(missing.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.message()), HasSubstr("./dev build"));
  const absl::Status empty = StaticFiles::Open((root_ / "assets").string()).status();
  EXPECT_THAT(std::string(empty.message()), HasSubstr("index.html"));
  // Without a directory there is no page, which is not an error.
  ASSERT_TRUE(StaticFiles::Open("").ok());
  EXPECT_FALSE(StaticFiles::Open("")->Find("/").has_value());
  EXPECT_FALSE(StaticFiles::Open("")->Find("/etc/passwd").has_value());
}

TEST(AcceptEncoding, GzipMustBeAcceptedAndNotRankedBelowThePlainFile) {
  for (const char* accepted :
       {"gzip", "GZIP", "x-gzip", "gzip, deflate, br, zstd", "br;q=1.0, gzip;q=0.5", "*",
        "gzip;q=0.001", "deflate , gzip ; q=0.3", "gzip, *;q=0", "identity;q=0.5, gzip;q=1",
        "gzip;q=1, identity;q=1", "identity;q=0, *"}) {
    EXPECT_TRUE(PrefersGzip(accepted)) << accepted;
  }
  for (const char* refused :
       {"", "identity", "br", "deflate, br", "gzip;q=0", "gzip; q=0.0", "gzip;Q=0", "*;q=0",
        "gzip;q=0, *", "identity, gzip;q=0.5", "gzip;q=x", "gzip;q=-1", "gzippy", ",", ";q=1"}) {
    EXPECT_FALSE(PrefersGzip(refused)) << refused;
  }
}

TEST(EntityTag, MatchesAnyOfTheCandidates) {
  EXPECT_TRUE(MatchesEntityTag("\"a\"", "\"a\""));
  EXPECT_TRUE(MatchesEntityTag("\"b\", W/\"a\"", "\"a\""));
  EXPECT_TRUE(MatchesEntityTag("*", "\"a\""));
  EXPECT_FALSE(MatchesEntityTag("", "\"a\""));
  EXPECT_FALSE(MatchesEntityTag("\"ab\"", "\"a\""));
}

}  // namespace
}  // namespace thunderhead::gateway
