#include "pipeline/movie.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libswscale/swscale.h>
}

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "base/status.h"
#include "base/whole_file.h"

namespace thunderhead::pipeline {
namespace {

constexpr int kLongestGap = 1000;

// The error numbers of libavcodec itself consist of four letters and are above this value. The
// system's error numbers are below it.
constexpr int kErrnos = 4096;

// A kind of movie, identified by the file extension.
struct Kind {
  const char* ending;
  const char* container;
  AVCodecID codec;
  const char* codec_name;
  // Settings of the encoder: a constant quality at which clouds show no loss. libvpx counts quality
  // from 0 to 63 and libx264 from 0 to 51; lower is better.
  std::vector<std::pair<const char*, const char*>> encoder;
  std::vector<std::pair<const char*, const char*>> muxer;
};

const std::vector<Kind>& Kinds() {
  static const std::vector<Kind> kinds = {
      {".webm",
       "webm",
       AV_CODEC_ID_VP9,
       "VP9",
       {{"crf", "24"}, {"deadline", "good"}, {"cpu-used", "2"}, {"row-mt", "1"}},
       {}},
      // With faststart, the index precedes the frames, which streaming players need.
      {".mp4", "mp4", AV_CODEC_ID_H264, "H.264", {{"crf", "20"}}, {{"movflags", "+faststart"}}}};
  return kinds;
}

const Kind* KindOf(std::string_view path) {
  for (const Kind& kind : Kinds()) {
    if (path.ends_with(kind.ending)) return &kind;
  }
  return nullptr;
}

class Settings {
 public:
  explicit Settings(const std::vector<std::pair<const char*, const char*>>& values) {
    for (const auto& [name, value] : values) av_dict_set(&dictionary_, name, value, 0);
  }
  ~Settings() { av_dict_free(&dictionary_); }
  Settings(const Settings&) = delete;
  Settings& operator=(const Settings&) = delete;

  AVDictionary** Address() { return &dictionary_; }

