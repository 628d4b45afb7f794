// Writes small GRIB2 messages for tests, section by section, so that any number in them can be set.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "base/byte_source.h"

namespace thunderhead::grib::testing {

// Returns a number in `octets` octets, big-endian. Negative numbers have a sign bit.
inline std::string Number(std::int64_t number, int octets) {
  std::uint64_t bits = static_cast<std::uint64_t>(number < 0 ? -number : number);
  if (number < 0) bits |= std::uint64_t{1} << (8 * octets - 1);
  std::string text;
  for (int shift = 8 * (octets - 1); shift >= 0; shift -= 8) {
    text += static_cast<char>(bits >> static_cast<unsigned>(shift) & 0xFFU);
  }
  return text;
}

inline std::string Float(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  return Number(static_cast<std::int64_t>(bits), 4);
}

// Returns a section with its length and number.
inline std::string Section(int number, const std::string& contents) {
  return Number(static_cast<std::int64_t>(contents.size()) + 5, 4) + Number(number, 1) + contents;
}

struct Level {
  int type = 105;
  std::int64_t value = 1;
  int scale = 0;
  int second_type = 255;
  std::int64_t second_value = 0;
};

// One field, packed by template 5.0 with 16 bits, or with 0 bits if all values are equal.
struct Message {
  int discipline = 0;
  int category = 0;
  int number = 0;
  int centre = 7;
  int year = 2024;
  int month = 5;
  int day = 20;
  int hour = 21;
  int process = 83;
  int unit = 1;  // of time: 1 is the hour
  int forecast = 1;
  int member = -1;
  Level level;
  std::vector<float> coordinates;  // pv
  // Section 3 without its length and number.
  std::string grid;
  std::int64_t points = 0;
  std::vector<float> values;
  float minimum = 0.0F;
  float step = 1.0F;   // a power of 2
  std::string bitmap;  // one bit for each point; empty if all have a value
};

// Section 3 of a grid of latitudes and longitudes in millionths of a degree.
struct LatLon {
  int columns = 2;
  int rows = 2;
  int first_latitude = 10'000'000;
  int first_longitude = 20'000'000;
  int step = 1'000'000;
  int scanning = 0x40;
  int flags = 0x30;
};

inline std::string GridOf(const LatLon& grid) {
  const int east = grid.step * (grid.columns - 1) * ((grid.scanning & 0x80) != 0 ? -1 : 1);
  const int north = grid.step * (grid.rows - 1) * ((grid.scanning & 0x40) != 0 ? 1 : -1);
  return Number(0, 1) + Number(std::int64_t{grid.columns} * grid.rows, 4) + Number(0, 2) +
         Number(0, 2) + Number(6, 1) + Number(0, 15) + Number(grid.columns, 4) +
         Number(grid.rows, 4) + Number(0, 8) + Number(grid.first_latitude, 4) +
         Number(grid.first_longitude, 4) + Number(grid.flags, 1) +
         Number(grid.first_latitude + north, 4) + Number(grid.first_longitude + east, 4) +
         Number(grid.step, 4) + Number(grid.step, 4) + Number(grid.scanning, 1);
}

// Returns section 3 of ICON's triangles.
inline std::string TrianglesOf(std::int64_t points) {
  return Number(0, 1) + Number(points, 4) + Number(0, 2) + Number(101, 2) + Number(6, 1) +
         Number(44, 3) + Number(1, 1) +
         std::string("\xa2\x7b\x8d\xe6\x18\xc4\x11\xe4\x82\x0a\xb5\xb0\x98\xc6\xa5\xc0", 16);
}

inline std::string Indicator(int discipline, std::size_t sections_bytes) {
  return "GRIB" + Number(0, 2) + Number(discipline, 1) + Number(2, 1) +
         Number(static_cast<std::int64_t>(sections_bytes) + 20, 8);
}

inline std::string Whole(int discipline, const std::string& sections) {
  return Indicator(discipline, sections.size()) + sections + "7777";
}

inline std::string Section1(const Message& message) {
  return Section(1, Number(message.centre, 2) + Number(0, 2) + Number(2, 1) + Number(0, 1) +
                        Number(1, 1) + Number(message.year, 2) + Number(message.month, 1) +
                        Number(message.day, 1) + Number(message.hour, 1) + Number(0, 2) +
                        Number(0, 1) + Number(1, 1));
}

inline std::string Section4(const Message& message) {
  const Level& level = message.level;
  std::string text = Number(static_cast<std::int64_t>(message.coordinates.size()), 2) +
                     Number(message.member < 0 ? 0 : 1, 2) + Number(message.category, 1) +
                     Number(message.number, 1) + Number(2, 1) + Number(0, 1) +
                     Number(message.process, 1) + Number(0, 3) + Number(message.unit, 1) +
                     Number(message.forecast, 4) + Number(level.type, 1) + Number(level.scale, 1) +
                     Number(level.value, 4) + Number(level.second_type, 1) + Number(0, 1) +
                     Number(level.second_value, 4);
  if (message.member >= 0) text += Number(3, 1) + Number(message.member, 1) + Number(20, 1);
  for (const float each : message.coordinates) text += Float(each);
  return Section(4, text);
}

inline std::string Section5(const Message& message) {
  const bool is_constant = message.values.size() == 1;
  int exponent = 0;
  for (float step = message.step; step > 1.0F; step /= 2.0F) ++exponent;
  for (float step = message.step; step < 1.0F; step *= 2.0F) --exponent;
  const auto count =
      is_constant ? message.points : static_cast<std::int64_t>(message.values.size());
  return Section(5, Number(count, 4) + Number(0, 2) +
                        Float(is_constant ? message.values[0] : message.minimum) +
                        Number(exponent, 2) + Number(0, 2) + Number(is_constant ? 0 : 16, 1) +
                        Number(0, 1));
}

inline std::string Section6(const Message& message) {
  return Section(6, message.bitmap.empty() ? Number(255, 1) : Number(0, 1) + message.bitmap);
}

inline std::string Section7(const Message& message) {
  std::string text;
  if (message.values.size() > 1) {
    for (const float value : message.values) {
      text += Number(std::lround((value - message.minimum) / message.step), 2);
    }
  }
  return Section(7, text);
}

inline std::string BytesOf(const Message& message) {
  return Whole(message.discipline, Section1(message) + Section(3, message.grid) +
                                       Section4(message) + Section5(message) + Section6(message) +
                                       Section7(message));
}

// Bytes in memory.
class TextBytes final : public base::ByteSource {
 public:
  explicit TextBytes(std::string text) : text_(std::move(text)) {}

  const std::string& Path() const override { return path_; }
  std::uint64_t Size_bytes() const override { return text_.size(); }
  absl::Status Read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset > text_.size() || to.size() > text_.size() - offset) {
      return absl::DataLossError("read past the end");
    }
    std::memcpy(to.data(), text_.data() + offset, to.size());
    return absl::OkStatus();
  }

 private:
  const std::string path_ = "test.grib2";
  const std::string text_;
};

inline std::shared_ptr<const base::ByteSource> BytesIn(std::string text) {
  return std::make_shared<TextBytes>(std::move(text));
}

}  // namespace thunderhead::grib::testing
