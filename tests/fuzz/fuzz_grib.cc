// Fuzzes GRIB2 files through everything that a reader does with them. The input is either the bytes
// of a file, or a script. A script describes a small storm, whose file is written with correct
// lengths, and then changes of single bytes. So changes reach numbers deep in valid messages. The
// mutator of this target changes files by their structure.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "grib/decompressed.h"
#include "grib/values.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/grib_parts.h"
#include "storm_files/grib_storm.h"
#include "tests/fuzz/grib_mutator.h"
#include "tests/unit/grib/messages.h"

namespace thunderhead {
namespace {

using grib::testing::BytesIn;
using grib::testing::BytesOf;
using grib::testing::GridOf;
using grib::testing::Message;
using grib::testing::Number;

// A field with few bytes may have many points, and decoding it takes a second. Such fields are only
// described here. Those of still more points are left to tests of the confined reader
// (ConfinedGribBombs), whose memory is limited.
constexpr std::uint64_t kMostPoints = 10'000;
constexpr std::uint64_t kMostDescribedPoints = 4'000'000;

class Script {
 public:
  Script(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool AtEnd() const { return at_ >= size_; }
  int Next() { return AtEnd() ? 0 : data_[at_++]; }
  int NextBelow(int count) { return Next() % count; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

// Returns a field of 16 points packed by template 5.3 in two groups of 8 values and 4 bits.
std::string InGroups(const Message& message) {
  const std::string packing =
      Number(message.points, 4) + Number(3, 2) + grib::testing::Float(message.minimum) +
      Number(-10, 2) + Number(0, 2) + Number(8, 1) + Number(0, 1) + Number(1, 1) + Number(0, 1) +
      Number(0, 8) + Number(2, 4) + Number(4, 1) + Number(0, 1) + Number(message.points / 2, 4) +
      Number(1, 1) + Number(message.points / 2, 4) + Number(0, 1) + Number(1, 1) + Number(1, 1);
  const std::string data = std::string("\1\1\1\2", 4) + std::string(message.points / 2, '\x37');
  return grib::testing::Whole(0, Section1(message) + grib::testing::Section(3, message.grid) +
                                     Section4(message) + grib::testing::Section(5, packing) +
                                     Section6(message) + grib::testing::Section(7, data));
}

std::string FileOf(Script& script) {
  constexpr std::array kTypes = {105, 100, 150, 118, 119};
  constexpr std::array kCentres = {7, 78, 98, 59, 85, 1};
  constexpr std::array kFields = {std::array{1, 22}, std::array{1, 24}, std::array{1, 82},
                                  std::array{0, 0},  std::array{1, 0},  std::array{1, 1},
                                  std::array{3, 5},  std::array{3, 0},  std::array{2, 2},
                                  std::array{2, 3},  std::array{2, 8},  std::array{6, 29}};
  const int type = kTypes[script.NextBelow(kTypes.size())];
  const int levels = 1 + script.NextBelow(5);
  const bool has_half_levels = script.NextBelow(2) == 1;
  const bool has_groups = script.NextBelow(2) == 1;
  Message message;
  message.centre = kCentres[script.NextBelow(kCentres.size())];
  message.grid = GridOf({.columns = 4, .rows = 4, .scanning = script.NextBelow(8) << 5});
  message.points = 16;
  if (script.NextBelow(2) == 1) message.coordinates.assign(2 * (levels + 1), 0.25F);
  const int absent = script.NextBelow(64);
  std::string file;
  const auto add = [&](int category, int number, float value) {
    message.category = category;
    message.number = number;
    message.values = {value};
    file += has_groups && category == 1 ? InGroups(message) : BytesOf(message);
  };
  for (int level = 1; level <= levels; ++level) {
    message.level = {type, type == 100 ? 100'000 - 10'000 * level : level, 0,
                     has_half_levels ? type : 255, level + 1};
    for (std::size_t i = 0; i < kFields.size(); ++i) {
      if (absent == static_cast<int>(i)) continue;
      const float value = kFields[i][0] == 3 ? 100.0F * static_cast<float>(level) : 250.0F;
      add(kFields[i][0], kFields[i][1], kFields[i][0] == 1 ? 1e-3F : value);
    }
  }
  for (int level = 1; has_half_levels && level <= levels + 1; ++level) {
    message.level = {type, level};
    add(3, 6, 1000.0F - 100.0F * static_cast<float>(level));
  }
  message.level = {1, 0};
  add(3, 5, 50.0F);
  add(3, 0, 95'000.0F);
  add(3, 25, 11.5F);
  while (!script.AtEnd() && !file.empty()) {
    const std::size_t at =
        (static_cast<std::size_t>(script.Next()) << 8U | script.Next()) % file.size();
    const int change = script.NextBelow(16);
    const int value = script.Next();
    if (change == 0) {
      file.erase(at, value);
    } else if (change == 1) {
      file.insert(at, file.substr(at, value));
    } else {
      file[at] = static_cast<char>(value);
    }
  }
  return file;
}

// Decodes fields one by one, for a file whose messages are no storm.
void Decode(const base::ByteSource& file, const grib::Index& index) {
  constexpr std::size_t kMostFields = 16;
  for (std::size_t i = 0; i < std::min(kMostFields, index.fields.size()); ++i) {
    const auto values = grib::DecodeValues(file, index.fields[i]);
    if (values.ok() && values->size() != index.fields[i].points) std::abort();
  }
}

void Read(const std::shared_ptr<const base::ByteSource>& bytes) {
  constexpr std::uint64_t kMostBytes = 1 << 20;
  const auto plain = grib::Decompressed(bytes, kMostBytes);
  if (!plain.ok()) return;
  const auto index = storm_files::IndexOfGrib(*plain);
  if (!index.ok()) return;
  std::uint64_t points = 0;
  for (const grib::Field& field : (*index)->fields) points = std::max(points, field.points);
  if (points > kMostDescribedPoints) return;
  const bool is_small = points <= kMostPoints;
  static_cast<void>(storm_files::GribPartsOf(**index));
  const auto storms =
      storm_files::MakeGribStorms("fuzzed", {{"fuzzed", [&] { return plain; }}}, {*index});
  if (!storms.ok()) {
    if (is_small) Decode(**plain, **index);
    return;
  }
  const storm_files::StormFile file = storm_files::DescribeGribStorm(storms->front());
  if (file.times.empty() || file.fields.empty() || file.cells.x <= 0) std::abort();
  if (!is_small) return;
  const auto fields = file.reader->Read(0, std::nullopt, {});
  if (fields.ok() && fields->fields.size() != file.fields.size()) std::abort();
}

// Returns the bytes of the file that an input stands for.
std::string FileOfInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || data[0] != 's') return {reinterpret_cast<const char*>(data), size};
  Script script(data + 1, size - 1);
  return FileOf(script);
}

}  // namespace
}  // namespace thunderhead

// Replaces the input by a mutation of the file that it stands for. libFuzzer and replay.cc call it.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned int seed) {
  const std::string mutated =
      thunderhead::testing::MutateGrib(thunderhead::FileOfInput(data, size), seed);
  const std::size_t count = std::min(most, mutated.size());
  std::copy_n(mutated.begin(), count, data);
  return count;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // A reader answers a lack of memory with an error, and so does this target.
  const absl::Status status = thunderhead::base::Guarded([&] {
    thunderhead::Read(thunderhead::BytesIn(thunderhead::FileOfInput(data, size)));
    return absl::OkStatus();
  });
  if (status.code() == absl::StatusCode::kInternal) std::abort();
  return 0;
}
