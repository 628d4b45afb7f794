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

// Bytes in blocks of one size. Memory grows by one block at a time, and no byte is moved. The bytes
// therefore take at most one block of memory in addition to their own size.
class Blocks {
 public:
  std::uint64_t Size_bytes() const { return size_bytes_; }

  // Returns the unused part of the last block, or a new block if that is full.
  std::span<std::byte> Room() {
    if (size_bytes_ == blocks_.size() * kBlock_bytes) blocks_.emplace_back(kBlock_bytes);
    return std::span(blocks_.back()).subspan(size_bytes_ % kBlock_bytes);
  }
  // Counts `count` bytes that were written to Room().
  void Use(std::size_t count) { size_bytes_ += count; }

  // Returns the first `most` bytes, or fewer if there are not as many. `most` is at most a block.
  std::string_view Start(std::size_t most) const {
    if (size_bytes_ == 0) return {};
    return {reinterpret_cast<const char*>(blocks_.front().data()),
            static_cast<std::size_t>(std::min<std::uint64_t>(size_bytes_, most))};
  }

  // Frees the unused part of the last block.
  void ShrinkToFit() {
    if (blocks_.empty()) return;
    blocks_.back().resize(size_bytes_ - (blocks_.size() - 1) * kBlock_bytes);
    blocks_.back().shrink_to_fit();
  }

  // Copies bytes from `offset` on. They must exist.
  void Copy(std::uint64_t offset, std::span<std::byte> to) const {
    while (!to.empty()) {
      const Bytes& block = blocks_[offset / kBlock_bytes];
      const std::size_t at = offset % kBlock_bytes;
      const std::size_t count = std::min(to.size(), block.size() - at);
      std::copy_n(block.begin() + static_cast<std::ptrdiff_t>(at), count, to.begin());
      to = to.subspan(count);
      offset += count;
    }
  }

 private:
  static constexpr std::size_t kBlock_bytes = 1 << 20;

  std::vector<Bytes> blocks_;
  std::uint64_t size_bytes_ = 0;
};

class DecompressedBytes final : public base::ByteSource {
 public:
  DecompressedBytes(std::string path, Blocks bytes)
      : path_(std::move(path)), bytes_(std::move(bytes)) {}

  const std::string& Path() const override { return path_; }
  std::uint64_t Size_bytes() const override { return bytes_.Size_bytes(); }
  absl::Status Read(std::uint64_t offset, std::span<std::byte> to) const override {
    const std::uint64_t size_bytes = bytes_.Size_bytes();
    if (offset > size_bytes || to.size() > size_bytes - offset) {
      return absl::DataLossError(absl::StrCat(path_, ": its decompressed contents end at byte ",
                                              size_bytes, "; copy the file again"));
    }
    bytes_.Copy(offset, to);
    return absl::OkStatus();
  }

 private:
  const std::string path_;
  const Blocks bytes_;
};

// The outcome of a step of a decompressor.
enum class Step { kContinues, kEnded, kDamaged };

// A decompressor of one library. Both libraries have the same kind of interface.
class Bz2 {
 public:
  static constexpr const char* kName = "bz2";
  static constexpr const char* kProgram = "bunzip2";

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
  static constexpr const char* kProgram = "gunzip";

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

  absl::StatusOr<Blocks> Run() {
    THUNDERHEAD_RETURN_IF_ERROR(Fill());
    // A file can have several streams, one after another.
    while (!input_.empty()) THUNDERHEAD_RETURN_IF_ERROR(RunStream());
    THUNDERHEAD_RETURN_IF_ERROR(CheckStart());
    contents_.ShrinkToFit();
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
    for (Step step = Step::kContinues; step != Step::kEnded;) {
      THUNDERHEAD_RETURN_IF_ERROR(Fill());
      const bool at_end = input_.empty();
      const std::span<std::byte> room = contents_.Room();
      std::span<std::byte> left = room;
      step = library.Run(input_, left);
      const std::size_t made = room.size() - left.size();
      if (step == Step::kDamaged) return Damaged("is damaged");
      if (step == Step::kContinues && at_end && made == 0) return Damaged("ends early");
      contents_.Use(made);
      THUNDERHEAD_RETURN_IF_ERROR(Check());
    }
    return Fill();
  }

  // Checks the bytes that have been decompressed so far. A file that is too large, or is no GRIB
  // file, is thus refused before more of it is decompressed.
  absl::Status Check() const {
    if (contents_.Size_bytes() > most_bytes_) {
      return absl::FailedPreconditionError(
          absl::StrCat(file_.Path(), ": the ", Library::kName, " file of ", file_.Size_bytes(),
                       " bytes holds more than ", most_bytes_,
                       " bytes, the most for its size; decompress it with ", Library::kProgram,
                       " first, or split it"));
    }
    return contents_.Size_bytes() < kStart_bytes ? absl::OkStatus() : CheckStart();
  }

  absl::Status CheckStart() const {
    if (BeginsLikeGrib(contents_.Start(kStart_bytes))) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat(file_.Path(), ": is a ", Library::kName,
                     " file without a GRIB message; decompress it, or give a GRIB2 file"));
  }

  absl::Status Damaged(std::string_view what) const {
    return absl::DataLossError(absl::StrCat(file_.Path(), ": the ", Library::kName, " file ",
                                            std::string(what), "; copy it again"));
  }

  static constexpr std::size_t kStart_bytes = 4096;

  const base::ByteSource& file_;
  const std::uint64_t most_bytes_;
  std::uint64_t at_ = 0;  // offset of the next byte to read
  Bytes buffer_;
  std::span<std::byte> input_;
  Blocks contents_;
};

bool IsBz2(std::string_view start) {
  return start.size() >= 4 && start.substr(0, 3) == "BZh" && start[3] >= '1' && start[3] <= '9';
}

bool IsGz(std::string_view start) { return start.substr(0, 2) == "\x1f\x8b"; }

}  // namespace

std::uint64_t MaxDecompressed_bytes(std::uint64_t compressed_bytes) {
  constexpr std::uint64_t kLeast_bytes = std::uint64_t{64} << 20;
  constexpr std::uint64_t kPerByte = 100;
  const std::uint64_t by_size =
      kLeast_bytes + kPerByte * std::min(compressed_bytes, kMaxDecompressed_bytes);
  return std::min(by_size, kMaxDecompressed_bytes);
}

bool BeginsCompressed(std::string_view start) { return IsBz2(start) || IsGz(start); }

absl::StatusOr<std::shared_ptr<const base::ByteSource>> Decompressed(
    std::shared_ptr<const base::ByteSource> file, std::uint64_t most_bytes) {
  std::array<char, 4> bytes{};
  const std::size_t count = std::min<std::uint64_t>(bytes.size(), file->Size_bytes());
  THUNDERHEAD_RETURN_IF_ERROR(file->Read(0, std::as_writable_bytes(std::span(bytes)).first(count)));
  const std::string_view start(bytes.data(), count);
  if (!BeginsCompressed(start)) return file;
  most_bytes = std::min(most_bytes, MaxDecompressed_bytes(file->Size_bytes()));
  Blocks contents;
  if (IsBz2(start)) {
    THUNDERHEAD_ASSIGN_OR_RETURN(contents, Decompressor<Bz2>(*file, most_bytes).Run());
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(contents, Decompressor<Gz>(*file, most_bytes).Run());
  }
  return std::make_shared<DecompressedBytes>(file->Path(), std::move(contents));
}

}  // namespace thunderhead::grib
