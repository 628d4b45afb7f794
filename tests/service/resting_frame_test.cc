// Tests of the resting frames that viewers are sent, compared with the picture before its rounding
// to 8 bits. They measure the error of the default spotter's sky in blocks of 8 x 8 pixels, where
// steps show as bands. Prints a table; with THUNDERHEAD_SIZE=1280x720 it is the table of decision
// 28.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "codec/avif.h"
#include "drawing/gl_frame_source.h"
#include "frame/image_codec.h"
#include "gtest/gtest.h"
#include "renderers/technique_registry.h"
#include "service/engine/engine.h"
#include "service/messages/camera_messages.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"
#include "storm_store/storm_store.h"

namespace thunderhead {
namespace {

constexpr int kBlock_px = 8;
constexpr double kLevel = 65535.0 / 255.0;  // one level of 8 bits, in levels of 16 bits

using Pixels = std::vector<double>;  // three values (0 to 255) a pixel, rows from the top

Pixels LevelsOf(const std::vector<std::uint16_t>& rgb) {
  Pixels levels;
  levels.reserve(rgb.size());
  for (const std::uint16_t value : rgb) levels.push_back(value / kLevel);
  return levels;
}

Pixels LevelsOf(const std::vector<std::uint8_t>& rgb) { return {rgb.begin(), rgb.end()}; }

Pixels Rounded(Pixels levels) {
  for (double& level : levels) level = std::round(level);
  return levels;
}

double BlockMean(const Pixels& pixels, int width_px, int x, int y, int channel) {
  double sum = 0.0;
  for (int row = y; row < y + kBlock_px; ++row) {
    for (int column = x; column < x + kBlock_px; ++column) {
      sum += pixels[static_cast<std::size_t>(3 * (row * width_px + column) + channel)];
    }
  }
  return sum / (kBlock_px * kBlock_px);
}

// A fixture with the resting frame of the sample storm's default spotter, drawn once.
class RestingFrameTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    int width = 640;
    int height = 360;
    if (const char* const size = std::getenv("THUNDERHEAD_SIZE"); size != nullptr) {
      ASSERT_EQ(std::sscanf(size, "%dx%d", &width, &height), 2);
    }
    const auto store = storm_store::StormStore::Open(
        {std::string(THUNDERHEAD_SOURCE_DIR) + "/samples/supercell.nc"}, {});
    ASSERT_TRUE(store.ok()) << store.status();
    v1::Scene message;
    message.mutable_camera()->mutable_spotter();
    message.mutable_output()->set_width_px(static_cast<std::uint32_t>(width));
    message.mutable_output()->set_height_px(static_cast<std::uint32_t>(height));
    const auto techniques = renderers::TechniqueRegistry::BuiltIn().Infos();
    ASSERT_TRUE(service::PrepareScene(**store, techniques, message).ok());
    const auto fields =
        (*store)->Get(message.storm_id(), static_cast<int>(message.time_index()), {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    service::FrameCondensate(message, **fields);
    const scene::Scene scene = service::ToScene(message);
    const auto source = drawing::GlFrameSources("auto")(nullptr);
    ASSERT_TRUE(source.ok()) << source.status();
    auto drawn = (*source)->Draw(scene, *fields, {});
    ASSERT_TRUE(drawn.ok()) << drawn.status();
    auto fine = (*source)->Fine();
    ASSERT_TRUE(fine.ok()) << fine.status();
    drawn_ = new drawing::DisplayFrame(*std::move(drawn));
    fine_ = new frame::FineImage(*std::move(fine));
    exact_ = new Pixels(LevelsOf(fine_->rgb));
  }

  static void TearDownTestSuite() {
    delete drawn_;
    delete fine_;
    delete exact_;
  }

  // Returns whether a block is of blue that hardly varies.
  static bool IsSky(int x, int y) {
    const auto& rgb = fine_->rgb;
    int least = 65535;
    int most = 0;
    for (int row = y; row < y + kBlock_px; ++row) {
      for (int column = x; column < x + kBlock_px; ++column) {
        const auto at = static_cast<std::size_t>(3 * (row * fine_->width_px + column));
        least = std::min<int>(least, rgb[at]);
        most = std::max<int>(most, rgb[at]);
        if (rgb[at + 2] < rgb[at] + 20.0 * kLevel) return false;
      }
    }
    return most - least < 2.5 * kLevel;
  }

  // Returns the root mean square of the differences of block means in the sky, in levels of 255.
  static double Banding(const Pixels& pixels) {
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y + kBlock_px <= fine_->height_px; y += kBlock_px) {
      for (int x = 0; x + kBlock_px <= fine_->width_px; x += kBlock_px) {
        if (!IsSky(x, y)) continue;
        for (int channel = 0; channel < 3; ++channel) {
          const double difference = BlockMean(pixels, fine_->width_px, x, y, channel) -
                                    BlockMean(*exact_, fine_->width_px, x, y, channel);
          sum += difference * difference;
          ++count;
        }
      }
    }
    EXPECT_GT(count, 300) << "there is little sky in the picture";
    return std::sqrt(sum / count);
  }