 private:
  AVDictionary* dictionary_ = nullptr;
};

struct ContextDeleter {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct FormatDeleter {
  void operator()(AVFormatContext* context) const {
    if (context->pb != nullptr) avio_closep(&context->pb);
    avformat_free_context(context);
  }
};
struct FrameDeleter {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct PacketDeleter {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct ScalerDeleter {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

std::string Reason(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  return text.data();
}

absl::Status Failed(const std::string& path, const std::string& what, int code) {
  const std::string message =
      absl::StrCat(path, " cannot be written: ", what, " (", Reason(code),
                   "); check that its folder exists, may be written to and has room");
  // Errors other than the system's are caused by the pictures, such as a size that the encoder does
  // not support.
  if (AVUNERROR(code) >= kErrnos) return absl::InvalidArgumentError(message);
  return base::WriteProblem(message, AVUNERROR(code));
}

// Returns the error of libavcodec or libavutil, which has nothing to do with the file.
absl::Status NotMade(const std::string& path, const std::string& what, int code) {
  const std::string message =
      absl::StrCat(path, " cannot be made: ", what, " failed (", Reason(code), ")");
  if (AVUNERROR(code) >= kErrnos) return absl::InvalidArgumentError(message);
  return base::WriteProblem(message, AVUNERROR(code));
}

// Makes an empty partial file. Another user of the folder may have put a link or a FIFO in its
// place, which is removed and never opened. On failure, returns a descriptor that is not open, and
// sets errno.
base::FileDescriptor NewPartial(const std::string& path) {
  const std::string partial = base::PartialPath(path);
  unlink(partial.c_str());
  return base::FileDescriptor(
      open(partial.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
}

// Writes one movie to the partial file.
class MovieWriter {
 public:
  explicit MovieWriter(std::string path) : path_(std::move(path)) {}

  absl::Status Open(int width_px, int height_px, int frames_per_second, const MovieText& text) {
    const Kind& kind = *KindOf(path_);
    const AVCodec* codec = avcodec_find_encoder(kind.codec);
    if (codec == nullptr) {
      return absl::FailedPreconditionError(
          absl::StrCat(path_, " cannot be made: libavcodec has no encoder of ", kind.codec_name,
                       " here; name a movie of the other kind (.webm or .mp4)"));
    }
    partial_ = NewPartial(path_);
    if (!partial_.IsOpen()) return Failed(path_, "its partial file", AVERROR(errno));
    // libavformat opens the file again, some containers twice. This name leads to the open file,
    // whatever has been put at its path since.
    const std::string name = absl::StrCat("/proc/self/fd/", partial_.Get());
    AVFormatContext* format = nullptr;
    if (const int code =
            avformat_alloc_output_context2(&format, nullptr, kind.container, name.c_str());
        code < 0) {
      return Failed(path_, "no such container", code);
    }
    format_.reset(format);
    codec_.reset(avcodec_alloc_context3(codec));
    // The chroma planes have half the size, so an odd last row or column of the picture is left
    // out.
    codec_->width = width_px & ~1;
    codec_->height = height_px & ~1;
    codec_->time_base = {1, frames_per_second};
    codec_->framerate = {frames_per_second, 1};
    codec_->pix_fmt = AV_PIX_FMT_YUV420P;
    codec_->color_range = AVCOL_RANGE_MPEG;
    codec_->colorspace = AVCOL_SPC_BT709;
    codec_->color_primaries = AVCOL_PRI_BT709;
    codec_->color_trc = AVCOL_TRC_IEC61966_2_1;
    codec_->bit_rate = 0;  // 0, because the quality setting determines the bit rate
    if ((format->oformat->flags & AVFMT_GLOBALHEADER) != 0) {
      codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    }
    Settings encoder(kind.encoder);
    int code = avcodec_open2(codec_.get(), codec, encoder.Address());
    if (code < 0) return EncoderFailed(code);
    stream_ = avformat_new_stream(format, nullptr);
    if (stream_ == nullptr) return NotMade(path_, "the allocation of a stream", AVERROR(ENOMEM));
    stream_->time_base = codec_->time_base;
    stream_->avg_frame_rate = codec_->framerate;
    avcodec_parameters_from_context(stream_->codecpar, codec_.get());
    av_dict_set(&format->metadata, "title", text.title.c_str(), 0);
    av_dict_set(&format->metadata, "comment", text.comment.c_str(), 0);
    av_dict_set(&format->metadata, "description", text.description.c_str(), 0);
    code = avio_open(&format->pb, name.c_str(), AVIO_FLAG_WRITE);
    Settings muxer(kind.muxer);
    if (code >= 0) code = avformat_write_header(format, muxer.Address());
    if (code < 0) return Failed(path_, "its beginning", code);
    return MakeFrame();
  }

  absl::Status Add(const frame::RgbImage& image, int frames) {
    if ((image.width_px & ~1) != codec_->width || (image.height_px & ~1) != codec_->height) {
      return absl::InvalidArgumentError(
          absl::StrCat(path_, ": its pictures differ in size; give all of them the same size"));
    }
    for (int i = 0; i < frames; ++i) {
      if (const int code = av_frame_make_writable(frame_.get()); code < 0) {
        return NotMade(path_, "the allocation of a frame", code);
      }
      const std::array<const std::uint8_t*, 1> source = {image.rgb.data()};
      const std::array<int, 1> stride = {3 * image.width_px};
      sws_scale(scaler_.get(), source.data(), stride.data(), 0, codec_->height, frame_->data,
                frame_->linesize);
      frame_->pts = next_frame_++;
      THUNDERHEAD_RETURN_IF_ERROR(Encode(frame_.get()));
    }
    return absl::OkStatus();
  }

  absl::Status Close() {
    THUNDERHEAD_RETURN_IF_ERROR(Encode(nullptr));
    int code = av_write_trailer(format_.get());
    if (code >= 0) code = avio_closep(&format_->pb);
    return code < 0 ? Failed(path_, "its end", code) : absl::OkStatus();
  }

 private:
  absl::Status EncoderFailed(int code) const {
    return NotMade(path_, absl::StrCat("the ", KindOf(path_)->codec_name, " encoder"), code);
  }

  absl::Status MakeFrame() {
    frame_.reset(av_frame_alloc());
    frame_->format = codec_->pix_fmt;
    frame_->width = codec_->width;
    frame_->height = codec_->height;
    frame_->color_range = codec_->color_range;
    frame_->colorspace = codec_->colorspace;
    if (const int code = av_frame_get_buffer(frame_.get(), 0); code < 0) {
      return NotMade(path_, "the allocation of a frame", code);
    }
    packet_.reset(av_packet_alloc());
    scaler_.reset(sws_getContext(codec_->width, codec_->height, AV_PIX_FMT_RGB24, codec_->width,
                                 codec_->height, AV_PIX_FMT_YUV420P, SWS_BICUBIC | SWS_ACCURATE_RND,
                                 nullptr, nullptr, nullptr));
    if (scaler_ == nullptr) return absl::InternalError("libswscale cannot convert RGB");
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(scaler_.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    return absl::OkStatus();
  }

  // Encodes a frame and writes the packets that are ready. A null frame flushes the encoder.
  absl::Status Encode(const AVFrame* frame) {
    if (const int code = avcodec_send_frame(codec_.get(), frame); code < 0) {
      return EncoderFailed(code);
    }
    THUNDERHEAD_CHECK(stream_ != nullptr, path_);
    while (true) {
      int code = avcodec_receive_packet(codec_.get(), packet_.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return absl::OkStatus();
      if (code < 0) return EncoderFailed(code);
      packet_->duration = 1;
      av_packet_rescale_ts(packet_.get(), codec_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      code = av_interleaved_write_frame(format_.get(), packet_.get());
      if (code < 0) return Failed(path_, "a frame", code);
    }
  }

  const std::string path_;
  base::FileDescriptor partial_;
  std::unique_ptr<AVFormatContext, FormatDeleter> format_;
  std::unique_ptr<AVCodecContext, ContextDeleter> codec_;
  std::unique_ptr<AVFrame, FrameDeleter> frame_;
  std::unique_ptr<AVPacket, PacketDeleter> packet_;
  std::unique_ptr<SwsContext, ScalerDeleter> scaler_;
  AVStream* stream_ = nullptr;  // owned by format_
  std::int64_t next_frame_ = 0;
};

absl::Status WritePartial(const std::string& path, const std::vector<int>& frames,
                          int frames_per_second, const MovieText& text,
                          const MoviePicture& picture) {
  MovieWriter writer(path);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const frame::RgbImage image, picture(i));
    if (i == 0) {
      THUNDERHEAD_RETURN_IF_ERROR(
          writer.Open(image.width_px, image.height_px, frames_per_second, text));
    }
    THUNDERHEAD_RETURN_IF_ERROR(writer.Add(image, frames[i]));
  }
  return writer.Close();
}

}  // namespace

bool IsMovieName(std::string_view path) { return KindOf(path) != nullptr; }

std::vector<int> FramesOfPictures(const std::vector<absl::Time>& valid) {
  std::vector<int> frames(valid.size(), 1);
  absl::Duration step = absl::InfiniteDuration();
  for (std::size_t i = 1; i < valid.size(); ++i) step = std::min(step, valid[i] - valid[i - 1]);
  for (std::size_t i = 1; i < valid.size(); ++i) {
    const double steps = std::round(absl::FDivDuration(valid[i] - valid[i - 1], step));
    frames[i - 1] = steps < kLongestGap ? std::max(static_cast<int>(steps), 1) : 1;
  }
  return frames;
}

absl::Status WriteMovie(const std::string& path, const std::vector<int>& frames,
                        int frames_per_second, const MovieText& text, const MoviePicture& picture) {
  THUNDERHEAD_CHECK(!frames.empty() && frames_per_second > 0 && IsMovieName(path), path);
  av_log_set_level(AV_LOG_ERROR);
  absl::Status status = WritePartial(path, frames, frames_per_second, text, picture);
  if (status.ok()) return base::PublishFile(path);
  std::error_code ignored;
  std::filesystem::remove(base::PartialPath(path), ignored);
  return status;
}

}  // namespace thunderhead::pipeline
