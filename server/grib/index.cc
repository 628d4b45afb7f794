#include "grib/index.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/civil_time.h"
#include "base/status.h"
#include "grib/octets.h"

namespace thunderhead::grib {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uint64_t kIndicatorBytes = 16;     // section 0
constexpr std::uint64_t kEndBytes = 4;            // section 8
constexpr std::uint64_t kSectionHeaderBytes = 5;  // length and number
constexpr std::string_view kStart = "GRIB";
constexpr std::string_view kEnd = "7777";
// A bulletin's header before the first message is shorter than this.
constexpr std::size_t kLongestPreamble = 256;
// Maximum length of sections 1, 3, 4 and 5, which are read whole. The longest are those with lists
// of coordinates.
constexpr std::uint64_t kLongestHeader = 1 << 20;

// Reads a file in order, with few calls.
class Window {
 public:
  explicit Window(const base::ByteSource& file) : file_(file) {}

  std::uint64_t Size() const { return file_.Size_bytes(); }

  // Returns `count` bytes at `offset`, or fewer at the end of the file. They are valid until the
  // next call.
  absl::StatusOr<std::span<const std::byte>> At(std::uint64_t offset, std::uint64_t count) {
    if (offset >= Size()) return std::span<const std::byte>();
    count = std::min(count, Size() - offset);
    if (offset < begin_ || offset + count > begin_ + bytes_.size()) {
      constexpr std::uint64_t kAhead = 2048;
      bytes_.resize(std::min(std::max(count, kAhead), Size() - offset));
      begin_ = offset;
      if (absl::Status read = file_.Read(offset, bytes_); !read.ok()) {
        bytes_.clear();
        return read;
      }
    }
    return std::span<const std::byte>(bytes_).subspan(offset - begin_, count);
  }

 private:
  const base::ByteSource& file_;
  std::uint64_t begin_ = 0;
  Bytes bytes_;
};

bool Holds(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

// Returns the length of a unit of time (code table 4.4), or nothing for units whose length varies.
std::optional<absl::Duration> UnitOfTime(std::uint64_t unit) {
  switch (unit) {
    case 0:
      return absl::Minutes(1);
    case 1:
      return absl::Hours(1);
    case 2:
      return absl::Hours(24);
    case 10:
      return absl::Hours(3);
    case 11:
      return absl::Hours(6);
    case 12:
      return absl::Hours(12);
    case 13:
      return absl::Seconds(1);
    default:
      return std::nullopt;
  }
}

float IeeeFloat(std::uint64_t bits) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
}

class Reader {
 public:
  explicit Reader(const base::ByteSource& file) : file_(file), window_(file) {}

  absl::StatusOr<Index> Read();

 private:
  absl::StatusOr<std::optional<std::uint64_t>> NextStart(std::uint64_t from);
  absl::StatusOr<std::uint64_t> ReadMessage();
  absl::Status ReadSection(int number, Extent extent, std::uint64_t message_end);
  absl::Status ReadIdentification(Octets section);
  absl::Status ReadGridSection(Octets section);
  absl::Status ReadProduct(Octets section);
  absl::Status ReadVertical(Octets section, std::uint64_t numbers);
  absl::Status ReadPacking(Octets section);
  absl::Status ReadBitmap(Octets section, Extent extent);

  absl::Status Damaged(std::string_view what) const {
    return absl::DataLossError(absl::StrCat(file_.Path(), ": the GRIB message at byte ",
                                            message_offset_, " ", std::string(what),
                                            "; the file is damaged: copy it again"));
  }
  absl::Status CutShort(std::uint64_t length) const {
    return absl::DataLossError(absl::StrCat(
        file_.Path(), ": ends at byte ", window_.Size(), " within the GRIB message at byte ",
        message_offset_, " of at least ", length, " bytes; it was cut short: copy it again"));
  }
  absl::Status Refused(std::string_view what) const {
    return absl::InvalidArgumentError(absl::StrCat(file_.Path(), ": the GRIB message at byte ",
                                                   message_offset_, " ", std::string(what)));
  }

