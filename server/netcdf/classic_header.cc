#include "netcdf/classic_header.h"

#include <netcdf.h>

#include <array>
#include <cstdint>
#include <limits>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::netcdf {
namespace {

constexpr std::uint64_t kTagBytes = 4;

// The size in bytes of a value of each type. The index is netCDF's number of the type, from NC_BYTE
// (1) to NC_UINT64 (11).
constexpr std::array<std::uint64_t, 12> kTypeBytes = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};

absl::Status Damaged(const std::string& what) {
  return absl::DataLossError(
      absl::StrCat("its header ", what, "; the file is damaged: copy it again"));
}

class Header {
 public:
  Header(std::istream& file, char version)
      : file_(file), count_bytes_(version == 5 ? 8 : 4), offset_bytes_(version == 1 ? 4 : 8) {}

  absl::Status Check() {
    Number(count_bytes_);  // records
    THUNDERHEAD_RETURN_IF_ERROR(CheckList([this] { return CheckDimension(); }));
    THUNDERHEAD_RETURN_IF_ERROR(CheckAttributes());
    return CheckList([this] { return CheckVariable(); });
  }

 private:
  // Reads a big-endian number. Returns 0 past the end of the file.
  std::uint64_t Number(std::uint64_t bytes) {
    std::uint64_t number = 0;
    for (std::uint64_t i = 0; i < bytes; ++i) {
      const int byte = file_.get();
      number = number << 8U | (file_ ? static_cast<std::uint64_t>(byte) : 0U);
    }
    return file_ ? number : 0;
  }

  // Skips `count` values of `bytes` each. A damaged header can specify more values than any file
  // can hold.
  void Skip(std::uint64_t count, std::uint64_t bytes) {
    constexpr std::uint64_t kMax = std::numeric_limits<std::streamsize>::max() / 2;
    std::uint64_t all = 0;
    if (__builtin_mul_overflow(count, bytes, &all) || all > kMax) {
      file_.setstate(std::ios::failbit);
      return;
    }
    const auto padded = static_cast<std::streamsize>((all + 3) / 4 * 4);
    if (file_.ignore(padded).gcount() < padded) file_.setstate(std::ios::failbit);
  }

  template <typename CheckEntry>
  absl::Status CheckList(const CheckEntry& check) {
    Number(kTagBytes);
    const std::uint64_t count = Number(count_bytes_);
    for (std::uint64_t i = 0; i < count && file_; ++i) THUNDERHEAD_RETURN_IF_ERROR(check());
    return file_ ? absl::OkStatus() : Damaged("ends before its last entry");
  }

  absl::Status CheckName(const char* of) {
    const std::uint64_t length = Number(count_bytes_);
    if (length > NC_MAX_NAME) {
      return Damaged(absl::StrCat("has a name of ", length, " bytes for ", of,
                                  ", where netCDF allows ", NC_MAX_NAME));
    }
    Skip(length, 1);
    return absl::OkStatus();
  }

  absl::Status CheckDimension() {
    THUNDERHEAD_RETURN_IF_ERROR(CheckName("a dimension"));
    Number(count_bytes_);
    return absl::OkStatus();
  }

  absl::Status CheckAttribute() {
    THUNDERHEAD_RETURN_IF_ERROR(CheckName("an attribute"));
    const std::uint64_t type = Number(kTagBytes);
    const std::uint64_t count = Number(count_bytes_);
    if (type >= kTypeBytes.size()) {
      return Damaged(absl::StrCat("has an attribute of the unknown type ", type));
    }
    Skip(count, kTypeBytes[type]);
    return absl::OkStatus();
  }

  absl::Status CheckAttributes() {
    return CheckList([this] { return CheckAttribute(); });
  }

  absl::Status CheckVariable() {
    THUNDERHEAD_RETURN_IF_ERROR(CheckName("a variable"));
    const std::uint64_t rank = Number(count_bytes_);
    if (rank > NC_MAX_VAR_DIMS) {
      return Damaged(absl::StrCat("has a variable of ", rank, " dimensions, where netCDF allows ",
                                  NC_MAX_VAR_DIMS));
    }
    Skip(rank, count_bytes_);
    THUNDERHEAD_RETURN_IF_ERROR(CheckAttributes());
    Number(kTagBytes);  // type
    Number(count_bytes_);
    Number(offset_bytes_);
    return absl::OkStatus();
  }

  std::istream& file_;
  const std::uint64_t count_bytes_;
  const std::uint64_t offset_bytes_;
};

}  // namespace

absl::Status CheckClassicHeader(std::istream& file) {
  std::array<char, 4> magic{};
  if (!file.read(magic.data(), magic.size())) return absl::OkStatus();
  const char version = magic[3];
  const bool is_classic = magic[0] == 'C' && magic[1] == 'D' && magic[2] == 'F' &&
                          (version == 1 || version == 2 || version == 5);
  return is_classic ? Header(file, version).Check() : absl::OkStatus();
}

}  // namespace thunderhead::netcdf
