#include "gateway/grpc_web_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thunderhead::gateway {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(ContentType, OnlyBinaryGrpcWebIsServed) {
  EXPECT_TRUE(IsBinaryGrpcWeb("application/grpc-web"));
  EXPECT_TRUE(IsBinaryGrpcWeb("application/grpc-web+proto"));
  EXPECT_TRUE(IsBinaryGrpcWeb("Application/gRPC-Web+proto ; charset=utf-8"));
  for (const char* other : {"application/grpc-web-text", "application/grpc-web-text+proto",
                            "application/grpc", "application/grpc-web+json", "text/plain", ""}) {
    EXPECT_FALSE(IsBinaryGrpcWeb(other)) << other;
  }
}

TEST(MethodPath, IsAServiceAndAMethod) {
  EXPECT_TRUE(IsMethodPath("/thunderhead.v1.ThunderheadService/WatchFrames"));
  EXPECT_TRUE(IsMethodPath("/Echo/Say"));
  for (const char* other :
       {"/", "//Say", "/Echo", "/Echo/", "/a/b/c", "Echo/Say", "/Echo/S%61y", "/Echo/..%2f", ""}) {
    EXPECT_FALSE(IsMethodPath(other)) << other;
  }
}

std::string Bytes(std::initializer_list<int> bytes) {
  return std::string(bytes.begin(), bytes.end());
}

TEST(TakeSingleMessage, UnwrapsTheMessage) {
  const std::string body = Bytes({0, 0, 0, 0, 3, 'a', 0, 'c'});
  ASSERT_TRUE(TakeSingleMessage(body).ok());
  EXPECT_EQ(*TakeSingleMessage(body), Bytes({'a', 0, 'c'}));
  const std::string empty = Bytes({0, 0, 0, 0, 0});
  ASSERT_TRUE(TakeSingleMessage(empty).ok());
  EXPECT_EQ(*TakeSingleMessage(empty), "");
}

