// Encodes and decodes VP9 with libvpx. A stream of moving pictures can be decoded by the browsers'
// WebCodecs. Colours are encoded as in JPEG: sRGB as full-range BT.601 4:2:0. An encoder or decoder
// is used by one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "frame/image_codec.h"

namespace thunderhead::codec {

enum class Vp9Kind {
  kKey,        // needs no other picture
  kBase,       // needs the last key or base picture; later pictures need it
  kDroppable,  // needs the last key or base picture; no other picture needs it
};

struct Vp9Picture {
  std::string bytes;
  bool key = false;
};

class Vp9Encoder {
 public:
  // Returns the number of bits per picture that the encoder aims at, as an average over a second of
  // 30 pictures. For 1280 x 720 pixels it corresponds to 1.9 Mbit per second.
  static double BitsPerPicture(int width_px, int height_px);

  // Returns the approximate memory of an encoder for that size, in bytes. Measured values are 27
  // MiB at 640 x 360, 78 MiB at 1280 x 720 and 112 MiB at 1600 x 900 pixels.
  static std::size_t BytesFor(int width_px, int height_px);

  // Creates an encoder. Returns INVALID_ARGUMENT if a side is outside 1 to 16384 pixels.
  static absl::StatusOr<std::unique_ptr<Vp9Encoder>> Create(int width_px, int height_px);
  ~Vp9Encoder();
  Vp9Encoder(const Vp9Encoder&) = delete;
  Vp9Encoder& operator=(const Vp9Encoder&) = delete;

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

  // Encodes the next picture. The first one is always a key picture. Returns INVALID_ARGUMENT if
  // the picture does not have the encoder's size.
  absl::StatusOr<Vp9Picture> Encode(const frame::RgbImage& picture, Vp9Kind kind);

 private:
  struct State;
  explicit Vp9Encoder(std::unique_ptr<State> state, int width_px, int height_px);

  const std::unique_ptr<State> state_;
  const int width_px_;
  const int height_px_;
  std::int64_t count_ = 0;
};

// A decoder for tests and measurements; clients have their own decoder.
class Vp9Decoder {
 public:
  static absl::StatusOr<std::unique_ptr<Vp9Decoder>> Create();
  ~Vp9Decoder();
  Vp9Decoder(const Vp9Decoder&) = delete;
  Vp9Decoder& operator=(const Vp9Decoder&) = delete;

  absl::StatusOr<frame::RgbImage> Decode(const std::string& bytes);

 private:
  struct State;
  explicit Vp9Decoder(std::unique_ptr<State> state);

  const std::unique_ptr<State> state_;
};

}  // namespace thunderhead::codec
