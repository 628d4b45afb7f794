#include "grib/decompressed.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "grib/index.h"

namespace thunderhead::grib {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kInputBytes = 256 << 10;
constexpr std::size_t kOutputBytes = 1 << 20;

class DecompressedBytes final : public base::ByteSource {
 public:
  DecompressedBytes(std::string path, Bytes bytes)
      : path_(std::move(path)), bytes_(std::move(bytes)) {}

  const std::string& Path() const override { return path_; }
  std::uint64_t Size_bytes() const override { return bytes_.size(); }
  absl::Status Read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset > bytes_.size() || to.size() > bytes_.size() - offset) {
      return absl::DataLossError(absl::StrCat(path_, ": its decompressed contents end at byte ",
                                              bytes_.size(), "; copy the file again"));
    }
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), to.size(), to.begin());
    return absl::OkStatus();
  }

 private:
  const std::string path_;
  const Bytes bytes_;
};

// The outcome of a step of a decompressor.
enum class Step { kContinues, kEnded, kDamaged };

// A decompressor of one library. Both libraries have the same kind of interface.
class Bz2 {
 public:
  static constexpr const char* kName = "bz2";

  Bz2() { is_open_ = BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK; }
  ~Bz2() {
    if (is_open_) BZ2_bzDecompressEnd(&stream_);
  }
  Bz2(const Bz2&) = delete;
  Bz2& operator=(const Bz2&) = delete;

  bool IsOpen() const { return is_open_; }
  Step Run(std::span<std::byte>& input, std::span<std::byte>& output) {
    stream_.next_in = reinterpret_cast<char*>(input.data());
    stream_.avail_in = static_cast<unsigned>(input.size());
    stream_.next_out = reinterpret_cast<char*>(output.data());
    stream_.avail_out = static_cast<unsigned>(output.size());
    const int result = BZ2_bzDecompress(&stream_);
    input = input.last(stream_.avail_in);
    output = output.last(stream_.avail_out);
    if (result == BZ_STREAM_END) return Step::kEnded;
    return result == BZ_OK ? Step::kContinues : Step::kDamaged;
  }

 private:
  bz_stream stream_{};
  bool is_open_ = false;
};

class Gz {
 public:
  static constexpr const char* kName = "gz";

  Gz() {
    constexpr int kGzipOnly = 16;
    is_open_ = inflateInit2(&stream_, kGzipOnly + MAX_WBITS) == Z_OK;
  }
  ~Gz() {
    if (is_open_) inflateEnd(&stream_);
  }
  Gz(const Gz&) = delete;
  Gz& operator=(const Gz&) = delete;

  bool IsOpen() const { return is_open_; }
  Step Run(std::span<std::byte>& input, std::span<std::byte>& output) {
    stream_.next_in = reinterpret_cast<Bytef*>(input.data());
    stream_.avail_in = static_cast<uInt>(input.size());
    stream_.next_out = reinterpret_cast<Bytef*>(output.data());
    stream_.avail_out = static_cast<uInt>(output.size());
    const int result = inflate(&stream_, Z_NO_FLUSH);
    input = input.last(stream_.avail_in);
    output = output.last(stream_.avail_out);
    if (result == Z_STREAM_END) return Step::kEnded;
    return result == Z_OK || result == Z_BUF_ERROR ? Step::kContinues : Step::kDamaged;
  }

 private:
  z_stream stream_{};
  bool is_open_ = false;
};

template <typename Library>
class Decompressor {
 public:
  Decompressor(const base::ByteSource& file, std::uint64_t most_bytes)
      : file_(file), most_bytes_(most_bytes) {}

  absl::StatusOr<Bytes> Run() {
    THUNDERHEAD_RETURN_IF_ERROR(Fill());
    // A file can have several streams, one after another.
    while (!input_.empty()) THUNDERHEAD_RETURN_IF_ERROR(RunStream());
    THUNDERHEAD_RETURN_IF_ERROR(CheckStart());
    contents_.shrink_to_fit();
    return std::move(contents_);
  }

