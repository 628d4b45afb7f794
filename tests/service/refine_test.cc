// Tests of sessions that show the reference, over gRPC. Pictures improve while the scene rests,
// restart when it changes and stop when no viewer watches. Other sessions are not delayed.
#include <grpcpp/create_channel.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Messages = std::vector<v1::WatchFramesResponse>;

v1::Scene Traced() {
  v1::Scene scene = SmallScene();
  scene.mutable_rendering()->mutable_reference();
  return scene;
}

v1::Scene TracedFrom(float azimuth_deg) {
  v1::Scene scene = Traced();
  scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(azimuth_deg);
  return scene;
}

// A fixture whose time stands still, so that only the number of samples decides when frames are
// shown.
class RefineTest : public ::testing::Test {
 protected:
  ~RefineTest() override { reference_->sampling.Open(); }

  service::ServerOptions Options() const {
    service::ServerOptions options = Patient(time_);
    options.render_loop.make_reference_source = FakeReferenceSources(reference_);
    options.render_loop.max_traced_sessions = 2;
    options.address = "127.0.0.1:0";
    return options;
  }

  // Returns the frames of a revision, in order.
  static std::vector<v1::Frame> FramesOf(Watcher& watcher, std::uint64_t revision) {
    std::vector<v1::Frame> frames;
    for (const v1::WatchFramesResponse& message : watcher.Messages()) {
      if (message.has_frame() && message.frame().scene_revision() == revision) {
        frames.push_back(message.frame());
      }
    }
    return frames;
  }

  static bool AwaitSamples(Watcher& watcher, std::uint64_t revision, std::uint32_t samples) {
    return watcher.Await([=](const Messages& messages) {
      return std::any_of(messages.begin(), messages.end(), [=](const auto& message) {
        return message.has_frame() && message.frame().scene_revision() == revision &&
               message.frame().refinement().samples_per_pixel() >= samples;
      });
    });
  }

  // Lets the reference trace `more` samples, and waits until a frame with `samples` samples per
  // pixel is shown.
  bool TraceOn(Watcher& watcher, std::uint64_t revision, int more, std::uint32_t samples) {
    reference_->sampling.LetPass(more);
    return AwaitSamples(watcher, revision, samples);
  }

  const std::shared_ptr<FakeReference> reference_ = std::make_shared<FakeReference>();
  const ManualTime time_{};
  FakeService service_{Options()};
};

TEST_F(RefineTest, SamplesGrowAndTheErrorFallsWhileTheSceneRests) {
  // A picture is shown at each doubling of its samples, before further samples are traced.
  reference_->sampling.Close();
  Watcher watcher(service_.stub(), service_.Open(Traced()));
  ASSERT_TRUE(TraceOn(watcher, 1, 1, 1));
  for (int samples = 2; samples <= 64; samples *= 2) {
    ASSERT_TRUE(TraceOn(watcher, 1, samples / 2, static_cast<std::uint32_t>(samples)));
  }
  const std::vector<v1::Frame> frames = FramesOf(watcher, 1);
  ASSERT_EQ(frames.size(), 7U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const v1::Refinement& refinement = frames[i].refinement();
    EXPECT_TRUE(frames[i].refined());
    EXPECT_EQ(frames[i].modelled().technique(), "reference");
    EXPECT_EQ(frames[i].modelled().fields_size(), 1);
    ASSERT_EQ(frames[i].modelled().not_shown_size(), 1);
    EXPECT_EQ(frames[i].modelled().not_shown(0).code(), v1::NotShown::CODE_DETAIL);
    EXPECT_EQ(frames[i].stages(0).stage(), v1::STAGE_TRACE);
    EXPECT_EQ(refinement.has_relative_error(), refinement.samples_per_pixel() > 1);
    if (i == 0) continue;
    EXPECT_GT(refinement.samples_per_pixel(), frames[i - 1].refinement().samples_per_pixel());
    if (i == 1) continue;
    EXPECT_LT(refinement.relative_error(), frames[i - 1].refinement().relative_error());
  }
  // The frame source has drawn nothing.
  EXPECT_TRUE(service_.machine->Log().empty());
}