  // Returns the root mean square of all pixels' differences, in levels of 255.
  static double Rmse(const Pixels& pixels) {
    double sum = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i) sum += std::pow(pixels[i] - (*exact_)[i], 2);
    return std::sqrt(sum / static_cast<double>(pixels.size()));
  }

  static void Tell(const std::string& name, std::size_t bytes, double ms, const Pixels& pixels) {
    std::printf("%-28s %7.1f kB %7.1f ms  banding %.3f  RMSE %.2f\n", name.c_str(),
                static_cast<double>(bytes) / 1e3, ms, Banding(pixels), Rmse(pixels));
  }

  struct Sent {
    std::size_t bytes = 0;
    double banding = 0.0;
  };

  static Sent Jpeg(int quality) {
    const base::Stopwatch stopwatch;
    const auto jpeg = frame::EncodeJpeg(drawn_->width_px, drawn_->height_px, drawn_->rgb, quality);
    const double ms = stopwatch.ElapsedMs();
    const Pixels pixels = LevelsOf(frame::DecodeJpeg(*jpeg)->rgb);
    Tell("JPEG " + std::to_string(quality), jpeg->size(), ms, pixels);
    return {jpeg->size(), Banding(pixels)};
  }

  // Returns the image as a canvas of 8 bits shows it.
  static Sent Avif(const codec::AvifOptions& options) {
    const base::Stopwatch stopwatch;
    const auto avif = codec::EncodeAvif(*fine_, options);
    const double ms = stopwatch.ElapsedMs();
    const Pixels pixels = Rounded(LevelsOf(codec::DecodeAvif(*avif)->rgb));
    Tell("AVIF " + std::to_string(options.quantizer) + ", shown", avif->size(), ms, pixels);
    return {avif->size(), Banding(pixels)};
  }

  static drawing::DisplayFrame* drawn_;
  static frame::FineImage* fine_;
  static Pixels* exact_;
};

drawing::DisplayFrame* RestingFrameTest::drawn_ = nullptr;
frame::FineImage* RestingFrameTest::fine_ = nullptr;
Pixels* RestingFrameTest::exact_ = nullptr;

// The 8-bit picture equals the picture with 16 bits a channel, plus rounding noise of up to half a
// step.
TEST_F(RestingFrameTest, TheFinePictureIsTheOneDrawn) {
  const Pixels drawn = LevelsOf(drawn_->rgb);
  double most = 0.0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    most = std::max(most, std::abs(drawn[i] - (*exact_)[i]));
  }
  EXPECT_LT(most, 1.01);
  Tell("8 bits with noise, as drawn", drawn.size(), 0.0, drawn);
  Tell("8 bits without noise", drawn.size(), 0.0, Rounded(*exact_));
}

TEST_F(RestingFrameTest, AvifBandsLessThanJpegInFewerBytes) {
  const Sent jpeg = Jpeg(scene::Output().jpeg_quality);
  Jpeg(95);
  const Sent avif = Avif({});
  EXPECT_LT(avif.banding, 0.5 * jpeg.banding);
  EXPECT_LT(avif.bytes, jpeg.bytes);
  for (const int quantizer : {4, 16}) Avif({quantizer, codec::AvifOptions().speed});
}

}  // namespace
}  // namespace thunderhead