  const base::ByteSource& file_;
  Window window_;
  Index index_;
  std::uint64_t message_offset_ = 0;
  Field field_;  // what the message's sections have said so far
  int last_section_ = 0;
  std::optional<Extent> last_bitmap_;
  std::shared_ptr<const Bytes> last_grid_;
  std::shared_ptr<const VerticalCoordinate> last_vertical_;
};

absl::StatusOr<std::optional<std::uint64_t>> Reader::NextStart(std::uint64_t from) {
  constexpr std::uint64_t kStep = 64 << 10;
  for (std::uint64_t at = from; at + kStart.size() <= window_.Size();) {
    // In a file without anything between messages, the next message begins at `from`, so only a few
    // bytes are read at first.
    const std::uint64_t count = at == from ? kStart.size() : kStep;
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::span<const std::byte> bytes, window_.At(at, count));
    const auto* const begin = reinterpret_cast<const char*>(bytes.data());
    const std::size_t found = std::string_view(begin, bytes.size()).find(kStart);
    if (found != std::string_view::npos) return at + found;
    at += at == from ? 1 : std::max<std::uint64_t>(bytes.size(), kStart.size()) - kStart.size() + 1;
  }
  return std::nullopt;
}

absl::Status Reader::ReadIdentification(Octets section) {
  if (section.Count() < 21) return Damaged("has a section 1 that is too short");
  Origin& origin = field_.origin;
  origin.centre = static_cast<int>(section.Unsigned(6, 2));
  origin.subcentre = static_cast<int>(section.Unsigned(8, 2));
  const auto part = [&](std::size_t octet) { return section.Unsigned(octet, 1); };
  const absl::CivilSecond given(static_cast<std::int64_t>(section.Unsigned(13, 2)),
                                static_cast<int>(part(15)), static_cast<int>(part(16)),
                                static_cast<int>(part(17)), static_cast<int>(part(18)),
                                static_cast<int>(part(19)));
  // CivilSecond turns a date that does not exist into another date. If month or day have changed,
  // the date is therefore wrong.
  if (given.month() != static_cast<int>(part(15)) || given.day() != static_cast<int>(part(16)) ||
      part(17) > 23 || part(18) > 59 || part(19) > 59) {
    return Damaged(absl::StrCat("has the reference time ", section.Unsigned(13, 2), "-", part(15),
                                "-", part(16), " ", part(17), ":", part(18), ":", part(19),
                                ", which does not exist"));
  }
  origin.reference = absl::FromCivil(given, absl::UTCTimeZone());
  return absl::OkStatus();
}

absl::Status Reader::ReadGridSection(Octets section) {
  if (section.Count() < 14) return Damaged("has a section 3 that is too short");
  field_.points = section.Unsigned(7, 4);
  if (last_grid_ == nullptr || !std::ranges::equal(*last_grid_, section.Bytes())) {
    last_grid_ = std::make_shared<Bytes>(section.Bytes().begin(), section.Bytes().end());
  }
  field_.grid = last_grid_;
  return absl::OkStatus();
}

absl::Status Reader::ReadVertical(Octets section, std::uint64_t numbers) {
  field_.vertical = nullptr;
  if (numbers == 0) return absl::OkStatus();
  const std::uint64_t bytes = 4 * numbers;
  if (bytes + 9 > section.Count()) return Damaged("has fewer vertical coordinates than announced");
  const std::size_t first = section.Count() - bytes + 1;
  VerticalCoordinate vertical;
  constexpr int kGeneralized = 150;
  constexpr int kGeneralizedNumbers = 6;  // levels, number of the grid, and 16 octets of its id
  if (field_.first.type == kGeneralized && numbers == kGeneralizedNumbers) {
    vertical.has_grid_id = true;
    for (std::size_t i = 0; i < vertical.grid_id.size(); ++i) {
      vertical.grid_id[i] = static_cast<std::uint8_t>(section.Unsigned(first + 8 + i, 1));
    }
  } else {
    for (std::uint64_t i = 0; i < numbers; ++i) {
      vertical.numbers.push_back(IeeeFloat(section.Unsigned(first + 4 * i, 4)));
    }
  }
  if (last_vertical_ == nullptr || *last_vertical_ != vertical) {
    last_vertical_ = std::make_shared<VerticalCoordinate>(std::move(vertical));
  }
  field_.vertical = last_vertical_;
  return absl::OkStatus();
}