TEST_F(RefineTest, LargePicturesBeginSmall) {
  v1::Scene scene = Traced();
  scene.mutable_output()->set_width_px(320);
  scene.mutable_output()->set_height_px(180);
  reference_->sampling.Close();
  Watcher watcher(service_.stub(), service_.Open(scene));
  ASSERT_TRUE(TraceOn(watcher, 1, 1, 1));
  reference_->sampling.Open();
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  const std::vector<v1::Frame> frames = FramesOf(watcher, 1);
  EXPECT_FALSE(frames.front().refined());
  EXPECT_EQ(frames.front().width_px(), 80U);
  EXPECT_EQ(watcher.NewestFrame().width_px(), 320U);
  EXPECT_EQ(reference_->sources, 1);
}

TEST_F(RefineTest, AChangeBeginsAgainAtOnce) {
  const std::string id = service_.Open(TracedFrom(0.0F));
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitSamples(watcher, 1, 16));
  reference_->sampling.Close();
  ASSERT_TRUE(reference_->sampling.AwaitWaiting(1));
  const std::uint64_t revision = service_.Update(id, TracedFrom(40.0F));
  // The first picture ends at its next sample. It would need many more samples to be shown again.
  reference_->sampling.LetOnePass();
  ASSERT_TRUE(WaitFor([&] { return reference_->Log().size() == 2U; }));
  ASSERT_TRUE(TraceOn(watcher, revision, 1, 1));
  reference_->sampling.Open();
  ASSERT_TRUE(AwaitSamples(watcher, revision, 4));
  const std::vector<v1::Frame> frames = FramesOf(watcher, revision);
  EXPECT_EQ(frames.front().refinement().samples_per_pixel(), 1U);
  EXPECT_EQ(frames.front().camera().orbit().azimuth_deg(), 40.0F);
  // The second picture reuses the source of the first.
  EXPECT_EQ(reference_->sources, 1);
  EXPECT_EQ(reference_->Log().size(), 2U);
}

TEST_F(RefineTest, AnotherExposureShowsWhatIsThereAndGoesOn) {
  v1::Scene scene = Traced();
  const std::string id = service_.Open(scene);
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitSamples(watcher, 1, 32));
  scene.mutable_display()->set_exposure_ev(1.0F);
  const std::uint64_t revision = service_.Update(id, scene);
  ASSERT_TRUE(AwaitSamples(watcher, revision, 64));
  const v1::Frame first = FramesOf(watcher, revision).front();
  EXPECT_GE(first.refinement().samples_per_pixel(), 32U);
  const auto image = frame::DecodeJpeg(first.jpeg());
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_NEAR(image->rgb[0], 127, 4);
  EXPECT_EQ(reference_->Log().size(), 1U);
}

TEST_F(RefineTest, LeavingEndsItAndComingBackBeginsAnew) {
  const std::string id = service_.Open(Traced());
  {
    Watcher watcher(service_.stub(), id);
    ASSERT_TRUE(AwaitSamples(watcher, 1, 8));
    EXPECT_EQ(reference_->sources, 1);
  }
  ASSERT_TRUE(WaitFor([&] { return reference_->sources == 0; }));
  const int samples = reference_->samples;
  // The first frame may still be the last frame of the previous scene.
  Watcher again(service_.stub(), id);
  EXPECT_TRUE(WaitFor([&] { return reference_->Log().size() == 2U; }));
  EXPECT_EQ(reference_->Log().back().samples_before, samples) << "traced while nobody watched";
  EXPECT_TRUE(AwaitSamples(again, 1, 8));
}

TEST_F(RefineTest, AnotherRendererEndsIt) {
  const std::string id = service_.Open(Traced());
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitSamples(watcher, 1, 8));
  const std::uint64_t revision = service_.Update(id, SmallScene());
  ASSERT_TRUE(watcher.AwaitFrame(revision, true));
  EXPECT_FALSE(watcher.NewestFrame().has_refinement());
  EXPECT_TRUE(WaitFor([&] { return reference_->sources == 0; }));
  const std::uint64_t back = service_.Update(id, Traced());
  EXPECT_TRUE(AwaitSamples(watcher, back, 8));
}

