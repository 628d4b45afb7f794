// Decodes frames to pixels: JPEG by TurboJPEG, VP9 by libvpx, AVIF images by libavif. Only one
// thread may use a decoder at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

// An image in sRGB with 8 bits a channel. The rows go from top to bottom. Each pixel has red,
// green, blue and one unused byte.
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

  // Returns the encodings that this class can decode in addition to JPEG, for the message field
  // Join.codecs.
  static std::vector<v1::Codec> Codecs() { return {v1::CODEC_VP9, v1::CODEC_AVIF}; }

  // Decodes a frame into `pixels`, whose memory is reused. A video frame that is not `wanted` is
  // decoded, because later frames depend on it, but `pixels` stay unchanged. The error says what
  // could not be decoded.
  absl::Status Decode(const v1::Frame& frame, bool wanted, Pixels& pixels);
  // Resets the video decoder for a new stream.
  void Restart();

 private:
  struct State;
  absl::Status DecodeJpeg(const std::string& bytes, Pixels& pixels);
  absl::Status DecodeVp9(const v1::Frame& frame, bool wanted, Pixels& pixels);
  absl::Status DecodeAvif(const std::string& bytes, Pixels& pixels);

  const std::unique_ptr<State> state_;
};

}  // namespace thunderhead::client
