#include "picture/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/own_file.h"
#include "base/status.h"
#include "base/whole_file.h"

namespace thunderhead::picture {
namespace {

constexpr std::array<const char*, 3> kRadiance = {"R", "G", "B"};
constexpr std::array<const char*, 3> kError = {"stderr.R", "stderr.G", "stderr.B"};
// The channel is not named A, because viewers would treat a channel A as alpha for compositing.
constexpr char kOpacity[] = "storm.opacity";
constexpr char kOpticalDepth[] = "storm.optical_depth";
constexpr char kDepthOneDistance[] = "storm.depth_one_distance";

// OpenEXR allocates some rows when it opens a file. This limit keeps their memory small.
constexpr int kMaxSide_px = 65535;
// ZIP, the compression of the files that EncodeExr writes, makes data at most this many times
// smaller.
constexpr std::uint64_t kMaxCompression = 1032;

// A channel of a file, and the address of its first value in a picture.
struct Channel {
  const char* name;
  float* first;
  std::size_t stride;  // bytes from one pixel to the next
};

void AddColors(const std::array<const char*, 3>& names, std::vector<glm::vec3>& values,
               std::vector<Channel>& channels) {
  if (values.empty()) return;
  for (int color = 0; color < 3; ++color) {
    channels.push_back(
        {names[static_cast<std::size_t>(color)], &values.front()[color], sizeof(glm::vec3)});
  }
}

void AddValues(const char* name, std::vector<float>& values, std::vector<Channel>& channels) {
  if (!values.empty()) channels.push_back({name, values.data(), sizeof(float)});
}

// Returns the channels for the values that the picture has.
std::vector<Channel> ChannelsOf(LinearPicture& picture) {
  std::vector<Channel> channels;
  AddColors(kRadiance, picture.radiance, channels);
  AddColors(kError, picture.standard_error, channels);
  AddValues(kOpacity, picture.opacity, channels);
  AddValues(kOpticalDepth, picture.optical_depth, channels);
  AddValues(kDepthOneDistance, picture.depth_one_distance_m, channels);
  return channels;
}

Imf::FrameBuffer FrameBufferOf(const std::vector<Channel>& channels, std::size_t width) {
  Imf::FrameBuffer buffer;
  for (const Channel& channel : channels) {
    buffer.insert(channel.name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(channel.first),
                                           channel.stride, width * channel.stride));
  }
  return buffer;
}

// Output to memory for OpenEXR. OpenEXR reports errors by exceptions, which do not leave this file.
class BytesOut final : public Imf::OStream {
 public:
  BytesOut() : OStream("memory") {}

  void write(const char from[], int count) override {
    const auto bytes = static_cast<std::size_t>(count);
    if (bytes_.size() < at_ + bytes) bytes_.resize(at_ + bytes);
    std::memcpy(bytes_.data() + at_, from, bytes);
    at_ += bytes;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }

  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

class BytesIn final : public Imf::IStream {
 public:
  explicit BytesIn(std::string_view bytes) : IStream("memory"), bytes_(bytes) {}

  bool read(char to[], int count) override {
    const auto bytes = static_cast<std::size_t>(count);
    if (bytes > bytes_.size() - at_) throw std::runtime_error("the file is cut short");
    std::memcpy(to, bytes_.data() + at_, bytes);
    at_ += bytes;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override {
    if (at > bytes_.size()) throw std::runtime_error("the file is cut short");
    at_ = at;
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

// Makes OpenEXR refuse files of pictures whose width or height exceeds kMaxSide_px.
void LimitSides() {
  static const bool is_limited = (Imf::Header::setMaxImageSize(kMaxSide_px, kMaxSide_px), true);
  static_cast<void>(is_limited);
}

// Returns an error if a file of `bytes` cannot contain the values of as many pixels as its header
// says, so that no memory is allocated for them.
absl::Status CheckSize(const glm::ivec2& size_px, std::uint64_t values_per_pixel,
                       std::uint64_t bytes, const std::string& what) {
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(size_px.x) * static_cast<std::uint64_t>(size_px.y);
  if (pixels * values_per_pixel * sizeof(float) <= kMaxCompression * bytes) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat("'", what, "' has ", bytes, " bytes, too few for its ", size_px.x, " x ",
                   size_px.y, " pixels; give a complete file that thunderhead wrote"));
}

ExrAttributes AttributesOf(const Imf::Header& header) {
  ExrAttributes attributes;
  for (auto at = header.begin(); at != header.end(); ++at) {
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&at.attribute())) {
      attributes.texts.emplace(at.name(), text->value());
    } else if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(&at.attribute())) {
      attributes.numbers.emplace(at.name(), number->value());
    }
  }
  return attributes;
}

}  // namespace

