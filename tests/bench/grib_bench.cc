// Makes a GRIB2 file of the size of HRRR's native files (1799 x 1059 points) from a small one in
// the same layout, for grib_bench.py. The small grid is repeated, each copy mirrored, so that
// fields stay continuous. Fields are packed by template 5.3 with differences of second order, as
// NCEP packs them.
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/byte_source.h"
#include "base/status.h"
#include "grib/index.h"
#include "grib/octets.h"
#include "grib/values.h"
#include "storm_files/grib_storm.h"

namespace thunderhead {
namespace {

using Bytes = std::vector<std::uint8_t>;

// The grid of HRRR.
constexpr std::uint64_t kColumns = 1799;
constexpr std::uint64_t kRows = 1059;
constexpr std::uint64_t kSpacing_mm = 3'000'000;
constexpr std::uint64_t kFirstLatitude_microdeg = 21'138'123;
constexpr std::uint64_t kFirstLongitude_microdeg = 237'280'472;

// Points of one group. NCEP's groups vary in length around this.
constexpr std::uint64_t kGroup = 32;

void Put(std::uint64_t number, std::size_t octets, Bytes& to) {
  for (std::size_t i = octets; i > 0; --i) {
    to.push_back(static_cast<std::uint8_t>(number >> 8 * (i - 1)));
  }
}

// Puts a number with a sign bit.
void PutSigned(std::int64_t number, std::size_t octets, Bytes& to) {
  const std::uint64_t sign = number < 0 ? std::uint64_t{1} << (8 * octets - 1) : 0;
  Put(static_cast<std::uint64_t>(std::abs(number)) | sign, octets, to);
}

void Set(std::uint64_t number, std::size_t octet, std::size_t octets, Bytes& in) {
  for (std::size_t i = 0; i < octets; ++i) {
    in[octet - 1 + i] = static_cast<std::uint8_t>(number >> 8 * (octets - 1 - i));
  }
}

class BitWriter {
 public:
  explicit BitWriter(Bytes& to) : to_(to) {}

  void Put(std::uint64_t number, unsigned bits) {
    pending_ = pending_ << bits | number;
    count_ += bits;
    while (count_ >= 8) {
      count_ -= 8;
      to_.push_back(static_cast<std::uint8_t>(pending_ >> count_));
    }
  }

  void FillByte() {
    if (count_ > 0) Put(0, 8 - count_);
  }