TEST_F(RefineTest, AnotherTimeIsReadAndTraced) {
  const std::string id = service_.Open(Traced());
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(AwaitSamples(watcher, 1, 8));
  v1::Scene scene = Traced();
  scene.set_time_index(2);
  // The camera is complete, so only the render loop reads the storm.
  scene.mutable_camera()->mutable_orbit()->mutable_target();
  scene.mutable_camera()->mutable_orbit()->set_elevation_deg(4.0F);
  scene.mutable_camera()->mutable_orbit()->set_distance_m(50000.0F);
  const std::uint64_t revision = service_.Update(id, scene);
  ASSERT_TRUE(AwaitSamples(watcher, revision, 8));
  EXPECT_EQ(reference_->Log().back().scene.time_index, 2);
}

TEST_F(RefineTest, OtherSessionsAreDrawnMeanwhile) {
  Watcher traced(service_.stub(), service_.Open(Traced()));
  ASSERT_TRUE(AwaitSamples(traced, 1, 2));
  reference_->sampling.Close();
  ASSERT_TRUE(reference_->sampling.AwaitWaiting(1));
  const std::string id = service_.Open(SmallScene());
  Watcher other(service_.stub(), id);
  // Each frame would wait for the sample if pictures were traced on the render loop's thread.
  for (int i = 0; i < 10; ++i) {
    v1::Scene scene = SmallScene();
    scene.mutable_sun()->set_azimuth_deg(static_cast<float>(10 * i));
    ASSERT_TRUE(other.AwaitFrame(service_.Update(id, scene), false));
  }
  reference_->sampling.Open();
  EXPECT_TRUE(AwaitSamples(traced, 1, 16));
}

TEST_F(RefineTest, SessionsTakeTurnsAndOneTooManyIsTold) {
  Watcher one(service_.stub(), service_.Open(TracedFrom(0.0F)));
  Watcher two(service_.stub(), service_.Open(TracedFrom(90.0F)));
  ASSERT_TRUE(AwaitSamples(one, 1, 16));
  ASSERT_TRUE(AwaitSamples(two, 1, 16));
  Watcher three(service_.stub(), service_.Open(TracedFrom(180.0F)));
  ASSERT_TRUE(three.Await([](const Messages& messages) { return !messages.empty(); }));
  EXPECT_THAT(three.Messages().front().problem().message(), HasSubstr("choose another technique"));
}

TEST_F(RefineTest, OneIdentityHasHalfOfThePlaces) {
  // All calls through the server's port come from the same address.
  const auto stub = v1::ThunderheadService::NewStub(grpc::CreateChannel(
      absl::StrCat("127.0.0.1:", service_.server().Port()), grpc::InsecureChannelCredentials()));
  const auto open = [&](float azimuth_deg) {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = TracedFrom(azimuth_deg);
    v1::CreateSessionResponse response;
    EXPECT_TRUE(Call(*stub, &v1::ThunderheadService::Stub::CreateSession, request, &response).ok());
    return response.session_id();
  };
  Watcher first(*stub, open(10.0F));
  ASSERT_TRUE(AwaitSamples(first, 1, 64));
  Watcher second(*stub, open(20.0F));
  EXPECT_TRUE(second.Await([](const Messages& messages) {
    return std::ranges::any_of(messages, [](const auto& message) {
      return message.problem().message().find("pictures for you") != std::string::npos;
    });
  }));
  Watcher others(service_.stub(), service_.Open(TracedFrom(30.0F)));
  EXPECT_TRUE(AwaitSamples(others, 1, 64));
}

