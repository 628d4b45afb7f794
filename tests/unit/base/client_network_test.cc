#include "base/client_network.h"

#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(ClientNetworkTest, IsWhatOneClientHas) {
  EXPECT_EQ(NetworkOf("192.0.2.7:51234"), "192.0.2.7");
  EXPECT_EQ(NetworkOf("[2001:db8:1:2:3:4:5:6]:80"), "2001:db8:1:2::/64");
  EXPECT_EQ(NetworkOf("[2001:db8:1:2::7]:81"), "2001:db8:1:2::/64");
  EXPECT_EQ(NetworkOf("[::1]:80"), "::/64");
  EXPECT_EQ(NetworkOf(""), "");
}

TEST(ClientNetworkTest, Ipv4WrittenAsIpv6IsIpv4) {
  EXPECT_EQ(NetworkOf("[::ffff:192.0.2.7]:80"), "192.0.2.7");
  EXPECT_EQ(NetworkOf("[::ffff:c000:207]:80"), "192.0.2.7");
}

TEST(ClientNetworkTest, ALinkLocalAddressIsOneMachines) {
  EXPECT_EQ(NetworkOf("[fe80::1%eth0]:80"), "fe80::1%eth0");
}

}  // namespace
}  // namespace thunderhead::base