 private:
  Bytes& to_;
  std::uint64_t pending_ = 0;
  unsigned count_ = 0;
};

unsigned BitsFor(std::uint64_t number) { return static_cast<unsigned>(std::bit_width(number)); }

// Numbers that stand for the values reference + number * step.
struct Integers {
  float reference = 0.0F;
  int binary_scale = 0;
  int decimal_scale = 0;
  std::vector<std::int64_t> numbers;
};

// Packs the numbers: sections 5, 6 and 7.
Bytes Packed(const Integers& from) {
  std::vector<std::int64_t> packed = from.numbers;
  const bool is_constant = std::ranges::all_of(packed, [](std::int64_t each) { return each == 0; });
  const std::uint64_t groups = is_constant ? 0 : (packed.size() + kGroup - 1) / kGroup;
  std::int64_t least = 0;
  if (!is_constant) {
    for (std::size_t i = packed.size(); i-- > 2;) {
      packed[i] += packed[i - 2] - 2 * packed[i - 1];
    }
    least = *std::min_element(packed.begin() + 2, packed.end());
    for (std::int64_t& each : packed) each -= least;
    packed[0] = packed[1] = 0;
  }
  std::vector<std::uint64_t> references;
  std::vector<unsigned> widths;
  for (std::size_t at = 0; at < packed.size() && !is_constant; at += kGroup) {
    const std::span group(&packed[at], std::min<std::size_t>(kGroup, packed.size() - at));
    const auto [low, high] = std::ranges::minmax(group);
    references.push_back(static_cast<std::uint64_t>(low));
    widths.push_back(BitsFor(static_cast<std::uint64_t>(high - low)));
  }
  const unsigned reference_bits = is_constant ? 0 : BitsFor(std::ranges::max(references));
  const unsigned width_bits = is_constant ? 0 : BitsFor(std::ranges::max(widths));
  const unsigned extra_octets = is_constant ? 0 : 4;
  Bytes sections;
  Put(49, 4, sections);
  Put(5, 1, sections);
  Put(packed.size(), 4, sections);
  Put(3, 2, sections);
  Put(std::bit_cast<std::uint32_t>(from.reference), 4, sections);
  PutSigned(from.binary_scale, 2, sections);
  PutSigned(from.decimal_scale, 2, sections);
  Put(reference_bits, 1, sections);
  Put(0x0001'00, 3, sections);  // floats, groups, no missing values
  Put(0, 8, sections);
  Put(groups, 4, sections);
  Put(0, 1, sections);
  Put(width_bits, 1, sections);
  Put(kGroup, 4, sections);
  Put(1, 1, sections);
  Put(is_constant ? 0 : packed.size() - (groups - 1) * kGroup, 4, sections);
  Put(0, 1, sections);  // all groups but the last have the same length
  Put(2, 1, sections);
  Put(extra_octets, 1, sections);
  Put(6, 4, sections);
  Put(0x06FF, 2, sections);  // no bitmap
  Bytes data;
  if (!is_constant) {
    PutSigned(from.numbers[0], extra_octets, data);
    PutSigned(from.numbers[1], extra_octets, data);
    PutSigned(least, extra_octets, data);
    BitWriter bits(data);
    for (const std::uint64_t each : references) bits.Put(each, reference_bits);
    bits.FillByte();
    for (const unsigned each : widths) bits.Put(each, width_bits);
    bits.FillByte();
    for (std::size_t i = 0; i < packed.size(); ++i) {
      const std::size_t group = i / kGroup;
      bits.Put(static_cast<std::uint64_t>(packed[i]) - references[group], widths[group]);
    }
    bits.FillByte();
  }
  Put(data.size() + 5, 4, sections);
  Put(7, 1, sections);
  sections.insert(sections.end(), data.begin(), data.end());
  return sections;
}

// Returns the index of a small grid of `count` points for a point of the large one.
std::size_t Mirrored(std::size_t at, std::size_t count) {
  const std::size_t place = at % (2 * count);
  return place < count ? place : 2 * count - 1 - place;
}

// Repeats the small field. A point without a value gets the reference.
Integers Repeated(const grib::Octets& packing, const grib::Octets& grid,
                  const std::vector<float>& values) {
  Integers integers;
  integers.reference = std::bit_cast<float>(static_cast<std::uint32_t>(packing.Unsigned(12, 4)));
  integers.binary_scale = static_cast<int>(packing.Signed(16, 2));
  integers.decimal_scale = static_cast<int>(packing.Signed(18, 2));
  const std::size_t columns = grid.Unsigned(31, 4);
  const std::size_t rows = grid.Unsigned(35, 4);
  const double decimal = std::pow(10.0, integers.decimal_scale);
  const double step = std::exp2(-integers.binary_scale);
  std::vector<std::int64_t> small(values.size());
  std::ranges::transform(values, small.begin(), [&](float value) {
    if (!std::isfinite(value)) return std::int64_t{0};
    return std::max<std::int64_t>(std::llround((value * decimal - integers.reference) * step), 0);
  });
  integers.numbers.reserve(kColumns * kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    const std::size_t first = Mirrored(row, rows) * columns;
    for (std::size_t column = 0; column < kColumns; ++column) {
      integers.numbers.push_back(small[first + Mirrored(column, columns)]);
    }
  }
  return integers;
}

Bytes LargeGrid(const std::vector<std::byte>& small) {
  Bytes grid(small.size());
  std::ranges::transform(small, grid.begin(),
                         [](std::byte each) { return std::to_integer<std::uint8_t>(each); });
  Set(kColumns * kRows, 7, 4, grid);
  Set(kColumns, 31, 4, grid);
  Set(kRows, 35, 4, grid);
  Set(kFirstLatitude_microdeg, 39, 4, grid);
  Set(kFirstLongitude_microdeg, 43, 4, grid);
  Set(kSpacing_mm, 56, 4, grid);
  Set(kSpacing_mm, 60, 4, grid);
  return grid;
}

// Returns section `number` of the message at `offset`.
absl::StatusOr<std::vector<std::byte>> SectionOf(const base::ByteSource& file, std::uint64_t offset,
                                                 std::uint64_t number) {
  constexpr std::uint64_t kIndicator = 16;
  std::vector<std::byte> header(5);
  for (std::uint64_t at = offset + kIndicator;;) {
    THUNDERHEAD_RETURN_IF_ERROR(file.Read(at, header));
    const grib::Octets octets(header);
    const std::uint64_t size = octets.Unsigned(1, 4);
    if (octets.Unsigned(5, 1) == number) {
      std::vector<std::byte> section(size);
      THUNDERHEAD_RETURN_IF_ERROR(file.Read(at, section));
      return section;
    }
    at += size;
  }
}

absl::Status Make(const std::string& small_path, const std::string& large_path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto small, base::OpenBytes(small_path));
  THUNDERHEAD_ASSIGN_OR_RETURN(const grib::Index index, grib::ReadIndex(*small));
  std::ofstream large(large_path, std::ios::binary);
  for (const grib::Field& field : index.fields) {
    Bytes message = {
        'G', 'R', 'I', 'B', 0, 0, static_cast<std::uint8_t>(field.parameter.discipline), 2};
    Put(0, 8, message);
    const auto copy = [&](std::uint64_t number) -> absl::Status {
      THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::byte> section,
                                   SectionOf(*small, field.message_offset, number));
      for (const std::byte each : section) message.push_back(std::to_integer<std::uint8_t>(each));
      return absl::OkStatus();
    };
    THUNDERHEAD_RETURN_IF_ERROR(copy(1));
    const Bytes grid = LargeGrid(*field.grid);
    message.insert(message.end(), grid.begin(), grid.end());
    THUNDERHEAD_RETURN_IF_ERROR(copy(4));
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> values,
                                 grib::DecodeValues(*small, field));
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::byte> packing,
                                 SectionOf(*small, field.message_offset, 5));
    const Bytes packed = Packed(Repeated(grib::Octets(packing), grib::Octets(*field.grid), values));
    message.insert(message.end(), packed.begin(), packed.end());
    Put(0x37373737, 4, message);
    Set(message.size(), 9, 8, message);
    large.write(reinterpret_cast<const char*>(message.data()),
                static_cast<std::streamsize>(message.size()));
  }
  large.close();
  if (large.good()) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat(large_path, ": cannot be written; is the disk full?"));
}

