// Tests that an exception thrown by a handler ends only its own call, with INTERNAL. The resources
// of the call are released, and the server answers the next call.
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/guarded_service.h"
#include "tests/service/interacting.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using grpc::StatusCode;
using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

constexpr int kMaxStreams = 2;

// Returns limits with few streams and no limit of requests per second, because these tests make
// many calls at once.
access::QuotaLimits FewStreams() {
  return {.max_streams_per_identity = kMaxStreams, .requests_per_second = 0};
}

grpc::Status ListStorms(GuardedService& guarded) {
  v1::ListStormsResponse storms;
  return guarded.Call("presenter", &Stub::ListStorms, v1::ListStormsRequest(), &storms);
}

v1::RenderImageRequest SmallImage() {
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  return request;
}

grpc::Status RenderImage(GuardedService& guarded) {
  v1::RenderImageResponse response;
  return guarded.Call("presenter", &Stub::RenderImage, SmallImage(), &response);
}

grpc::Status RenderImageWithProgress(GuardedService& guarded) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  context.AddMetadata("authorization", "Bearer " + TokenOf("presenter"));
  const auto reader = guarded.stub().RenderImageWithProgress(&context, SmallImage());
  v1::RenderImageEvent event;
  while (reader->Read(&event)) continue;
  return reader->Finish();
}

// A stream of the session's frames, open from its first message until the object is destroyed.
class OpenStream {
 public:
  OpenStream(GuardedService& guarded, const std::string& key) {
    context_.set_deadline(std::chrono::system_clock::now() + kPatience);
    context_.AddMetadata("authorization", "Bearer " + TokenOf("presenter"));
    v1::WatchFramesRequest request;
    request.set_session_id(key);
    reader_ = guarded.stub().WatchFrames(&context_, request);
    v1::WatchFramesResponse first;
    is_open_ = reader_->Read(&first);
  }
  ~OpenStream() {
    if (!is_open_) return;
    context_.TryCancel();
    (void)reader_->Finish();
  }
  OpenStream(const OpenStream&) = delete;
  OpenStream& operator=(const OpenStream&) = delete;

  bool IsOpen() const { return is_open_; }

  // Returns the status code of a stream that did not open.
  StatusCode WhyNot() { return reader_->Finish().error_code(); }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchFramesResponse>> reader_;
  bool is_open_ = false;
};

using FailingCall = grpc::Status (*)(GuardedService&);

class ExceptionsTest : public ::testing::TestWithParam<FailingCall> {};

TEST_P(ExceptionsTest, AreInternalErrorsOfTheirOwnCall) {
  GuardedService guarded(Patient(), FewStreams());
  ASSERT_TRUE(GetParam()(guarded).ok());
  guarded.service().store->throws = true;
  ::testing::internal::CaptureStdout();
  const grpc::Status status = GetParam()(guarded);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr(kThrownByStore));
  EXPECT_EQ(status.error_code(), StatusCode::INTERNAL);
  EXPECT_EQ(status.error_message(), "the server failed at this request; its log says why");
  EXPECT_EQ(ReasonOf(status), "UNEXPECTED_FAILURE");
  guarded.service().store->throws = false;
  EXPECT_TRUE(GetParam()(guarded).ok());
}

// Fails more calls than the caller may have streams at a time, then opens exactly as many streams
// as allowed.
TEST_P(ExceptionsTest, LeaveTheCallersStreamsFree) {
  GuardedService guarded(Patient(), FewStreams());
  const std::string key = guarded.Create().session_id();
  guarded.service().store->throws = true;
  for (int i = 0; i < 3 * kMaxStreams; ++i) {
    EXPECT_EQ(GetParam()(guarded).error_code(), StatusCode::INTERNAL) << i;
  }
  guarded.service().store->throws = false;
  EXPECT_EQ(guarded.service().server().Load().pictures, 0) << "a drain would wait for them";
  std::vector<std::unique_ptr<OpenStream>> streams;
  for (int i = 0; i < kMaxStreams; ++i) {
    streams.push_back(std::make_unique<OpenStream>(guarded, key));
    ASSERT_TRUE(streams.back()->IsOpen()) << i;
  }
  OpenStream another(guarded, key);
  ASSERT_FALSE(another.IsOpen());
  EXPECT_EQ(another.WhyNot(), StatusCode::RESOURCE_EXHAUSTED);
  streams.clear();
  EXPECT_TRUE(WaitFor([&] { return OpenStream(guarded, key).IsOpen(); }));
}

TEST_P(ExceptionsTest, CountAsRequests) {
  ManualTime time;
  GuardedService guarded(Patient(time), {.requests_per_second = 5.0});
  guarded.service().store->throws = true;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(GetParam()(guarded).error_code(), StatusCode::INTERNAL) << i;
  }
  EXPECT_EQ(GetParam()(guarded).error_code(), StatusCode::RESOURCE_EXHAUSTED);
}

INSTANTIATE_TEST_SUITE_P(Calls, ExceptionsTest,
                         ::testing::Values(&ListStorms, &RenderImage, &RenderImageWithProgress));

}  // namespace
}  // namespace thunderhead::testing