TEST_F(RefineTest, WhatCannotBeTracedIsAProblemUntilTheSceneChanges) {
  reference_->fails_above_exposure_ev = 5.0;
  v1::Scene scene = Traced();
  scene.mutable_display()->set_exposure_ev(6.0F);
  const std::string id = service_.Open(scene);
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(watcher.Await([](const Messages& messages) { return !messages.empty(); }));
  EXPECT_THAT(watcher.Messages().front().problem().message(), HasSubstr("this exposure"));
  // The render loop checks the session again when another session is drawn.
  Watcher other(service_.stub(), service_.Open(SmallScene()));
  ASSERT_TRUE(other.AwaitFrame(1, true));
  EXPECT_EQ(reference_->Log().size(), 1U);
  EXPECT_TRUE(AwaitSamples(watcher, service_.Update(id, Traced()), 4));
}

TEST_F(RefineTest, RenderImageSaysThatItIsForSessions) {
  v1::RenderImageRequest request;
  *request.mutable_scene() = Traced();
  v1::RenderImageResponse response;
  const grpc::Status status =
      Call(service_.stub(), &v1::ThunderheadService::Stub::RenderImage, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("--technique reference"));
}

TEST_F(RefineTest, StopsAmidWork) {
  reference_->ms_per_sample = 50.0;
  Watcher watcher(service_.stub(), service_.Open(Traced()));
  ASSERT_TRUE(AwaitSamples(watcher, 1, 1));
  service_.server().Shutdown();
  EXPECT_EQ(watcher.End().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(reference_->sources, 0);
}

// Runs the real path tracer instead of the fake reference.
TEST(RefineByReferenceTest, SamplesGrowErrorFallsChangeRestartsLeavingCancels) {
  FakeService service;
  // The fake storm's cell is opaque, so its paths are long.
  const auto from = [](float azimuth_deg) {
    v1::Scene scene = TracedFrom(azimuth_deg);
    scene.mutable_output()->set_width_px(16);
    scene.mutable_output()->set_height_px(9);
    return scene;
  };
  const std::string id = service.Open(from(0.0F));
  const auto samples_of = [](const v1::WatchFramesResponse& message) {
    return message.frame().refinement().samples_per_pixel();
  };
  const auto reached = [&](std::uint64_t revision, std::uint32_t samples) {
    return [=](const Messages& messages) {
      return std::any_of(messages.begin(), messages.end(), [=](const auto& message) {
        return message.frame().scene_revision() == revision && samples_of(message) >= samples;
      });
    };
  };
  Watcher watcher(service.stub(), id);
  // Waits for 32 times the samples of the first frame that has an error. Some frames may be
  // skipped.
  ASSERT_TRUE(watcher.Await([&](const Messages& messages) {
    const auto first = std::ranges::find_if(messages, [](const auto& message) {
      return message.frame().refinement().has_relative_error();
    });
    return first != messages.end() && samples_of(messages.back()) >= 32 * samples_of(*first);
  }));
  const std::uint32_t reached_before = watcher.NewestFrame().refinement().samples_per_pixel();
  double first_error = 0.0;
  double last_error = 0.0;
  for (const v1::WatchFramesResponse& message : watcher.Messages()) {
    if (!message.frame().refinement().has_relative_error()) continue;
    last_error = message.frame().refinement().relative_error();
    if (first_error == 0.0) first_error = last_error;
  }
  EXPECT_GT(first_error, 0.0);
  // The error falls by the square root of 32. An estimate from two samples is itself uncertain.
  EXPECT_LT(last_error, first_error / 2.0);
  EXPECT_GT(last_error, first_error / 16.0);
  const std::uint64_t revision = service.Update(id, from(120.0F));
  ASSERT_TRUE(watcher.Await(reached(revision, 8)));
  const auto messages = watcher.Messages();
  const auto restarted = std::find_if(messages.begin(), messages.end(), [&](const auto& message) {
    return message.frame().scene_revision() == revision;
  });
  EXPECT_LT(samples_of(*restarted), reached_before);
  const v1::Frame newest = watcher.NewestFrame();
  const auto image = frame::DecodeJpeg(newest.jpeg());
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->width_px, 16);
  const auto [low, high] = std::minmax_element(image->rgb.begin(), image->rgb.end());
  EXPECT_GT(*high - *low, 5);
  watcher.Cancel();
  EXPECT_EQ(watcher.End().error_code(), grpc::StatusCode::CANCELLED);
}

}  // namespace
}  // namespace thunderhead::testing