absl::Status Reader::ReadProduct(Octets section) {
  if (section.Count() < 9) return Damaged("has a section 4 that is too short");
  field_.product = static_cast<int>(section.Unsigned(8, 2));
  field_.is_instant = false;
  field_.member.reset();
  field_.first = {};
  field_.second = {};
  // In all these templates the octets 10 to 34 have the same meaning.
  constexpr std::array kWithSurfaces = {0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 15};
  constexpr std::size_t kWithSurfacesOctets = 34;
  if (std::ranges::find(kWithSurfaces, field_.product) == kWithSurfaces.end()) {
    return absl::OkStatus();
  }
  if (section.Count() < kWithSurfacesOctets) return Damaged("has a section 4 that is too short");
  field_.parameter.category = static_cast<int>(section.Unsigned(10, 1));
  field_.parameter.number = static_cast<int>(section.Unsigned(11, 1));
  field_.process = static_cast<int>(section.Unsigned(14, 1));
  field_.first = {static_cast<int>(section.Unsigned(23, 1)), section.Scaled(24, 4)};
  field_.second = {static_cast<int>(section.Unsigned(29, 1)), section.Scaled(30, 4)};
  const std::optional<absl::Duration> unit = UnitOfTime(section.Unsigned(18, 1));
  const bool is_instant = field_.product == 0 || field_.product == 1;
  field_.is_instant = is_instant && unit.has_value();
  field_.unknown_unit.reset();
  if (is_instant && !unit.has_value()) {
    field_.unknown_unit = static_cast<int>(section.Unsigned(18, 1));
  }
  if (unit.has_value()) field_.forecast = static_cast<double>(section.Signed(19, 4)) * *unit;
  if (field_.product == 1 || field_.product == 11) {
    if (section.Count() < 37) return Damaged("has a section 4 that is too short");
    field_.member = static_cast<int>(section.Unsigned(36, 1));
  }
  return ReadVertical(section, section.Unsigned(6, 2));
}

absl::Status Reader::ReadPacking(Octets section) {
  if (section.Count() < 11) return Damaged("has a section 5 that is too short");
  field_.values = section.Unsigned(6, 4);
  field_.packing = static_cast<int>(section.Unsigned(10, 2));
  return absl::OkStatus();
}

absl::Status Reader::ReadBitmap(Octets section, Extent extent) {
  constexpr std::uint64_t kOwn = 0;
  constexpr std::uint64_t kPrevious = 254;
  constexpr std::uint64_t kNone = 255;
  if (section.Count() < 6) return Damaged("has a section 6 that is too short");
  const std::uint64_t indicator = section.Unsigned(6, 1);
  if (indicator == kOwn) {
    last_bitmap_ = extent;
    field_.bitmap_section = extent;
  } else if (indicator == kPrevious) {
    if (!last_bitmap_.has_value()) return Damaged("refers to an earlier bitmap, and there is none");
    field_.bitmap_section = last_bitmap_;
  } else if (indicator == kNone) {
    field_.bitmap_section.reset();
  } else {
    return Refused(absl::StrCat("uses the centre's bitmap ", indicator,
                                ", which is not in the file; write the bitmap into the file"));
  }
  return absl::OkStatus();
}

absl::Status Reader::ReadSection(int number, Extent extent, std::uint64_t message_end) {
  if (extent.size_bytes < kSectionHeaderBytes ||
      extent.size_bytes > message_end - kEndBytes - extent.offset) {
    return Damaged(absl::StrCat("has a section ", number, " of ", extent.size_bytes,
                                " bytes, which does not fit into it"));
  }
  // Within a message, sections 2 to 7, 3 to 7 and 4 to 7 may be repeated.
  const bool is_next = number == last_section_ + 1 || (number == 3 && last_section_ == 1);
  const bool repeats = last_section_ == 7 && number >= 2 && number <= 4;
  if (!is_next && !repeats) {
    return Damaged(absl::StrCat("has section ", number, " after section ", last_section_));
  }
  last_section_ = number;
  const bool is_header = number == 1 || number == 3 || number == 4 || number == 5;
  constexpr std::uint64_t kIndicatorOfBitmap = 6;
  if (is_header && extent.size_bytes > kLongestHeader) {
    return Refused(absl::StrCat("has a section ", number, " of ", extent.size_bytes,
                                " bytes, which is a kind of grid or product that is not read"));
  }
  if (is_header || number == 6) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::span<const std::byte> bytes,
        window_.At(extent.offset, is_header ? extent.size_bytes
                                            : std::min(extent.size_bytes, kIndicatorOfBitmap)));
    const Octets section(bytes);
    switch (number) {
      case 1:
        return ReadIdentification(section);
      case 3:
        return ReadGridSection(section);
      case 4:
        return ReadProduct(section);
      case 5:
        field_.packing_section = extent;
        return ReadPacking(section);
      default:
        return ReadBitmap(section, extent);
    }
  }
  if (number == 7) {
    field_.data_section = extent;
    if (index_.fields.size() >= kMaxFields) {
      return absl::InvalidArgumentError(absl::StrCat(file_.Path(), ": has more than ", kMaxFields,
                                                     " fields, which are the most; split it"));
    }
    index_.fields.push_back(field_);
  }
  return absl::OkStatus();
}