TEST(TakeSingleMessage, SaysWhatIsWrong) {
  const auto error = [](const std::string& body) { return TakeSingleMessage(body).status(); };
  EXPECT_EQ(error("").code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(error(Bytes({0, 0, 0, 0})).code(), absl::StatusCode::kInvalidArgument);
  // The announced size exceeds the body by one byte and by four gigabytes.
  EXPECT_THAT(error(Bytes({0, 0, 0, 0, 2, 'a'})).message().data(), HasSubstr("announces 2 bytes"));
  EXPECT_THAT(error(Bytes({0, 255, 255, 255, 255, 'a'})).message().data(),
              HasSubstr("announces 4294967295 bytes"));
  // The body contains a second message.
  EXPECT_THAT(error(Bytes({0, 0, 0, 0, 0, 0, 0, 0, 0, 0})).message().data(),
              HasSubstr("5 bytes after its first message"));
  EXPECT_EQ(error(Bytes({1, 0, 0, 0, 0})).code(), absl::StatusCode::kUnimplemented);
  // Only servers send trailer frames.
  EXPECT_THAT(error(Bytes({0x80, 0, 0, 0, 0})).message().data(), HasSubstr("0x80"));
}

TEST(Frames, AreBigEndian) {
  EXPECT_THAT(MessageFrameHeader(0x01020304), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(TrailerFrame({{"a", "b"}, {"c", ""}}), Bytes({0x80, 0, 0, 0, 9}) + "a:b\r\nc:\r\n");
}

TEST(Trailers, BeginWithTheStatus) {
  EXPECT_THAT(Trailers(absl::StatusCode::kOk, "", {{"x", "y"}}),
              ElementsAre(Pair("grpc-status", "0"), Pair("x", "y")));
  EXPECT_THAT(Trailers(absl::StatusCode::kNotFound, "no\n50% \u00e9", {}),
              ElementsAre(Pair("grpc-status", "5"), Pair("grpc-message", "no%0A50%25 %C3%A9")));
}

TEST(ParseTimeout, ReadsEveryUnit) {
  EXPECT_EQ(*ParseTimeout("2H"), absl::Hours(2));
  EXPECT_EQ(*ParseTimeout("3M"), absl::Minutes(3));
  EXPECT_EQ(*ParseTimeout("4S"), absl::Seconds(4));
  EXPECT_EQ(*ParseTimeout("250m"), absl::Milliseconds(250));
  EXPECT_EQ(*ParseTimeout("6u"), absl::Microseconds(6));
  EXPECT_EQ(*ParseTimeout("00000007n"), absl::Nanoseconds(7));
  EXPECT_EQ(*ParseTimeout("99999999H"), absl::Hours(99999999));
  for (const char* bad : {"", "S", "5", "5s", "-5S", "+5S", "1.5S", "123456789S", "5 S", "S5"}) {
    EXPECT_EQ(ParseTimeout(bad).status().code(), absl::StatusCode::kInvalidArgument) << bad;
  }
}

Metadata Added(std::string_view name, std::string_view value) {
  Metadata metadata;
  EXPECT_TRUE(AddRequestHeader(name, value, metadata).ok()) << name;
  return metadata;
}

TEST(RequestHeaders, BecomeMetadata) {
  EXPECT_THAT(Added("X-Custom", "some value"), ElementsAre(Pair("x-custom", "some value")));
  EXPECT_THAT(Added("Authorization", "Bearer x"), ElementsAre(Pair("authorization", "Bearer x")));
  EXPECT_THAT(Added("data-bin", "AP8="), ElementsAre(Pair("data-bin", Bytes({0, 255}))));
  EXPECT_THAT(Added("data-bin", "AP8"), ElementsAre(Pair("data-bin", Bytes({0, 255}))));
  EXPECT_THAT(Added("data-bin", "AQ==, Ag"),
              ElementsAre(Pair("data-bin", "\1"), Pair("data-bin", "\2")));
}

TEST(RequestHeaders, OfHttpAndTheBrowserStayBehind) {
  for (const char* name :
       {"Host", "Content-Type", "Content-Length", "Connection", "TE", "Cookie", "Transfer-Encoding",
        "User-Agent", "X-Grpc-Web", "X-User-Agent", "grpc-timeout", "grpc-encoding", "Accept",
        "Accept-Language", "Sec-Fetch-Mode", "Referer"}) {
    EXPECT_THAT(Added(name, "x"), IsEmpty()) << name;
  }
  // The header is dropped even if its bytes are invalid in metadata.
  EXPECT_THAT(Added("Cookie", "caf\xc3\xa9"), IsEmpty());
}

TEST(RequestHeaders, ThatBreakGrpcsRulesAreRefused) {
  Metadata metadata;
  const auto add = [&](std::string_view name, std::string_view value) {
    return AddRequestHeader(name, value, metadata).code();
  };
  EXPECT_EQ(add("x!y", "x"), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(add("x", "caf\xc3\xa9"), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(add("x", "a\tb"), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(add("x-bin", "not base64!"), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(add("", "x"), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(add(":path", "x"), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(metadata, IsEmpty());
}

// gRPC treats "-bin" alone as a name of text, and aborts the process if its value is not text.
TEST(RequestHeaders, AreBinaryWhereGrpcTakesThemForBinary) {
  EXPECT_THAT(Added("-bin", "gzip"), ElementsAre(Pair("-bin", "gzip")));
  EXPECT_THAT(Added("a-bin", "AP8"), ElementsAre(Pair("a-bin", Bytes({0, 255}))));
}

TEST(ResponseMetadata, IsEncodedAndFiltered) {
  EXPECT_EQ(EncodeValue("x", "plain"), "plain");
  EXPECT_EQ(EncodeValue("x-bin", Bytes({0, 255})), "AP8");
  EXPECT_TRUE(IsForwardedToBrowser("x"));
  EXPECT_TRUE(IsForwardedToBrowser("grpc-status-details-bin"));
  EXPECT_FALSE(IsForwardedToBrowser("grpc-encoding"));
  EXPECT_FALSE(IsForwardedToBrowser("content-length"));
  EXPECT_FALSE(IsForwardedToBrowser("access-control-allow-origin"));
}

}  // namespace
}  // namespace thunderhead::gateway
