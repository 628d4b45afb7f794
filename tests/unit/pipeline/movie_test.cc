#include "pipeline/movie.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "base/whole_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::pipeline {
namespace {

using ::testing::ElementsAre;

frame::RgbImage Grey(int width_px, int height_px, std::uint8_t value) {
  return {width_px, height_px,
          std::vector<std::uint8_t>(static_cast<std::size_t>(width_px) * height_px * 3, value)};
}

struct Decoded {
  std::vector<int> brightness;  // for each frame, the coded brightness of its first pixel
  AVCodecID codec = AV_CODEC_ID_NONE;
  int pixels = AV_PIX_FMT_NONE;
  int width_px = 0;
  int height_px = 0;
  double seconds = 0.0;
  std::string title;
  std::string comment;
  std::string description;
};

std::string TextOf(const AVFormatContext& format, const char* name) {
  const auto* entry = av_dict_get(format.metadata, name, nullptr, 0);
  return entry == nullptr ? "" : entry->value;
}

// Decodes the file like any player.
Decoded Decode(const std::string& path) {
  Decoded decoded;
  AVFormatContext* format = nullptr;
  if (avformat_open_input(&format, path.c_str(), nullptr, nullptr) < 0) return decoded;
  avformat_find_stream_info(format, nullptr);
  decoded.seconds = static_cast<double>(format->duration) / AV_TIME_BASE;
  decoded.title = TextOf(*format, "title");
  decoded.comment = TextOf(*format, "comment");
  decoded.description = TextOf(*format, "description");
  AVCodecContext* codec = avcodec_alloc_context3(nullptr);
  avcodec_parameters_to_context(codec, format->streams[0]->codecpar);
  decoded.codec = codec->codec_id;
  avcodec_open2(codec, avcodec_find_decoder(codec->codec_id), nullptr);
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  bool more = true;
  while (more) {
    more = av_read_frame(format, packet) >= 0;
    avcodec_send_packet(codec, more ? packet : nullptr);
    while (avcodec_receive_frame(codec, frame) >= 0) {
      decoded.brightness.push_back(frame->data[0][0]);
      decoded.pixels = frame->format;
      decoded.width_px = frame->width;
      decoded.height_px = frame->height;
    }
    av_packet_unref(packet);
  }
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&codec);
  avformat_close_input(&format);
  return decoded;
}

TEST(Movie, EveryFrameLastsTheShortestStepOfTheStorm) {
  const absl::Time t = absl::UnixEpoch();
  const auto at = [t](int minutes) { return t + absl::Minutes(minutes); };
  EXPECT_THAT(FramesOfPictures({at(0), at(10), at(20), at(40)}), ElementsAre(1, 1, 2, 1));
  EXPECT_THAT(FramesOfPictures({at(0)}), ElementsAre(1));
  EXPECT_THAT(FramesOfPictures({at(0), at(1), at(5000)}), ElementsAre(1, 1, 1));
}

class MovieKind : public ::testing::TestWithParam<const char*> {};

TEST_P(MovieKind, PlayersSeeEveryPictureInOrder) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("movie") + GetParam();
  const std::vector<int> values = {0, 128, 255};
  // The description is as long as that of a run of many days, which contains all times.
  const std::string description =
      absl::StrCat(R"({"valid": [")", std::string(20'000, '0'), R"("]})");
  const absl::Status status =
      WriteMovie(path, {1, 2, 1}, 8, {"supercell", "a test", description}, [&](std::size_t i) {
        return absl::StatusOr<frame::RgbImage>(Grey(65, 36, static_cast<std::uint8_t>(values[i])));
      });
  // Debian's libavcodec has encoders for VP9 and H.264. Other builds of libavcodec may lack the
  // H.264 encoder.
  if (path.ends_with(".mp4") && absl::IsFailedPrecondition(status)) GTEST_SKIP() << status;
  ASSERT_TRUE(status.ok()) << status;
  const Decoded movie = Decode(path);
  ASSERT_EQ(movie.brightness.size(), 4U);
  // In video, black is 16 and white 235; compression may be off by a few levels.
  EXPECT_NEAR(movie.brightness[0], 16, 3);
  EXPECT_NEAR(movie.brightness[1], 126, 3);
  EXPECT_NEAR(movie.brightness[2], 126, 3);
  EXPECT_NEAR(movie.brightness[3], 235, 3);
  EXPECT_EQ(movie.codec, path.ends_with(".mp4") ? AV_CODEC_ID_H264 : AV_CODEC_ID_VP9);
  EXPECT_EQ(movie.pixels, AV_PIX_FMT_YUV420P);
  EXPECT_EQ(movie.width_px, 64);
  EXPECT_EQ(movie.height_px, 36);
  EXPECT_NEAR(movie.seconds, 0.5, 0.01);
  EXPECT_EQ(movie.title, "supercell");
  EXPECT_EQ(movie.comment, "a test");
  EXPECT_EQ(movie.description, description);
  EXPECT_FALSE(std::filesystem::exists(base::PartialPath(path)));
}

