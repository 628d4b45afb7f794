#include "grib/packing_check.h"

#include <algorithm>
#include <bit>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "grib/octets.h"

namespace thunderhead::grib {
namespace {

constexpr std::size_t kHeaderBytes = 5;

absl::Status BadData(std::string_view what) {
  return absl::DataLossError(
      absl::StrCat("its packed data ", std::string(what), "; the file is damaged: copy it again"));
}

// Reads numbers of up to 32 bits, the most significant bit first.
class Bits {
 public:
  explicit Bits(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool Has(std::uint64_t bits) const { return bits <= 8 * bytes_.size() - at_; }

  // The caller has checked that `bits` (at most 32) are left.
  std::uint64_t Next(std::uint64_t bits) {
    std::uint64_t number = 0;
    for (std::uint64_t left = bits; left > 0;) {
      const std::uint64_t in_byte = 8 - at_ % 8;
      const std::uint64_t take = std::min(in_byte, left);
      const auto byte = std::to_integer<std::uint64_t>(bytes_[at_ / 8]);
      number = number << take | (byte >> (in_byte - take) & ((std::uint64_t{1} << take) - 1));
      at_ += take;
      left -= take;
    }
    return number;
  }

  void SkipToByte() { at_ = (at_ + 7) / 8 * 8; }

  // The caller has checked that `bits` are left.
  void Skip(std::uint64_t bits) { at_ += bits; }

  std::uint64_t Left() const { return 8 * bytes_.size() - at_; }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t at_ = 0;
};

absl::Status CheckBitmap(const PackedField& field, std::uint64_t values) {
  if (field.bitmap.empty()) {
    if (values == field.points) return absl::OkStatus();
    return BadData(absl::StrCat("have ", values, " values for ", field.points, " points"));
  }
  constexpr std::size_t kBitmapBegin = 6;
  const std::span<const std::byte> bits =
      field.bitmap.subspan(std::min(kBitmapBegin, field.bitmap.size()));
  if (bits.size() < (field.points + 7) / 8) {
    return BadData(
        absl::StrCat("have a bitmap of ", bits.size(), " bytes for ", field.points, " points"));
  }
  std::uint64_t set = 0;
  for (std::uint64_t i = 0; i < field.points / 8; ++i) {
    set += static_cast<std::uint64_t>(std::popcount(std::to_integer<unsigned>(bits[i])));
  }
  if (const std::uint64_t rest = field.points % 8; rest > 0) {
    const auto last = std::to_integer<unsigned>(bits[field.points / 8]);
    set += static_cast<std::uint64_t>(std::popcount(last >> (8 - rest)));
  }
  if (set == values) return absl::OkStatus();
  return BadData(absl::StrCat("have ", values, " values where the bitmap has ", set));
}

absl::Status CheckSimple(const Octets& section5, std::uint64_t values, std::uint64_t data_bytes) {
  const std::uint64_t bits = section5.Unsigned(20, 1);
  if (bits > 64) return BadData(absl::StrCat("have values of ", bits, " bits"));
  if (values * bits <= 8 * data_bytes) return absl::OkStatus();
  return BadData(
      absl::StrCat("have ", data_bytes, " bytes for ", values, " values of ", bits, " bits"));
}

// Checks the lengths and widths of groups, which templates 7.2 and 7.3 of the manual on codes
// define.
absl::Status CheckGroups(const Octets& section5, std::uint64_t values,
                         std::span<const std::byte> data, bool differences) {
  const std::uint64_t reference_bits = section5.Unsigned(20, 1);
  const std::uint64_t groups = section5.Unsigned(32, 4);
  const std::uint64_t least_width = section5.Unsigned(36, 1);
  const std::uint64_t width_bits = section5.Unsigned(37, 1);
  const std::uint64_t least_length = section5.Unsigned(38, 4);
  const std::uint64_t length_step = section5.Unsigned(42, 1);
  const std::uint64_t last_length = section5.Unsigned(43, 4);
  const std::uint64_t length_bits = section5.Unsigned(47, 1);
  Bits bits(data);
  if (differences) {
    const std::uint64_t order = section5.Unsigned(48, 1);
    const std::uint64_t octets = section5.Unsigned(49, 1);
    if ((order < 1 && groups > 0) || order > 2 || octets > 4) {
      return BadData(absl::StrCat("have differences of order ", order, " in ", octets, " bytes"));
    }
    if (values < order) return BadData("have fewer values than the order of their differences");
    const std::uint64_t extra = 8 * octets * (order + 1);
    if (!bits.Has(extra)) return BadData("end before their groups");
    bits.Skip(extra);
  }
  // A field with one value everywhere has no groups.
  if (groups == 0) return absl::OkStatus();
  constexpr std::uint64_t kMostBits = 32;
  if (groups > values || std::max({reference_bits, width_bits, length_bits}) > kMostBits) {
    return BadData(absl::StrCat("have ", groups, " groups for ", values, " values"));
  }
  const std::uint64_t lists = (groups * reference_bits + 7) / 8 + (groups * width_bits + 7) / 8 +
                              (groups * length_bits + 7) / 8;
  if (!bits.Has(8 * lists)) return BadData("end before their groups");
  bits.Skip((groups * reference_bits + 7) / 8 * 8);
  Bits lengths = bits;
  lengths.Skip((groups * width_bits + 7) / 8 * 8);
  std::uint64_t all_values = 0;
  std::uint64_t all_bits = 0;
  for (std::uint64_t group = 0; group < groups; ++group) {
    const std::uint64_t width = least_width + bits.Next(width_bits);
    const std::uint64_t scaled = lengths.Next(length_bits);
    const std::uint64_t length =
        group + 1 < groups ? least_length + scaled * length_step : last_length;
    if (width > kMostBits) return BadData(absl::StrCat("have a group of ", width, " bits"));
    all_values += length;
    if (all_values > values) break;
    all_bits += length * width;
  }
  if (all_values != values) {
    return BadData(absl::StrCat("have groups for ", all_values > values ? "more" : "fewer",
                                " values than the ", values, " announced"));
  }
  lengths.SkipToByte();
  if (lengths.Has(all_bits)) return absl::OkStatus();
  return BadData("end before their last group");
}

// Checks the groups of ecCodes' own packing by second order differences.
absl::Status CheckSecondOrder(const Octets& section5, std::uint64_t values,
                              std::span<const std::byte> data) {
  const std::uint64_t reference_bits = section5.Unsigned(21, 1);
  const std::uint64_t groups = section5.Unsigned(22, 4);
  const std::uint64_t in_groups = section5.Unsigned(26, 4);
  const std::uint64_t width_bits = section5.Unsigned(30, 1);
  const std::uint64_t length_bits = section5.Unsigned(31, 1);
  const std::uint64_t order = section5.Unsigned(33, 1);
  constexpr std::uint64_t kMostBits = 32;
  constexpr std::uint64_t kMostOrder = 3;
  if (groups > values || order > kMostOrder || order > values ||
      std::max({reference_bits, width_bits, length_bits, section5.Unsigned(20, 1)}) > kMostBits) {
    return BadData(absl::StrCat("have ", groups, " groups for ", values, " values"));
  }
  if (order > 0) {
    const std::uint64_t bits = section5.Unsigned(34, 1);
    if (bits > kMostBits || section5.Count() < 34 + (bits * (order + 1) + 7) / 8) {
      return BadData("have a section 5 that is too short");
    }
  }
  const std::uint64_t width_bytes = (groups * width_bits + 7) / 8;
  const std::uint64_t length_bytes = (groups * length_bits + 7) / 8;
  const std::uint64_t reference_bytes = (groups * reference_bits + 7) / 8;
  if (width_bytes + length_bytes + reference_bytes > data.size()) {
    return BadData("end before their groups");
  }
  Bits widths(data);
  Bits lengths(data.subspan(width_bytes));
  std::uint64_t all_values = order;
  std::uint64_t all_bits = 0;
  for (std::uint64_t group = 0; group < groups && all_values <= values; ++group) {
    const std::uint64_t width = widths.Next(width_bits);
    const std::uint64_t length = lengths.Next(length_bits);
    if (width > kMostBits) return BadData(absl::StrCat("have a group of ", width, " bits"));
    all_values += length;
    all_bits += width * length;
  }
  if (all_values != values || in_groups + order != values) {
    return BadData(
        absl::StrCat("have groups for another number of values than the ", values, " announced"));
  }
  const std::uint64_t left = data.size() - width_bytes - length_bytes - reference_bytes;
  if (all_bits <= 8 * left) return absl::OkStatus();
  return BadData("end before their last group");
}

// Checks the image that holds the values. `width` and `height` come from its header.
absl::Status CheckImage(std::string_view kind, std::uint64_t width, std::uint64_t height,
                        std::uint64_t values) {
  if (width > 0 && height > 0 && width <= values && width * height == values) {
    return absl::OkStatus();
  }
  return BadData(absl::StrCat("are a ", std::string(kind), " image of ", width, " x ", height,
                              " for ", values, " values"));
}

absl::Status CheckJpeg2000(const Octets& section5, std::uint64_t values, const Octets& image) {
  if (section5.Unsigned(20, 1) == 0) return absl::OkStatus();  // one value everywhere
  constexpr std::uint64_t kStartAndSize = 0xFF4FFF51;
  if (image.Count() < 42 || image.Unsigned(1, 4) != kStartAndSize) {
    return BadData("are no JPEG 2000 codestream");
  }
  const std::uint64_t right = image.Unsigned(9, 4);
  const std::uint64_t bottom = image.Unsigned(13, 4);
  const std::uint64_t left = image.Unsigned(17, 4);
  const std::uint64_t top = image.Unsigned(21, 4);
  if (left >= right || top >= bottom || image.Unsigned(41, 2) != 1) {
    return BadData("are a JPEG 2000 image without one component");
  }
  return CheckImage("JPEG 2000", right - left, bottom - top, values);
}

absl::Status CheckPng(const Octets& section5, std::uint64_t values, const Octets& image) {
  if (section5.Unsigned(20, 1) == 0) return absl::OkStatus();  // one value everywhere
  constexpr std::uint64_t kSignature = 0x89504E470D0A1A0A;
  constexpr std::uint64_t kHeader = 0x49484452;  // IHDR
  if (image.Count() < 26 || image.Unsigned(1, 8) != kSignature ||
      image.Unsigned(13, 4) != kHeader) {
    return BadData("are no PNG image");
  }
  return CheckImage("PNG", image.Unsigned(17, 4), image.Unsigned(21, 4), values);
}

absl::Status CheckCcsds(const Octets& section5) {
  const std::uint64_t bits = section5.Unsigned(20, 1);
  const std::uint64_t block = section5.Unsigned(23, 1);
  const std::uint64_t interval = section5.Unsigned(24, 2);
  const bool is_known_block = block == 8 || block == 16 || block == 32 || block == 64;
  if (bits <= 32 && (bits == 0 || (is_known_block && interval >= 1 && interval <= 4096))) {
    return absl::OkStatus();
  }
  return BadData(absl::StrCat("have CCSDS blocks of ", block, " values of ", bits, " bits"));
}

std::size_t LeastOctets(Packing packing) {
  switch (packing) {
    case Packing::kSimple:
    case Packing::kPng:
      return 21;
    case Packing::kComplex:
      return 47;
    case Packing::kSpatialDifferencing:
      return 49;
    case Packing::kIeee:
      return 12;
    case Packing::kJpeg2000:
      return 23;
    case Packing::kCcsds:
      return 25;
    case Packing::kSecondOrder:
      return 33;
  }
  return 0;
}

}  // namespace

absl::StatusOr<Packing> PackingOf(std::span<const std::byte> packing) {
  const auto number = static_cast<int>(Octets(packing).Unsigned(10, 2));
  for (const Packing known :
       {Packing::kSimple, Packing::kComplex, Packing::kSpatialDifferencing, Packing::kIeee,
        Packing::kJpeg2000, Packing::kPng, Packing::kCcsds, Packing::kSecondOrder}) {
    if (static_cast<int>(known) == number) return known;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("is packed by template 5.", number,
                   ", which is not read; repack it, for example with grib_set -r -w "
                   "packingType=grid_simple"));
}

absl::Status CheckPacked(const PackedField& field) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Packing packing, PackingOf(field.packing));
  const Octets section5(field.packing);
  if (section5.Count() < LeastOctets(packing)) return BadData("have a section 5 that is too short");
  if (field.data.size() < kHeaderBytes) return BadData("have a section 7 that is too short");
  const std::uint64_t values = section5.Unsigned(6, 4);
  THUNDERHEAD_RETURN_IF_ERROR(CheckBitmap(field, values));
  const std::span<const std::byte> data = field.data.subspan(kHeaderBytes);
  switch (packing) {
    case Packing::kSimple:
      return CheckSimple(section5, values, data.size());
    case Packing::kComplex:
    case Packing::kSpatialDifferencing:
      return CheckGroups(section5, values, data, packing == Packing::kSpatialDifferencing);
    case Packing::kIeee: {
      const std::uint64_t bytes_each = section5.Unsigned(12, 1) == 2 ? 8 : 4;
      if (values * bytes_each <= data.size()) return absl::OkStatus();
      return BadData("end before their last value");
    }
    case Packing::kJpeg2000:
      return CheckJpeg2000(section5, values, Octets(data));
    case Packing::kPng:
      return CheckPng(section5, values, Octets(data));
    case Packing::kCcsds:
      return CheckCcsds(section5);
    case Packing::kSecondOrder:
      return CheckSecondOrder(section5, values, data);
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::grib
