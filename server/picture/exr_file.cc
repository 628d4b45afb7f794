#include "picture/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include <array>
#include <exception>
#include <filesystem>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/whole_file.h"

namespace thunderhead::picture {
namespace {

struct Channel {
  const char* name;
  bool error;  // of the standard error, not of radiance
  std::size_t color;
};

constexpr std::array<Channel, 6> kChannels = {{{"R", false, 0},
                                               {"G", false, 1},
                                               {"B", false, 2},
                                               {"stderr.R", true, 0},
                                               {"stderr.G", true, 1},
                                               {"stderr.B", true, 2}}};

// OpenEXR takes addresses that it may write to, also to write a file from.
Imf::FrameBuffer FrameBufferOf(LinearPicture* picture) {
  Imf::FrameBuffer buffer;
  const auto width = static_cast<std::size_t>(picture->size_px.x);
  for (const Channel& channel : kChannels) {
    auto& values = channel.error ? picture->standard_error : picture->radiance;
    auto* first = reinterpret_cast<char*>(values.data()) + channel.color * sizeof(float);
    buffer.insert(channel.name,
                  Imf::Slice(Imf::FLOAT, first, sizeof(glm::vec3), width * sizeof(glm::vec3)));
  }
  return buffer;
}

}  // namespace

absl::Status WriteExr(const std::string& path, const LinearPicture& picture) {
  THUNDERHEAD_CHECK(picture.size_px.x > 0 && picture.size_px.y > 0, "a picture without pixels");
  THUNDERHEAD_CHECK(picture.standard_error.size() == picture.radiance.size(), path);
  try {
    Imf::Header header(picture.size_px.x, picture.size_px.y);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const Channel& channel : kChannels) {
      header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    }
    LinearPicture copy = picture;
    // Closed before it is published.
    Imf::OutputFile file(base::PartialPath(path).c_str(), header);
    file.setFrameBuffer(FrameBufferOf(&copy));
    file.writePixels(picture.size_px.y);
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(base::PartialPath(path), ignored);
    return absl::UnavailableError(absl::StrCat("cannot write '", path, "': ", error.what(),
                                               "; check that the folder exists and has room"));
  }
  return base::PublishFile(path);
}

absl::StatusOr<LinearPicture> ReadExr(const std::string& path) {
  try {
    Imf::InputFile file(path.c_str());
    for (const Channel& channel : kChannels) {
      if (file.header().channels().findChannel(channel.name) == nullptr) {
        return absl::InvalidArgumentError(absl::StrCat("'", path, "' has no channel ", channel.name,
                                                       "; give a file that the reference wrote"));
      }
    }
    const Imath::Box2i window = file.header().dataWindow();
    if (window.min.x != 0 || window.min.y != 0) {
      return absl::InvalidArgumentError(absl::StrCat(
          "'", path, "' does not begin at pixel (0, 0); give a file that the reference wrote"));
    }
    LinearPicture picture;
    picture.size_px = {window.max.x + 1, window.max.y + 1};
    const auto pixels =
        static_cast<std::size_t>(picture.size_px.x) * static_cast<std::size_t>(picture.size_px.y);
    picture.radiance.resize(pixels);
    picture.standard_error.resize(pixels);
    file.setFrameBuffer(FrameBufferOf(&picture));
    file.readPixels(0, picture.size_px.y - 1);
    return picture;
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot read '", path, "': ", error.what(), "; give an OpenEXR file"));
  }
}

}  // namespace thunderhead::picture
