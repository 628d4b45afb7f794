// Decodes frames to pixels: JPEG by TurboJPEG, VP9 by libvpx, AVIF stills by libavif. A decoder is
// used by one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

// 8 bits a channel, sRGB; rows from top to bottom, each of red, green, blue and one unused byte a
// pixel.
struct Pixels {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgbx;
};

class PictureDecoder {
 public:
  PictureDecoder();
  ~PictureDecoder();
  PictureDecoder(const PictureDecoder&) = delete;
  PictureDecoder& operator=(const PictureDecoder&) = delete;

  // Encodings besides JPEG, for Join.codecs.
  static std::vector<v1::Codec> Codecs() { return {v1::CODEC_VP9, v1::CODEC_AVIF}; }

  // Decodes a frame into `pixels`, whose memory is used again; those of a frame of video that is
  // not `wanted` stay as they are, though the next ones may need it. An error says what could not
  // be decoded.
  absl::Status Decode(const v1::Frame& frame, bool wanted, Pixels& pixels);
  // A new stream of video begins.
  void Restart();

 private:
  struct State;
  absl::Status DecodeJpeg(const std::string& bytes, Pixels& pixels);
  absl::Status DecodeVp9(const v1::Frame& frame, bool wanted, Pixels& pixels);
  absl::Status DecodeAvif(const std::string& bytes, Pixels& pixels);

  const std::unique_ptr<State> state_;
};

}  // namespace thunderhead::client