absl::StatusOr<std::string> EncodeExr(const LinearPicture& picture,
                                      const ExrAttributes& attributes) {
  THUNDERHEAD_CHECK(picture.size_px.x > 0 && picture.size_px.y > 0, "a picture without pixels");
  try {
    Imf::Header header(picture.size_px.x, picture.size_px.y);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, text] : attributes.texts) {
      header.insert(name.c_str(), Imf::StringAttribute(text));
    }
    for (const auto& [name, number] : attributes.numbers) {
      header.insert(name.c_str(), Imf::FloatAttribute(number));
    }
    // OpenEXR requires non-const addresses even for writing a file, so it gets a copy.
    LinearPicture copy = picture;
    const std::vector<Channel> channels = ChannelsOf(copy);
    for (const Channel& channel : channels) {
      header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    }
    BytesOut bytes;
    {
      // The file is complete only after `file` is destroyed.
      Imf::OutputFile file(bytes, header);
      file.setFrameBuffer(FrameBufferOf(channels, static_cast<std::size_t>(picture.size_px.x)));
      file.writePixels(picture.size_px.y);
    }
    return bytes.Take();
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("cannot encode the picture as EXR: ", error.what()));
  }
}

void SetExrNumber(const std::string& name, float value, std::string* exr) {
  // An attribute is its name, type and size, then the value with the least significant byte first.
  using std::string_literals::operator""s;
  const std::string before = name + "\0float\0\4\0\0\0"s;
  const std::size_t at = exr->find(before);
  THUNDERHEAD_CHECK(at != std::string::npos, name);
  std::memcpy(exr->data() + at + before.size(), &value, sizeof(value));
}

absl::StatusOr<ExrPicture> DecodeExr(const std::string& exr, const std::string& what) {
  try {
    LimitSides();
    BytesIn bytes(exr);
    Imf::InputFile file(bytes);
    const auto has = [&](const char* name) {
      return file.header().channels().findChannel(name) != nullptr;
    };
    for (const char* name : kRadiance) {
      if (has(name)) continue;
      return absl::InvalidArgumentError(absl::StrCat("'", what,
                                                     "' is an OpenEXR file without the channel ",
                                                     name, "; give a file that thunderhead wrote"));
    }
    const Imath::Box2i window = file.header().dataWindow();
    if (window.min.x != 0 || window.min.y != 0) {
      return absl::InvalidArgumentError(absl::StrCat(
          "'", what, "' does not begin at pixel (0, 0); give a file that thunderhead wrote"));
    }
    ExrPicture result;
    LinearPicture& picture = result.picture;
    picture.size_px = {window.max.x + 1, window.max.y + 1};
    const bool has_error = has(kError[0]) && has(kError[1]) && has(kError[2]);
    std::uint64_t values = has_error ? 6 : 3;
    for (const char* name : {kOpacity, kOpticalDepth, kDepthOneDistance}) {
      values += has(name) ? 1 : 0;
    }
    THUNDERHEAD_RETURN_IF_ERROR(CheckSize(picture.size_px, values, exr.size(), what));
    const auto width = static_cast<std::size_t>(picture.size_px.x);
    const std::size_t pixels = width * static_cast<std::size_t>(picture.size_px.y);
    picture.radiance.resize(pixels);
    if (has_error) picture.standard_error.resize(pixels);
    if (has(kOpacity)) picture.opacity.resize(pixels);
    if (has(kOpticalDepth)) picture.optical_depth.resize(pixels);
    if (has(kDepthOneDistance)) picture.depth_one_distance_m.resize(pixels);
    file.setFrameBuffer(FrameBufferOf(ChannelsOf(picture), width));
    file.readPixels(0, picture.size_px.y - 1);
    result.attributes = AttributesOf(file.header());
    return result;
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot read '", what, "': ", error.what(),
                     "; give an OpenEXR file that thunderhead wrote"));
  }
}

absl::Status WriteExr(const std::string& path, const LinearPicture& picture,
                      const ExrAttributes& attributes) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string bytes, EncodeExr(picture, attributes));
  return base::WriteWholeFile(path, bytes);
}

absl::StatusOr<LinearPicture> ReadExr(const std::string& path) {
  auto bytes = base::ReadOwnFile(path);
  if (!bytes.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot read '", path, "': ", bytes.status().message()));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(ExrPicture exr, DecodeExr(*bytes, path));
  return std::move(exr.picture);
}

}  // namespace thunderhead::picture
