#include "grib/values.h"

#include <eccodes.h>
#include <grib_api.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "grib/octets.h"
#include "grib/packing_check.h"

namespace thunderhead::grib {
namespace {

using Bytes = std::vector<std::byte>;

// The number that stands for a missing value while ecCodes decodes. Its default, 9999, is also a
// possible height. No quantity is as large as this number.
constexpr double kMissingValue = 1e30;

// Maximum number of points of a field. A field of one value needs only a few bytes in a file, so
// the file's size says nothing about the memory that it needs.
constexpr std::uint64_t kMaxPoints = 200'000'000;

// Thrown if an assertion in ecCodes fails. By default ecCodes would end the process.
class FailedAssertion : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The exception passes through the C functions of ecCodes, which works with Debian's compilers. The
// memory that these functions had allocated is lost.
[[noreturn]] void OnFailedAssertion(const char* message) { throw FailedAssertion(message); }

void IgnoreLog(const codes_context* /*context*/, int /*level*/, const char* /*message*/) {}

// Sets the options of ecCodes that concern all threads, at the first call.
void SetUpLibrary() {
  static const bool is_set_up = [] {
    codes_context_set_logging_proc(codes_context_get_default(), IgnoreLog);
    codes_set_codes_assertion_failed_proc(OnFailedAssertion);
    return true;
  }();
  static_cast<void>(is_set_up);
}

void Append(Bytes& message, std::uint64_t number, std::size_t octets) {
  for (std::size_t i = octets; i > 0; --i) {
    message.push_back(static_cast<std::byte>(number >> 8U * (i - 1) & 0xFFU));
  }
}

void Append(Bytes& message, std::span<const std::byte> bytes) {
  message.insert(message.end(), bytes.begin(), bytes.end());
}

// The shape in which the points of a field are packed.
struct Shape {
  std::uint64_t columns = 0;
  std::uint64_t rows = 0;
};

// Makes a message with the packed data of `field`. All other sections are constant, except for the
// numbers of points, columns and rows. Therefore ecCodes needs few of its definition files, always
// the same ones, and a hostile file cannot choose them. The packing does not depend on the grid, so
// the message has a grid of latitudes and longitudes.
Bytes PlainMessage(const PackedField& field, const Shape& shape) {
  constexpr std::size_t kHeaders = 16 + 21 + 72 + 34 + 6 + 4;
  Bytes message;
  message.reserve(kHeaders + field.packing.size() + field.bitmap.size() + field.data.size());
  Append(message, 0x47524942, 4);  // GRIB
  Append(message, 0, 3);           // discipline 0
  Append(message, 2, 1);           // edition
  Append(message, 0, 8);           // length, which is set below
  Append(message, 21, 4);          // section 1
  Append(message, 1, 1);
  Append(message, 0, 4);       // centre, subcentre
  Append(message, 0x0400, 2);  // version of the tables; no local tables
  Append(message, 1, 1);       // start of forecast
  Append(message, 2000, 2);    // reference time
  Append(message, 0x0101000000, 5);
  Append(message, 0, 2);
  Append(message, 72, 4);  // section 3
  Append(message, 3, 1);
  Append(message, 0, 1);
  Append(message, field.points, 4);
  Append(message, 0, 4);  // no list of points per row; template 3.0
  Append(message, 6, 1);  // a sphere
  Append(message, 0, 15);
  Append(message, shape.columns, 4);
  Append(message, shape.rows, 4);
  Append(message, 0, 8);
  Append(message, 0, 8);  // first point
  Append(message, 0x30, 1);
  Append(message, 0, 8);  // last point
  Append(message, 1, 4);
  Append(message, 1, 4);
  Append(message, 0x40, 1);
  Append(message, 34, 4);  // section 4
  Append(message, 4, 1);
  Append(message, 0, 4);  // no coordinates, template 4.0
  Append(message, 0, 2);  // temperature
  Append(message, 0x020000, 3);
  Append(message, 0, 3);
  Append(message, 1, 1);  // hours
  Append(message, 0, 4);
  Append(message, 1, 1);  // at the ground
  Append(message, 0, 5);
  Append(message, 255, 1);
  Append(message, 0, 5);
  Append(message, field.packing);
  if (field.bitmap.empty()) {
    Append(message, 6, 4);
    Append(message, 6, 1);
    Append(message, 255, 1);
  } else {
    // This section 6 contains the bitmap itself. If the field in the file reuses the bitmap of an
    // earlier field, this is the section 6 of that field.
    Append(message, field.bitmap);
  }
  Append(message, field.data);
  Append(message, 0x37373737, 4);  // 7777
  Bytes length;
  Append(length, message.size(), 8);
  std::ranges::copy(length, message.begin() + 8);
  return message;
}

absl::Status CannotDecode(const char* reason) {
  return absl::DataLossError(absl::StrCat("its packed data cannot be decoded (", reason,
                                          "); the file is damaged: copy it again"));
}

absl::StatusOr<std::vector<float>> DecodeByLibrary(Bytes message, std::uint64_t points) {
  const std::unique_ptr<codes_handle, int (*)(codes_handle*)> handle(
      codes_handle_new_from_message(nullptr, message.data(), message.size()), codes_handle_delete);
  if (handle == nullptr) return CannotDecode("no message");
  int error = codes_set_double(handle.get(), "missingValue", kMissingValue);
  std::size_t count = 0;
  if (error == CODES_SUCCESS) error = codes_get_size(handle.get(), "values", &count);
  if (error != CODES_SUCCESS) return CannotDecode(codes_get_error_message(error));
  if (count != points) {
    return CannotDecode(absl::StrCat(count, " values for ", points, " points").c_str());
  }
  std::vector<double> values(count);
  error = codes_get_double_array(handle.get(), "values", values.data(), &count);
  if (error != CODES_SUCCESS) return CannotDecode(codes_get_error_message(error));
  if (count != points) return CannotDecode("not all values");
  std::vector<float> result(count);
  std::ranges::transform(values, result.begin(), [](double value) {
    return value == kMissingValue ? std::nanf("") : static_cast<float>(value);
  });
  return result;
}

absl::StatusOr<std::vector<float>> Decode(const PackedField& field, const Shape& shape) {
  SetUpLibrary();
  THUNDERHEAD_RETURN_IF_ERROR(CheckPacked(field));
  if (field.points == 0) return std::vector<float>();
  try {
    return DecodeByLibrary(PlainMessage(field, shape), field.points);
  } catch (const FailedAssertion& failed) {
    return CannotDecode(failed.what());
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return absl::ResourceExhaustedError(absl::StrCat("its ", field.points,
                                                   " points do not fit in memory; cut a smaller "
                                                   "domain"));
}

absl::StatusOr<Bytes> ReadSection(const base::ByteSource& file, const Extent& extent) {
  Bytes section(extent.size_bytes);
  THUNDERHEAD_RETURN_IF_ERROR(file.Read(extent.offset, section));
  return section;
}

// Returns the columns and rows of the grid, which are at the same octets in all supported templates
// with columns and rows. Returns one row for other grids.
Shape ShapeOf(const Field& field) {
  constexpr std::size_t kColumns = 31;
  constexpr std::size_t kRows = 35;
  const Octets grid(*field.grid);
  const Shape shape{grid.Unsigned(kColumns, 4), grid.Unsigned(kRows, 4)};
  if (shape.columns * shape.rows == field.points) return shape;
  return {field.points, 1};
}

// A small packed field, with which the decoder of one packing template is tested.
struct Sample {
  Bytes packing;
  Bytes data;
};

// Pairs of a number and the octets that it takes.
using Numbers = std::vector<std::pair<std::uint64_t, std::size_t>>;

// Makes section 5 with `values` values and the numbers that follow the number of the template.
Bytes SamplePacking(Packing packing, std::uint64_t values, const Numbers& numbers) {
  Bytes section;
  std::size_t octets = 11;
  for (const auto& [number, count] : numbers) octets += count;
  Append(section, octets, 4);
  Append(section, 5, 1);
  Append(section, values, 4);
  Append(section, static_cast<std::uint64_t>(packing), 2);
  for (const auto& [number, count] : numbers) Append(section, number, count);
  return section;
}

Bytes SampleData(std::size_t bytes) {
  Bytes section;
  Append(section, 5 + bytes, 4);
  Append(section, 7, 1);
  section.resize(5 + bytes, std::byte{1});
  return section;
}

// Returns fields of four values. For JPEG 2000, PNG and CCSDS a value has 0 bits: all values are
// then the same, and no image or block is needed.
std::vector<Sample> Samples() {
  constexpr std::uint64_t kValues = 4;
  const auto packing = [](Packing by, const Numbers& numbers) {
    return SamplePacking(by, kValues, numbers);
  };
  const Numbers complex = {{0, 8}, {8, 1}, {0, 1}, {1, 1}, {0, 1},       {0, 8}, {1, 4},
                           {0, 1}, {0, 1}, {0, 4}, {1, 1}, {kValues, 4}, {0, 1}};
  // The order of differencing, and the octets of its extra values.
  Numbers differencing = complex;
  differencing.insert(differencing.end(), {{1, 1}, {1, 1}});
  std::vector<Sample> samples;
  samples.push_back({packing(Packing::kSimple, {{0, 8}, {8, 1}, {0, 1}}), SampleData(kValues)});
  samples.push_back({packing(Packing::kComplex, complex), SampleData(1)});
  samples.push_back({packing(Packing::kSpatialDifferencing, differencing), SampleData(3)});
  samples.push_back({packing(Packing::kIeee, {{1, 1}}), SampleData(4 * kValues)});
  samples.push_back(
      {packing(Packing::kJpeg2000, {{0, 8}, {0, 1}, {0, 1}, {0, 1}, {255, 1}}), SampleData(0)});
  samples.push_back({packing(Packing::kPng, {{0, 8}, {0, 1}, {0, 1}}), SampleData(0)});
  samples.push_back({packing(Packing::kCcsds, {{0, 8}, {0, 1}, {0, 1}, {14, 1}, {32, 1}, {128, 2}}),
                     SampleData(0)});
  samples.push_back(
      {packing(Packing::kSecondOrder,
               {{0, 8}, {8, 1}, {8, 1}, {1, 4}, {kValues, 4}, {8, 1}, {8, 1}, {0, 1}, {0, 1}}),
       [] {
         Bytes data = SampleData(3);
         data[5] = std::byte{0};        // number of bits for each value of the group
         data[6] = std::byte{kValues};  // number of values in the group
         return data;
       }()});
  return samples;
}

}  // namespace

absl::Status PrepareBeforeConfinement() {
  constexpr std::uint64_t kPoints = 4;
  Bytes bitmap;
  Append(bitmap, 7, 4);
  Append(bitmap, 0x0600F0, 3);
  for (const Sample& sample : Samples()) {
    for (const bool has_bitmap : {false, true}) {
      PackedField field{kPoints, sample.packing, {}, sample.data};
      if (has_bitmap) field.bitmap = bitmap;
      const absl::Status decoded = Decode(field, {2, 2}).status();
      if (decoded.ok()) continue;
      return absl::FailedPreconditionError(
          absl::StrCat("GRIB files cannot be read here: a field packed by template 5.",
                       Octets(sample.packing).Unsigned(10, 2), " ", std::string(decoded.message()),
                       "; install ecCodes with its definition files (libeccodes-data)"));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<float>> DecodeValues(const base::ByteSource& file, const Field& field) {
  const std::string what = absl::StrCat(file.Path(), ": the field ", NumbersOf(field.parameter),
                                        " in the GRIB message at byte ", field.message_offset);
  if (field.points > kMaxPoints) {
    return absl::ResourceExhaustedError(
        absl::StrCat(what, " has ", field.points, " points, and ", kMaxPoints, " are the most"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(
      base::CountThatFits(what, {field.points}, sizeof(double) + sizeof(float)).status());
  THUNDERHEAD_ASSIGN_OR_RETURN(const Bytes packing, ReadSection(file, field.packing_section));
  Bytes bitmap;
  if (field.bitmap_section.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(bitmap, ReadSection(file, *field.bitmap_section));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const Bytes data, ReadSection(file, field.data_section));
  auto values = Decode({field.points, packing, bitmap, data}, ShapeOf(field));
  if (!values.ok()) return base::Annotate(values.status(), what);
  return values;
}

}  // namespace thunderhead::grib