 private:
  absl::Status Fill() {
    if (!input_.empty() || at_ >= file_.Size_bytes()) return absl::OkStatus();
    buffer_.resize(std::min<std::uint64_t>(kInputBytes, file_.Size_bytes() - at_));
    THUNDERHEAD_RETURN_IF_ERROR(file_.Read(at_, buffer_));
    at_ += buffer_.size();
    input_ = buffer_;
    return absl::OkStatus();
  }

  absl::Status RunStream() {
    Library library;
    if (!library.IsOpen()) {
      return absl::ResourceExhaustedError(
          absl::StrCat(file_.Path(), ": there is no memory to decompress it; free some"));
    }
    Bytes part(kOutputBytes);
    for (Step step = Step::kContinues; step != Step::kEnded;) {
      THUNDERHEAD_RETURN_IF_ERROR(Fill());
      const bool at_end = input_.empty();
      std::span<std::byte> room(part);
      step = library.Run(input_, room);
      const std::size_t made = part.size() - room.size();
      if (step == Step::kDamaged) return Damaged("is damaged");
      if (step == Step::kContinues && at_end && made == 0) return Damaged("ends early");
      THUNDERHEAD_RETURN_IF_ERROR(Append(std::span(part).first(made)));
    }
    return Fill();
  }

  absl::Status Append(std::span<const std::byte> made) {
    if (contents_.size() + made.size() > most_bytes_) {
      return absl::ResourceExhaustedError(
          absl::StrCat(file_.Path(), ": its decompressed contents exceed ", most_bytes_,
                       " bytes; decompress it yourself, or split it"));
    }
    contents_.insert(contents_.end(), made.begin(), made.end());
    // Another file is refused before more of it is decompressed.
    constexpr std::size_t kEnough = 4096;
    return contents_.size() < kEnough ? absl::OkStatus() : CheckStart();
  }

  absl::Status CheckStart() const {
    if (BeginsLikeGrib({reinterpret_cast<const char*>(contents_.data()), contents_.size()})) {
      return absl::OkStatus();
    }
    return absl::InvalidArgumentError(
        absl::StrCat(file_.Path(), ": is a ", Library::kName,
                     " file without a GRIB message; decompress it, or give a GRIB2 file"));
  }

  absl::Status Damaged(std::string_view what) const {
    return absl::DataLossError(absl::StrCat(file_.Path(), ": the ", Library::kName, " file ",
                                            std::string(what), "; copy it again"));
  }

  const base::ByteSource& file_;
  const std::uint64_t most_bytes_;
  std::uint64_t at_ = 0;  // of the next byte to read
  Bytes buffer_;
  std::span<std::byte> input_;
  Bytes contents_;
};

bool IsBz2(std::string_view start) {
  return start.size() >= 4 && start.substr(0, 3) == "BZh" && start[3] >= '1' && start[3] <= '9';
}

bool IsGz(std::string_view start) { return start.substr(0, 2) == "\x1f\x8b"; }

}  // namespace

bool BeginsCompressed(std::string_view start) { return IsBz2(start) || IsGz(start); }

absl::StatusOr<std::shared_ptr<const base::ByteSource>> Decompressed(
    std::shared_ptr<const base::ByteSource> file, std::uint64_t most_bytes) {
  std::array<char, 4> bytes{};
  const std::size_t count = std::min<std::uint64_t>(bytes.size(), file->Size_bytes());
  THUNDERHEAD_RETURN_IF_ERROR(file->Read(0, std::as_writable_bytes(std::span(bytes)).first(count)));
  const std::string_view start(bytes.data(), count);
  if (!BeginsCompressed(start)) return file;
  Bytes contents;
  if (IsBz2(start)) {
    THUNDERHEAD_ASSIGN_OR_RETURN(contents, Decompressor<Bz2>(*file, most_bytes).Run());
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(contents, Decompressor<Gz>(*file, most_bytes).Run());
  }
  return std::make_shared<DecompressedBytes>(file->Path(), std::move(contents));
}

}  // namespace thunderhead::grib