using Clock = std::chrono::steady_clock;

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * time.tv_usec;
}

// Prints the time since the last call. The seconds of processors, of all threads together, depend
// little on other work on the machine.
class Stages {
 public:
  void Print(const std::string& stage) {
    const std::chrono::duration<double> took = Clock::now() - begin_;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const double processor_s = Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
    std::printf("%-32s %7.2f s %7.2f s of processors %6.2f GiB at most\n", stage.c_str(),
                took.count(), processor_s - processor_s_,
                static_cast<double>(usage.ru_maxrss) / (1 << 20));
    std::fflush(stdout);
    processor_s_ = processor_s;
    begin_ = Clock::now();
  }

 private:
  Clock::time_point begin_ = Clock::now();
  double processor_s_ = 0.0;
};

absl::Status PrintStages(const std::string& path) {
  THUNDERHEAD_RETURN_IF_ERROR(grib::PrepareBeforeConfinement());
  Stages stages;
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto bytes, base::OpenBytes(path));
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto index, storm_files::IndexOfGrib(bytes));
  stages.Print(absl::StrCat("scan of ", index->fields.size(), " fields"));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const auto storms,
      storm_files::MakeGribStorms(path, {storm_files::GribFileAt(path)}, {index}));
  stages.Print("choice of fields");
  const storm_files::GribSeries& temperature = storms[0]->contents.times[0].temperature;
  for (const storm_files::GribPlace& place : temperature.levels) {
    THUNDERHEAD_RETURN_IF_ERROR(grib::DecodeValues(*bytes, *place.field).status());
  }
  stages.Print("temperature, on one thread");
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto source, storm_files::OpenGribTime(storms[0], 0));
  stages.Print("order of levels");
  THUNDERHEAD_RETURN_IF_ERROR(source->InterfaceHeights_m().status());
  stages.Print("heights");
  THUNDERHEAD_RETURN_IF_ERROR(source->Air().status());
  stages.Print("pressure, temperature, vapour");
  for (std::size_t i = 0; i < source->Domain().fields.size(); ++i) {
    THUNDERHEAD_RETURN_IF_ERROR(source->Amounts(i).status());
    stages.Print(source->Domain().fields[i].variable);
  }
  THUNDERHEAD_RETURN_IF_ERROR(source->TurbulentEnergy().status());
  stages.Print("turbulent energy");
  THUNDERHEAD_RETURN_IF_ERROR(source->Wind().status());
  stages.Print("wind");
  const storm_files::StormFile storm = storm_files::DescribeGribStorm(storms[0]);
  THUNDERHEAD_RETURN_IF_ERROR(storm.reader->Read(0, std::nullopt, {}).status());
  stages.Print("all of these, onto even heights");
  return absl::OkStatus();
}

absl::Status Run(const std::vector<std::string>& words) {
  if (words.size() == 3 && words[0] == "make") return Make(words[1], words[2]);
  if (words.size() == 2 && words[0] == "stages") return PrintStages(words[1]);
  return absl::InvalidArgumentError(
      "usage: thunderhead_grib_bench make SMALL LARGE | thunderhead_grib_bench stages FILE");
}

}  // namespace
}  // namespace thunderhead

int main(int count, char** arguments) {
  const absl::Status status = thunderhead::Run({arguments + 1, arguments + count});
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", std::string(status.message()).c_str());
  return 1;
}
