#include "base/trusted_proxies.h"

#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(TrustedProxiesTest, WhatOthersSayIsIgnored) {
  const TrustedProxies nobody;
  EXPECT_EQ(nobody.ClientOf("192.0.2.7:51234", "198.51.100.1"), "192.0.2.7:51234");
  const auto proxies = TrustedProxies::Parse({"127.0.0.1", "10.1.0.0/16", "2001:db8::/33"});
  ASSERT_TRUE(proxies.ok()) << proxies.status();
  EXPECT_EQ(proxies->ClientOf("192.0.2.7:51234", "198.51.100.1"), "192.0.2.7:51234");
  EXPECT_EQ(proxies->ClientOf("10.2.0.1:80", "198.51.100.1"), "10.2.0.1:80");
  EXPECT_EQ(proxies->ClientOf("[2001:db8:8000::1]:80", "198.51.100.1"), "[2001:db8:8000::1]:80");
}

TEST(TrustedProxiesTest, ATrustedProxyNamesItsClient) {
  const auto proxies = TrustedProxies::Parse({"127.0.0.1", "10.1.0.0/16", "2001:db8::/33"});
  ASSERT_TRUE(proxies.ok()) << proxies.status();
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:51234", "198.51.100.1"), "198.51.100.1:0");
  EXPECT_EQ(proxies->ClientOf("[::ffff:127.0.0.1]:51234", "198.51.100.1"), "198.51.100.1:0");
  EXPECT_EQ(proxies->ClientOf("[2001:db8:7fff::1]:80", " 2001:db9::5 "), "[2001:db9::5]:0");
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:1", "[2001:db9::5]:4711"), "[2001:db9::5]:0");
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:1", "198.51.100.1:4711"), "198.51.100.1:0");
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:51234", ""), "127.0.0.1:51234");
}

// The client sends its own header, to which the proxies append.
TEST(TrustedProxiesTest, WhatTheClientMadeUpIsNotBelieved) {
  const auto proxies = TrustedProxies::Parse({"127.0.0.1", "10.1.0.0/16"});
  ASSERT_TRUE(proxies.ok()) << proxies.status();
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:1", "203.0.113.9, 198.51.100.1"), "198.51.100.1:0");
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:1", "203.0.113.9, 198.51.100.1, 10.1.2.3"),
            "198.51.100.1:0");
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:1", "nonsense, 10.1.2.3"), "10.1.2.3:0");
  EXPECT_EQ(proxies->ClientOf("127.0.0.1:1", "nonsense"), "127.0.0.1:1");
}

TEST(TrustedProxiesTest, WrongOnesAreNamed) {
  for (const char* wrong : {"", "localhost", "10.1.0.0/33", "10.1.0.0/x", "::1/129", "1.2.3"}) {
    const auto proxies = TrustedProxies::Parse({"127.0.0.1", wrong});
    EXPECT_EQ(proxies.status().code(), absl::StatusCode::kInvalidArgument) << wrong;
  }
}

}  // namespace
}  // namespace thunderhead::base
