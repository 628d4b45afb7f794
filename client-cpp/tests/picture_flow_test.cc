// Tests of PictureFlow, which decodes frames in parallel with the drawing thread. The newest frame
// is shown. Video frames that are not shown are still decoded, so later video frames stay
// decodable.
#include "thunderhead_client/picture_flow.h"

#include <turbojpeg.h>
#include <vpx/vp8cx.h>
#include <vpx/vpx_encoder.h>

#include <atomic>
#include <cstring>
#include <mutex>

#include "gtest/gtest.h"
#include "tests/support/wait_for.h"

namespace thunderhead::client {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
using thunderhead::testing::WaitFor;

// Returns a JPEG with the same grey level (0 to 255) at every pixel.
std::string JpegOf(std::uint8_t level, int width = kWidth, int height = kHeight) {
  const std::vector<std::uint8_t> rgb(
      3U * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), level);
  tjhandle encoder = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  tjCompress2(encoder, rgb.data(), width, 0, height, TJPF_RGB, &bytes, &size, TJSAMP_420, 95, 0);
  std::string jpeg(reinterpret_cast<const char*>(bytes), size);
  tjFree(bytes);
  tjDestroy(encoder);
  return jpeg;
}

v1::Frame JpegFrame(std::uint64_t sequence, std::uint8_t level) {
  v1::Frame frame;
  frame.set_sequence(sequence);
  frame.set_jpeg(JpegOf(level));
  return frame;
}

// Encodes grey images as video.
class Encoder {
 public:
  Encoder() {
    vpx_codec_enc_cfg_t config;
    vpx_codec_enc_config_default(vpx_codec_vp9_cx(), &config, 0);
    config.g_w = kWidth;
    config.g_h = kHeight;
    config.g_lag_in_frames = 0;
    vpx_codec_enc_init(&codec_, vpx_codec_vp9_cx(), &config, 0);
    vpx_img_alloc(&image_, VPX_IMG_FMT_I420, kWidth, kHeight, 32);
  }
  ~Encoder() {
    vpx_img_free(&image_);
    vpx_codec_destroy(&codec_);
  }
  v1::Frame Next(std::uint8_t level) {
    std::memset(image_.planes[0], level, static_cast<std::size_t>(image_.stride[0]) * kHeight);
    for (const int plane : {1, 2}) {
      std::memset(image_.planes[plane], 128,
                  static_cast<std::size_t>(image_.stride[plane]) * kHeight / 2);
    }
    vpx_codec_encode(&codec_, &image_, count_, 1, 0, VPX_DL_REALTIME);
    v1::Frame frame;
    frame.set_sequence(static_cast<std::uint64_t>(++count_));
    vpx_codec_iter_t next = nullptr;
    while (const auto* packet = vpx_codec_get_cx_data(&codec_, &next)) {
      frame.set_vp9(packet->data.frame.buf, packet->data.frame.sz);
      frame.set_key_frame((packet->data.frame.flags & VPX_FRAME_IS_KEY) != 0);
    }
    return frame;
  }

 private:
  vpx_codec_ctx_t codec_{};
  vpx_image_t image_{};
  vpx_codec_pts_t count_ = 0;
};

class PictureFlowTest : public ::testing::Test {
 protected:
  // Waits for a picture whose sequence number is at least `sequence`. Drops earlier pictures.
  std::unique_ptr<Picture> Await(std::uint64_t sequence) {
    std::unique_ptr<Picture> picture;
    const bool came = WaitFor([&] {
      picture = flow.Take();
      return picture != nullptr && picture->frame.sequence() >= sequence;
    });
    return came ? std::move(picture) : nullptr;
  }
  bool AwaitFailure() {
    return WaitFor([&] { return failures > 0 || lost > 0; });
  }

  std::atomic<int> readies{0};
  std::atomic<int> lost{0};
  std::atomic<int> failures{0};
  std::mutex decoding;  // while the test holds this mutex, the decoding thread stops after the
                        // picture that it has just finished
  PictureFlow flow{{[this] {
                      ++readies;
                      const std::lock_guard waits(decoding);
                    },
                    [this](const v1::Frame&) { ++lost; },
                    [this](const std::string&) { ++failures; }}};
};

TEST_F(PictureFlowTest, ADecodedPictureHasItsColoursAndNoBytes) {
  flow.Offer(JpegFrame(1, 200), 1234);
  const auto picture = Await(1);
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->pixels.width_px, kWidth);
  EXPECT_EQ(picture->pixels.height_px, kHeight);
  EXPECT_NEAR(picture->pixels.rgbx.at(0), 200, 2);
  EXPECT_EQ(picture->bytes, 1234U);
  EXPECT_EQ(picture->encoding, "JPEG");
  EXPECT_TRUE(picture->frame.jpeg().empty());
}

TEST_F(PictureFlowTest, TheNewestOfManyIsShownAndTheOthersAreCounted) {
  constexpr std::uint64_t kCount = 200;
  for (std::uint64_t i = 1; i <= kCount; ++i)
    flow.Offer(JpegFrame(i, static_cast<std::uint8_t>(i)), 1);
  // The test takes no picture meanwhile, so all but the newest are dropped before or after they are
  // decoded.
  ASSERT_TRUE(WaitFor([&] { return flow.dropped() == kCount - 1 && readies > 0; }));
  const auto picture = flow.Take();
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->frame.sequence(), kCount);
  EXPECT_EQ(flow.dropped(), kCount - 1);
}

TEST_F(PictureFlowTest, VideoIsDecodedInOrderHoweverFewArePainted) {
  // The frames are offered together while the decoder is busy, so that they wait in the queue.
  Encoder encoder;
  constexpr int kFrames = 20;
  std::vector<v1::Frame> frames;
  frames.reserve(kFrames);
  for (int i = 0; i < kFrames; ++i) {
    frames.push_back(encoder.Next(static_cast<std::uint8_t>(60 + 5 * i)));
  }
  {
    const std::lock_guard busy(decoding);
    flow.Offer(JpegFrame(0, 90), 1);
    ASSERT_TRUE(WaitFor([&] { return readies > 0; }));
    for (v1::Frame& frame : frames) flow.Offer(std::move(frame), 1);
  }
  const auto picture = Await(20);
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->encoding, "VP9");
  EXPECT_NEAR(picture->pixels.rgbx.at(0), 155, 6);
  EXPECT_EQ(lost, 0);
}

TEST_F(PictureFlowTest, VideoWithoutItsKeyFrameIsLost) {
  Encoder encoder;
  encoder.Next(60);
  flow.Offer(encoder.Next(70), 1);
  ASSERT_TRUE(AwaitFailure());
  EXPECT_EQ(lost, 1);
  EXPECT_EQ(failures, 0);
}

TEST_F(PictureFlowTest, ABrokenPictureFailsAndTheNextIsShown) {
  v1::Frame broken;
  broken.set_sequence(1);
  broken.set_jpeg("no JPEG at all");
  flow.Offer(broken, 1);
  ASSERT_TRUE(AwaitFailure());
  EXPECT_EQ(failures, 1);
  flow.Offer(JpegFrame(2, 90), 1);
  EXPECT_NE(Await(2), nullptr);
}

TEST_F(PictureFlowTest, WhatWaitsOfAnOldCallIsDropped) {
  flow.Offer(JpegFrame(9, 90), 1);
  ASSERT_TRUE(WaitFor([&] { return readies > 0; }));
  flow.StartStream();
  EXPECT_EQ(flow.Take(), nullptr);
}

}  // namespace
}  // namespace thunderhead::client
