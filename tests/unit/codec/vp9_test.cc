#include "codec/vp9.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/unit/codec/test_pictures.h"

namespace thunderhead::codec {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 322;
constexpr int kHeight = 178;
// Peak signal-to-noise ratio (PSNR) at which people hardly see a difference.
constexpr double kGood_dB = 34.0;

class Vp9Test : public ::testing::Test {
 protected:
  std::string Encode(int shift_px, Vp9Kind kind) {
    auto picture = encoder_->Encode(MovingPicture(kWidth, kHeight, shift_px), kind);
    EXPECT_TRUE(picture.ok()) << picture.status();
    is_key_ = picture->key;
    return picture->bytes;
  }
  // Returns the PSNR of the decoded picture, compared with the original picture that is shifted by
  // `shift_px`.
  double Decoded_dB(const std::string& bytes, int shift_px) {
    const auto decoded = decoder_->Decode(bytes);
    if (!decoded.ok()) return 0.0;
    EXPECT_EQ(decoded->width_px, kWidth);
    EXPECT_EQ(decoded->height_px, kHeight);
    return Psnr_dB(*decoded, MovingPicture(kWidth, kHeight, shift_px));
  }

  std::unique_ptr<Vp9Encoder> encoder_ = *Vp9Encoder::Create(kWidth, kHeight);
  std::unique_ptr<Vp9Decoder> decoder_ = *Vp9Decoder::Create();
  bool is_key_ = false;
};

TEST_F(Vp9Test, PicturesComeBackAsTheyWere) {
  for (int i = 0; i < 10; ++i) {
    EXPECT_GT(Decoded_dB(Encode(3 * i, Vp9Kind::kBase), 3 * i), kGood_dB);
    EXPECT_EQ(is_key_, i == 0);
  }
}

TEST_F(Vp9Test, AKeyPictureComesOnDemandAndIsEnough) {
  for (int i = 0; i < 5; ++i) Encode(3 * i, Vp9Kind::kBase);
  const std::string needs_others = Encode(15, Vp9Kind::kBase);
  EXPECT_LT(Decoded_dB(needs_others, 15), 10.0);
  const std::string key = Encode(18, Vp9Kind::kKey);
  EXPECT_TRUE(is_key_);
  decoder_ = *Vp9Decoder::Create();
  EXPECT_GT(Decoded_dB(key, 18), kGood_dB);
}

// A viewer that misses droppable pictures sees the others exactly like a viewer that received them
// all.
TEST_F(Vp9Test, DroppablePicturesCanBeDropped) {
  auto all = *Vp9Decoder::Create();
  for (int i = 0; i < 24; ++i) {
    const bool base = i % 4 == 0;
    const std::string bytes = Encode(5 * i, base ? Vp9Kind::kBase : Vp9Kind::kDroppable);
    const auto seen_by_all = all->Decode(bytes);
    ASSERT_TRUE(seen_by_all.ok()) << seen_by_all.status();
    if (!base) continue;
    const auto seen = decoder_->Decode(bytes);
    ASSERT_TRUE(seen.ok()) << seen.status();
    EXPECT_EQ(seen->rgb, seen_by_all->rgb) << "picture " << i;
  }
}

TEST_F(Vp9Test, BytesStayWithinTheBudget) {
  constexpr int kPictures = 60;
  std::size_t bytes = 0;
  for (int i = 0; i < kPictures; ++i) {
    // Each picture has different noise, which no prediction can compress.
    frame::RgbImage picture = MovingPicture(kWidth, kHeight, 40 * i);
    for (std::size_t at = 0; at < picture.rgb.size(); ++at) {
      picture.rgb[at] ^=
          static_cast<std::uint8_t>((at * (2654435761U + static_cast<unsigned>(i))) >> 24) & 31U;
    }
    bytes += encoder_->Encode(picture, Vp9Kind::kBase)->bytes.size();
  }
  const double bits = 8.0 * static_cast<double>(bytes) / kPictures;
  EXPECT_LT(bits, 1.2 * Vp9Encoder::BitsPerPicture(kWidth, kHeight));
}

TEST(Vp9, BadSizesAreRefused) {
  EXPECT_THAT(std::string(Vp9Encoder::Create(0, 10).status().message()), HasSubstr("0 x 10"));
  const auto encoder = *Vp9Encoder::Create(8, 8);
  const auto wrong = encoder->Encode(MovingPicture(8, 9, 0), Vp9Kind::kBase);
  EXPECT_THAT(std::string(wrong.status().message()), HasSubstr("8 x 9"));
}

TEST(Vp9, TheSmallestPictureIsOne) {
  const auto encoder = Vp9Encoder::Create(1, 1);
  ASSERT_TRUE(encoder.ok()) << encoder.status();
  EXPECT_TRUE((*encoder)->Encode({1, 1, {200, 100, 50}}, Vp9Kind::kBase).ok());
}

TEST(Vp9, WhatIsNoVideoIsAnError) {
  EXPECT_FALSE((*Vp9Decoder::Create())->Decode("no video").ok());
}

}  // namespace
}  // namespace thunderhead::codec
