// The index of a GRIB2 file: what each field is and where its data are, by its section headers.
// This code decodes no data.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "base/byte_source.h"

namespace thunderhead::grib {

// A fixed surface of section 4.
struct Surface {
  static constexpr int kMissing = 255;
  int type = kMissing;  // code table 4.5
  double value = 0.0;   // NaN if the surface has none
};

// The centre that made a field, and its run, by section 1.
struct Origin {
  int centre = 0;  // common code table C-11
  int subcentre = 0;
  absl::Time reference;  // the run's start for a forecast

  bool operator==(const Origin&) const = default;
};

// The vertical coordinate of a field, by section 4.
struct VerticalCoordinate {
  std::vector<float> numbers;              // for hybrid levels: all a, then all b, of half levels
  std::array<std::uint8_t, 16> grid_id{};  // uuidOfVGrid, for generalized levels (150)
  bool has_grid_id = false;

  bool operator==(const VerticalCoordinate&) const = default;
};

struct Parameter {
  int discipline = 0;
  int category = 0;
  int number = 0;

  auto operator<=>(const Parameter&) const = default;
};

// A part of the file.
struct Extent {
  std::uint64_t offset = 0;
  std::uint64_t size_bytes = 0;
};

// One field of a message. A message can have several, which share its first sections.
struct Field {
  std::uint64_t message_offset = 0;  // for errors
  Origin origin;
  Parameter parameter;
  int product = 0;  // number of the template of section 4
  // False if the field is a mean, a sum or an extreme over a time, a probability, or of another
  // product definition that has no single valid time.
  bool is_instant = false;
  // The unit of the forecast time (code table 4.4), set only if it has no known length, such as a
  // month. `is_instant` is then false.
  std::optional<int> unknown_unit;
  int process = 0;            // number of the generating process, which the centre defines
  absl::Duration forecast;    // time from the reference time to the forecast's time
  std::optional<int> member;  // number of the ensemble's member
  Surface first;
  Surface second;
  std::shared_ptr<const VerticalCoordinate> vertical;  // null if the field has none
  std::shared_ptr<const std::vector<std::byte>> grid;  // section 3
  std::uint64_t points = 0;                            // number of the grid's points
  std::uint64_t values = 0;                            // number of packed values
  int packing = 0;                                     // number of the template of section 5
  Extent packing_section;
  std::optional<Extent> bitmap_section;  // absent if every point has a value
  Extent data_section;

  absl::Time Valid() const { return origin.reference + forecast; }
};

// Returns the three numbers as text, such as "0/1/22".
std::string NumbersOf(const Parameter& parameter);

struct Index {
  std::string path;           // the file's path, for errors
  std::vector<Field> fields;  // in the file's order
};

// Maximum number of fields of a file.
inline constexpr std::size_t kMaxFields = 200'000;

// Reads the headers of all messages of a plain (not compressed) file. Errors name the file and the
// message's offset: INVALID_ARGUMENT if the file has no GRIB message, a message of another edition
// than 2, a kind of section that is not supported, or more than kMaxFields fields; DATA_LOSS if a
// message is cut short or damaged.
absl::StatusOr<Index> ReadIndex(const base::ByteSource& file);

// Returns whether these first bytes of a file are those of a GRIB file: "GRIB" at once, or behind a
// short header of a bulletin.
bool BeginsLikeGrib(std::string_view start);

}  // namespace thunderhead::grib
