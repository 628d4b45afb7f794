// Tests that the load generator parses the server's messages, as the server writes them.
#include <string>

#include "gmock/gmock.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "gtest/gtest.h"
#include "load/response_reader.h"
#include "load/web_wire.h"
#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::load {
namespace {

using ::testing::HasSubstr;

// Reads in blocks of 16 bytes, because gRPC's slices may divide a message anywhere.
std::optional<Response> Read(const std::string& bytes) {
  google::protobuf::io::ArrayInputStream stream(bytes.data(), static_cast<int>(bytes.size()), 16);
  return ReadResponse(stream);
}

v1::InteractResponse FrameResponse() {
  v1::InteractResponse response;
  v1::Frame& frame = *response.mutable_frame();
  frame.set_sequence(70000);
  frame.set_scene_revision(300);
  frame.set_jpeg(std::string(1000, '\x0A'));
  frame.mutable_camera()->mutable_orbit()->set_azimuth_deg(12.0F);
  frame.add_stages()->set_milliseconds(3.0F);
  frame.set_refined(true);
  return response;
}

// Reads a response that contains this serialized frame.
std::optional<Response> ReadFrame(const std::string& frame) {
  EXPECT_LT(frame.size(), 1U << 14);
  std::string bytes = "\x12";
  bytes.push_back(static_cast<char>((frame.size() & 0x7F) | 0x80));
  bytes.push_back(static_cast<char>(frame.size() >> 7));
  return Read(bytes + frame);
}

TEST(ReadResponse, ReadsSequenceAndRevisionOfAFrame) {
  const auto response = Read(FrameResponse().SerializeAsString());
  ASSERT_TRUE(response.has_value());
  EXPECT_EQ(response->part, Response::Part::kFrame);
  EXPECT_EQ(response->sequence, 70000);
  EXPECT_EQ(response->scene_revision, 300);
}

TEST(ReadResponse, ReadsWhoseViewAFrameIsWhereServersWriteIt) {
  EXPECT_FALSE(Read(FrameResponse().SerializeAsString())->own_view);
  v1::Frame view;
  view.set_own_view(true);
  const std::string frame = view.SerializeAsString() + FrameResponse().frame().SerializeAsString();
  const auto read = ReadFrame(frame);
  ASSERT_TRUE(read.has_value());
  EXPECT_TRUE(read->own_view);
  EXPECT_EQ(read->sequence, 70000);
  EXPECT_EQ(read->scene_revision, 300);
}

TEST(ReadResponse, FindsASequenceBehindThePicture) {
  v1::InteractResponse response = FrameResponse();
  response.mutable_frame()->clear_sequence();
  v1::Frame sequence;
  sequence.set_sequence(5);
  const std::string frame = response.frame().SerializeAsString() + sequence.SerializeAsString();
  const auto read = ReadFrame(frame);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->sequence, 5);
  EXPECT_EQ(read->scene_revision, 300);
}

TEST(ReadResponse, ReadsTheAnswersToUpdates) {
  v1::InteractResponse taken;
  taken.mutable_scene_taken()->set_request_id(7);
  taken.mutable_scene_taken()->set_scene_revision(9);
  const auto read_taken = Read(taken.SerializeAsString());
  ASSERT_TRUE(read_taken.has_value());
  EXPECT_EQ(read_taken->part, Response::Part::kSceneTaken);
  EXPECT_EQ(read_taken->request_id, 7);
  EXPECT_EQ(read_taken->scene_revision, 9);

  v1::InteractResponse refused;
  refused.mutable_refused()->set_request_id(8);
  refused.mutable_refused()->mutable_status()->set_message("another steers");
  const auto read_refused = Read(refused.SerializeAsString());
  ASSERT_TRUE(read_refused.has_value());
  EXPECT_EQ(read_refused->part, Response::Part::kRefused);
  EXPECT_EQ(read_refused->request_id, 8);
  EXPECT_EQ(read_refused->refusal, "another steers");
}

TEST(ReadResponse, PassesOverOtherParts) {
  v1::InteractResponse response;
  response.mutable_presence()->add_people()->set_name("Ada");
  const auto read = Read(response.SerializeAsString());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->part, Response::Part::kOther);
}

TEST(ReadResponse, RefusesEveryTruncatedFrame) {
  const std::string bytes = FrameResponse().SerializeAsString();
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    EXPECT_FALSE(Read(bytes.substr(0, size)).has_value()) << size;
  }
}

TEST(WebWire, ReadsTheStatusOfTrailers) {
  EXPECT_TRUE(StatusOfTrailers("grpc-status:0\r\n").ok());
  const absl::Status status =
      StatusOfTrailers("grpc-status:14\r\ngrpc-message:50%25 of it %e2%82%ac\r\nother:1\r\n");
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(status.message(), "50% of it \xe2\x82\xac");
  EXPECT_EQ(StatusOfTrailers("hello").code(), absl::StatusCode::kInternal);
}

TEST(WebWire, ReadsTheMessageOfAUnaryCall) {
  const std::string message("\0\0\0\0\3abc", 8);
  const std::string trailers("\x80\0\0\0\xfgrpc-status:0\r\n", 20);
  const auto read = UnaryMessage(message + trailers);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(*read, "abc");
  const std::string refused("\x80\0\0\0\xfgrpc-status:8\r\n", 20);
  EXPECT_EQ(UnaryMessage(refused).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_FALSE(UnaryMessage(message).ok());
  EXPECT_FALSE(UnaryMessage(message.substr(0, 7)).ok());
  EXPECT_THAT(std::string(UnaryMessage("<html>").status().message()), HasSubstr("HTTP port"));
}

}  // namespace
}  // namespace thunderhead::load
