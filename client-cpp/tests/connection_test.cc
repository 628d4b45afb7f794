// Tests of the errors that a connection reports before its first call.
#include "thunderhead_client/connection.h"

#include <fstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::client {
namespace {

using ::testing::HasSubstr;

class PlaintextTokenTest : public ::testing::Test {
 protected:
  PlaintextTokenTest() { std::ofstream(file_) << "secret\n"; }
  ~PlaintextTokenTest() override { std::remove(file_.c_str()); }

  const std::string file_ = ::testing::TempDir() + "plaintext_token_test";
};

TEST_F(PlaintextTokenTest, IsNotSentToAnotherMachine) {
  for (const char* const address :
       {"storms.example.org:50051", "192.0.2.7:50051", "[2001:db8::1]:50051",
        "localhost.example.org:50051", "1270.0.0.1:1"}) {
    ServerAccess access{.address = address, .tls_ca_file = "", .token_file = file_};
    EXPECT_THAT(std::string(Connection::Open(access).status().message()),
                HasSubstr("without encryption"))
        << address;
    access.allow_plaintext_token = true;
    EXPECT_TRUE(Connection::Open(access).ok()) << address;
    EXPECT_TRUE(Connection::Open({.address = address, .tls_ca_file = "", .token_file = ""}).ok());
  }
}

TEST_F(PlaintextTokenTest, IsSentToThisMachine) {
  for (const char* const address :
       {"localhost:50051", "127.0.0.1:50051", "127.1.2.3:1", "[::1]:50051"}) {
    EXPECT_TRUE(Connection::Open({.address = address, .tls_ca_file = "", .token_file = file_}).ok())
        << address;
  }
}

}  // namespace
}  // namespace thunderhead::client
