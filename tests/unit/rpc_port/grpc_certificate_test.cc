#include "rpc_port/grpc_certificate.h"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/certificate_files.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"
#include "tests/support/self_signed.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::rpc_port {
namespace {

using ::testing::HasSubstr;

std::string Contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class GrpcCertificateTest : public ::testing::Test {
 protected:
  GrpcCertificateTest() { testing::WriteSelfSigned(files_.certificate, files_.key, 1); }

  std::string Pair() const {
    return absl::StrCat(Contents(files_.certificate), "\n", Contents(files_.key));
  }

  // Lets the thread look at the files.
  void Look() {
    time_.Advance(std::chrono::seconds(1));
    const int looks = time_.Looks();
    EXPECT_TRUE(testing::WaitFor([&] { return time_.Looks() >= looks + 2; }));
  }

  testing::TemporaryFolder folder_;
  testing::ManualTime time_;
  const base::TlsFiles files_{folder_.File("certificate.pem"), folder_.File("key.pem")};
};

// While another program writes a file, it is empty. gRPC would end the process.
TEST_F(GrpcCertificateTest, OnlyAPairThatFitsReplacesTheFormer) {
  const auto certificate = GrpcCertificate::Open(files_, time_);
  ASSERT_TRUE(certificate.ok()) << certificate.status();
  const std::string path = (*certificate)->CopyPath();
  const std::string first = Pair();
  EXPECT_EQ(Contents(path), first);
  for (const char* const text : {"", "no certificate", "-----BEGIN CERTIFICATE-----\n"}) {
    std::ofstream(files_.certificate) << text;
    Look();
    EXPECT_EQ(Contents(path), first) << text;
  }
  std::filesystem::remove(files_.certificate);
  Look();
  EXPECT_EQ(Contents(path), first);
  std::filesystem::create_symlink("/dev/zero", files_.certificate);
  Look();
  EXPECT_EQ(Contents(path), first);
  std::filesystem::remove(files_.certificate);
  ASSERT_EQ(mkfifo(files_.certificate.c_str(), 0600), 0);
  Look();
  EXPECT_EQ(Contents(path), first);
  std::filesystem::remove(files_.certificate);
  // The new certificate comes before its key.
  const std::string next_key = folder_.File("next_key.pem");
  testing::WriteSelfSigned(files_.certificate, next_key, 2);
  Look();
  EXPECT_EQ(Contents(path), first);
  std::filesystem::rename(next_key, files_.key);
  Look();
  EXPECT_EQ(Contents(path), Pair());
  EXPECT_NE(Contents(path), first);
  EXPECT_EQ((*certificate)->CopyPath(), path);
}

TEST_F(GrpcCertificateTest, FilesThatCannotBeUsedAreNamed) {
  const auto error_of = [this] {
    const absl::Status status = GrpcCertificate::Open(files_, time_).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return std::string(status.message());
  };
  testing::WriteSelfSigned(files_.certificate, folder_.File("other.pem"), 2);
  EXPECT_THAT(error_of(), HasSubstr(absl::StrCat("cannot use ", files_.key, " as the key of TLS")));
  std::ofstream(files_.certificate).flush();
  EXPECT_THAT(error_of(),
              HasSubstr(absl::StrCat("cannot use ", files_.certificate, " as the certificate")));
  std::filesystem::remove(files_.certificate);
  EXPECT_THAT(error_of(), HasSubstr("No such file"));
}

}  // namespace
}  // namespace thunderhead::rpc_port