INSTANTIATE_TEST_SUITE_P(, MovieKind, ::testing::Values(".webm", ".mp4"));

TEST(Movie, WhatFailsLeavesNothing) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("movie.webm");
  const absl::Status sizes = WriteMovie(path, {1, 1}, 8, {}, [](std::size_t i) {
    return absl::StatusOr<frame::RgbImage>(Grey(64, i == 0 ? 36 : 40, 9));
  });
  EXPECT_EQ(sizes.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
  const absl::Status tiny = WriteMovie(
      path, {1}, 8, {}, [](std::size_t) { return absl::StatusOr<frame::RgbImage>(Grey(1, 1, 9)); });
  EXPECT_THAT(std::string(tiny.message()),
              ::testing::StartsWith(path + " cannot be made: the VP9 encoder failed ("));
  EXPECT_THAT(std::string(tiny.message()), ::testing::Not(::testing::HasSubstr("folder")));
  const absl::Status nowhere =
      WriteMovie(folder.File("no/movie.webm"), {1}, 8, {},
                 [](std::size_t) { return absl::StatusOr<frame::RgbImage>(Grey(64, 36, 9)); });
  EXPECT_EQ(nowhere.code(), absl::StatusCode::kFailedPrecondition) << nowhere;
  // A disk without room for more than the first bytes is a temporary error.
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit usual{};
  getrlimit(RLIMIT_FSIZE, &usual);
  const rlimit narrow{100, usual.rlim_max};
  setrlimit(RLIMIT_FSIZE, &narrow);
  const absl::Status full = WriteMovie(path, {1}, 8, {}, [](std::size_t) {
    return absl::StatusOr<frame::RgbImage>(Grey(64, 36, 9));
  });
  setrlimit(RLIMIT_FSIZE, &usual);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(full.code(), absl::StatusCode::kUnavailable) << full;
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
}

// Another user of the folder could otherwise make the program overwrite its owner's files, or wait
// for a reader of a FIFO.
TEST_P(MovieKind, WhatIsPlantedInPlaceOfThePartialFileIsReplaced) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("movie") + GetParam();
  const std::string partial = base::PartialPath(path);
  const std::string victim = folder.File("victim");
  std::ofstream(victim) << "kept";
  const auto write = [&] {
    return WriteMovie(path, {1}, 8, {}, [](std::size_t) {
      return absl::StatusOr<frame::RgbImage>(Grey(64, 36, 128));
    });
  };
  const absl::Status possible = write();
  if (path.ends_with(".mp4") && absl::IsFailedPrecondition(possible)) GTEST_SKIP() << possible;
  ASSERT_TRUE(possible.ok()) << possible;
  const auto expect_movie = [&] {
    std::filesystem::remove(path);
    const absl::Status status = write();
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_EQ(*base::ReadWholeFile(victim), "kept");
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)));
    EXPECT_THAT(Decode(path).brightness,
                ElementsAre(::testing::AllOf(::testing::Ge(123), ::testing::Le(129))));
  };
  std::filesystem::create_symlink(victim, partial);
  expect_movie();
  std::filesystem::create_hard_link(victim, partial);
  expect_movie();
  ASSERT_EQ(mkfifo(partial.c_str(), 0600), 0);
  expect_movie();
}

// Returns the names of an MP4 file's outermost boxes, in order (ISO 14496-12).
std::vector<std::string> BoxesOf(const std::string& file) {
  std::vector<std::string> names;
  for (std::size_t at = 0; at + 8 <= file.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i)
      size = size << 8U | static_cast<unsigned char>(file[at + i]);
    names.push_back(file.substr(at + 4, 4));
    if (size < 8) break;  // open-ended or 64-bit boxes do not occur here
    at += size;
  }
  return names;
}

TEST(Movie, AnMp4BeginsWithItsIndex) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("movie.mp4");
  const absl::Status status = WriteMovie(path, {1, 1}, 8, {"title", "", ""}, [](std::size_t) {
    return absl::StatusOr<frame::RgbImage>(Grey(64, 36, 9));
  });
  if (absl::IsFailedPrecondition(status)) GTEST_SKIP() << status;
  ASSERT_TRUE(status.ok()) << status;
  const std::vector<std::string> boxes = BoxesOf(*base::ReadWholeFile(path));
  const auto index = std::ranges::find(boxes, "moov");
  ASSERT_NE(index, boxes.end());
  EXPECT_NE(std::find(index, boxes.end(), "mdat"), boxes.end()) << "the frames come first";
}

}  // namespace
}  // namespace thunderhead::pipeline