// Reads the message at message_offset_ and returns where it ends.
absl::StatusOr<std::uint64_t> Reader::ReadMessage() {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::span<const std::byte> bytes,
                               window_.At(message_offset_, kIndicatorBytes));
  const Octets indicator(bytes);
  const std::uint64_t edition = indicator.Unsigned(8, 1);
  if (bytes.size() < kIndicatorBytes) return CutShort(kIndicatorBytes);
  if (edition != 2) {
    return Refused(absl::StrCat("is of GRIB edition ", edition,
                                ", and only edition 2 is read; convert the file, for example with "
                                "grib_set -s edition=2"));
  }
  field_ = {};
  field_.message_offset = message_offset_;
  field_.parameter.discipline = static_cast<int>(indicator.Unsigned(7, 1));
  last_section_ = 0;
  last_bitmap_.reset();
  const std::uint64_t length = indicator.Unsigned(9, 8);
  if (length > window_.Size() - message_offset_) return CutShort(length);
  if (length < kIndicatorBytes + kEndBytes) return Damaged("is too short");
  const std::uint64_t end = message_offset_ + length;
  std::uint64_t at = message_offset_ + kIndicatorBytes;
  while (at + kEndBytes < end) {
    THUNDERHEAD_ASSIGN_OR_RETURN(bytes, window_.At(at, kSectionHeaderBytes));
    const Octets header(bytes);
    const Extent extent{at, header.Unsigned(1, 4)};
    THUNDERHEAD_RETURN_IF_ERROR(ReadSection(static_cast<int>(header.Unsigned(5, 1)), extent, end));
    at += extent.size_bytes;
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(bytes, window_.At(at, kEndBytes));
  if (at + kEndBytes != end || !Holds(bytes, kEnd)) return Damaged("does not end with 7777");
  if (last_section_ != 7) return Damaged(absl::StrCat("ends after section ", last_section_));
  return end;
}

absl::StatusOr<Index> Reader::Read() {
  index_.path = file_.Path();
  std::uint64_t at = 0;
  while (true) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<std::uint64_t> start, NextStart(at));
    if (!start.has_value()) break;
    message_offset_ = *start;
    THUNDERHEAD_ASSIGN_OR_RETURN(at, ReadMessage());
  }
  if (!index_.fields.empty()) return std::move(index_);
  return absl::InvalidArgumentError(
      absl::StrCat(file_.Path(), ": has no GRIB message; give a GRIB2 file"));
}

}  // namespace

std::string NumbersOf(const Parameter& parameter) {
  return absl::StrCat(parameter.discipline, "/", parameter.category, "/", parameter.number);
}

bool BeginsLikeGrib(std::string_view start) {
  constexpr std::size_t kEditionAt = 7;    // bytes after the start of a message
  constexpr unsigned char kFirstText = 8;  // control characters below this do not occur in a text
  const std::size_t last = std::min(start.size(), kLongestPreamble);
  for (std::size_t at = start.find(kStart); at < last; at = start.find(kStart, at + 1)) {
    if (at + kEditionAt >= start.size()) return false;
    // A text that is no GRIB file may also contain the word GRIB. It then has a character at the
    // place of the edition, and not a small number.
    if (static_cast<unsigned char>(start[at + kEditionAt]) < kFirstText) return true;
  }
  return false;
}

absl::StatusOr<Index> ReadIndex(const base::ByteSource& file) { return Reader(file).Read(); }

}  // namespace thunderhead::grib
