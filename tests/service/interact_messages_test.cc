// Tests that messages share their largest part: all viewers get the same bytes instead of a copy
// each.
#include "service/interact/interact_messages.h"

#include <grpcpp/support/proto_buffer_reader.h>

#include <memory>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "service/engine/frame_messages.h"

namespace thunderhead::service {
namespace {

// Parses the message as a client does.
v1::InteractResponse Parsed(grpc::ByteBuffer message) {
  grpc::ProtoBufferReader reader(&message);
  v1::InteractResponse response;
  EXPECT_TRUE(response.ParseFromZeroCopyStream(&reader));
  return response;
}

// Returns where the message's largest part lies in memory.
const void* LargestPartOf(const grpc::ByteBuffer& message) {
  std::vector<grpc::Slice> slices;
  EXPECT_TRUE(message.Dump(&slices).ok());
  EXPECT_FALSE(slices.empty());
  return slices.empty() ? nullptr : slices.back().begin();
}

TEST(InteractMessagesTest, FramesOfAllViewersAreTheSameBytes) {
  auto frame = std::make_shared<delivery::EncodedFrame>();
  frame->jpeg.assign(50'000, 'x');
  frame->width_px = 640;
  frame->serialized = SerializedFrame(*frame);
  frame->sequence = 7;  // the hub sets it later
  for (int viewer = 0; viewer < 3; ++viewer) {
    const grpc::ByteBuffer message = FrameResponse(frame, /*own_view=*/false);
    EXPECT_EQ(LargestPartOf(message), frame->serialized.data());
    EXPECT_LT(message.Length() - frame->serialized.size(), 20U);
    const v1::Frame parsed = Parsed(message).frame();
    EXPECT_EQ(parsed.sequence(), 7U);
    EXPECT_EQ(parsed.width_px(), 640U);
    EXPECT_EQ(parsed.jpeg(), frame->jpeg);
  }
  EXPECT_TRUE(Parsed(FrameResponse(frame, /*own_view=*/true)).frame().own_view());
}

// Errors name files, and a file's name may have any bytes.
TEST(InteractMessagesTest, ErrorsArePrintable) {
  const std::string hostile = "/data/M\xfcnchen\u200f.nc: damaged";
  v1::Problem problem;
  ToMessage(delivery::Problem{.message = hostile}, problem);
  EXPECT_EQ(problem.message(), "/data/M?nchen?.nc: damaged");
  EXPECT_EQ(EndResponse(absl::DataLossError(hostile)).end().message(),
            "/data/M?nchen?.nc: damaged");
}

TEST(InteractMessagesTest, ScenesOfAllViewersAreTheSameBytes) {
  v1::Scene scene;
  scene.set_storm_id(std::string(5000, 's'));
  session::NewestScene newest;
  newest.revision = 3;
  newest.serialized = std::make_shared<const std::string>(scene.SerializeAsString());
  for (int viewer = 0; viewer < 3; ++viewer) {
    const grpc::ByteBuffer message = SceneResponse(newest);
    EXPECT_EQ(LargestPartOf(message), newest.serialized->data());
    EXPECT_EQ(Parsed(message).scene().scene_revision(), 3U);
    EXPECT_EQ(Parsed(message).scene().scene().storm_id(), scene.storm_id());
  }
}

}  // namespace
}  // namespace thunderhead::service
