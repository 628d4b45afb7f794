#include "tests/fuzz/grib_mutator.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

#include "tests/fuzz/dice.h"

namespace thunderhead::testing {
namespace {

constexpr std::size_t kIndicatorBytes = 16;
constexpr std::size_t kHeaderBytes = 5;

std::uint64_t NumberAt(const std::string& bytes, std::size_t at, std::size_t octets) {
  std::uint64_t number = 0;
  for (std::size_t i = at; i < at + octets && i < bytes.size(); ++i) {
    number = number << 8U | static_cast<unsigned char>(bytes[i]);
  }
  return number;
}

void SetNumber(std::string& bytes, std::size_t at, std::size_t octets, std::uint64_t number) {
  if (at + octets > bytes.size()) return;
  for (std::size_t i = octets; i-- > 0; number >>= 8U) {
    bytes[at + i] = static_cast<char>(number & 0xFFU);
  }
}

// A section with its length and number. The length is set when the file is written, except after a
// mutation of the length itself.
struct Part {
  std::string bytes;
  bool wrong_length = false;

  int Kind() const { return static_cast<int>(NumberAt(bytes, 4, 1)); }
};

struct Parts {
  std::string indicator;
  std::vector<Part> sections;
  bool wrong_length = false;
};

std::vector<Parts> Split(const std::string& file) {
  std::vector<Parts> messages;
  for (std::size_t at = file.find("GRIB");
       at != std::string::npos && at + kIndicatorBytes <= file.size(); at = file.find("GRIB", at)) {
    Parts message{file.substr(at, kIndicatorBytes), {}};
    at += kIndicatorBytes;
    while (at + kHeaderBytes <= file.size() && file.compare(at, 4, "7777") != 0) {
      const std::size_t length =
          std::clamp<std::size_t>(NumberAt(file, at, 4), kHeaderBytes, file.size() - at);
      message.sections.push_back({file.substr(at, length)});
      at += length;
    }
    messages.push_back(std::move(message));
  }
  return messages;
}

std::string Joined(std::vector<Parts> messages) {
  std::string file;
  for (Parts& message : messages) {
    std::string sections;
    for (Part& section : message.sections) {
      if (!section.wrong_length) SetNumber(section.bytes, 0, 4, section.bytes.size());
      sections += section.bytes;
    }
    if (!message.wrong_length) SetNumber(message.indicator, 8, 8, sections.size() + 20);
    file += message.indicator + sections + "7777";
  }
  return file;
}

// A number at a known place of a section. Octets are counted from 1, as in the manual on codes.
struct Place {
  int section;
  std::size_t octet;
  std::size_t octets;
};

constexpr std::array kPlaces = {
    Place{1, 6, 2},  Place{1, 10, 1}, Place{1, 13, 2}, Place{1, 15, 1}, Place{1, 16, 1},
    Place{1, 17, 1}, Place{1, 20, 1}, Place{3, 6, 1},  Place{3, 7, 4},  Place{3, 11, 1},
    Place{3, 12, 1}, Place{3, 13, 2}, Place{3, 15, 1}, Place{3, 31, 4}, Place{3, 35, 4},
    Place{3, 39, 4}, Place{3, 47, 4}, Place{3, 51, 4}, Place{3, 55, 1}, Place{3, 56, 4},
    Place{3, 60, 4}, Place{3, 64, 4}, Place{3, 68, 4}, Place{3, 72, 1}, Place{3, 73, 2},
    Place{4, 6, 2},  Place{4, 8, 2},  Place{4, 10, 1}, Place{4, 11, 1}, Place{4, 14, 1},
    Place{4, 18, 1}, Place{4, 19, 4}, Place{4, 23, 1}, Place{4, 24, 1}, Place{4, 25, 4},
    Place{4, 29, 1}, Place{4, 30, 1}, Place{4, 31, 4}, Place{4, 36, 1}, Place{5, 6, 4},
    Place{5, 10, 2}, Place{5, 12, 4}, Place{5, 16, 2}, Place{5, 18, 2}, Place{5, 20, 1},
    Place{5, 21, 1}, Place{5, 22, 1}, Place{5, 22, 4}, Place{5, 23, 1}, Place{5, 24, 2},
    Place{5, 26, 4}, Place{5, 30, 1}, Place{5, 31, 1}, Place{5, 32, 4}, Place{5, 33, 1},
    Place{5, 34, 1}, Place{5, 36, 1}, Place{5, 37, 1}, Place{5, 38, 4}, Place{5, 42, 1},
    Place{5, 43, 4}, Place{5, 47, 1}, Place{5, 48, 1}, Place{5, 49, 1}, Place{6, 6, 1}};

constexpr std::array kTemplates = {
    std::pair{3, 0},  std::pair{3, 1},   std::pair{3, 10},   std::pair{3, 20},    std::pair{3, 30},
    std::pair{3, 40}, std::pair{3, 50},  std::pair{3, 101},  std::pair{3, 32769}, std::pair{4, 0},
    std::pair{4, 1},  std::pair{4, 8},   std::pair{4, 11},   std::pair{5, 0},     std::pair{5, 2},
    std::pair{5, 3},  std::pair{5, 4},   std::pair{5, 40},   std::pair{5, 41},    std::pair{5, 42},
    std::pair{5, 61}, std::pair{5, 200}, std::pair{5, 50002}};

class Mutation {
 public:
  Mutation(std::vector<Parts> messages, std::uint64_t seed)
      : messages_(std::move(messages)), dice_(seed) {}

  std::string Run() {
    for (std::size_t changes = 1 + dice_.Below(3); changes > 0; --changes) Change();
    std::string file = Joined(std::move(messages_));
    if (dice_.OneIn(16)) file = Compressed(file);
    if (dice_.OneIn(16)) file.resize(dice_.Below(file.size() + 1));
    return file;
  }

 private:
  void Change() {
    if (messages_.empty()) return;
    Parts& message = messages_[dice_.Below(messages_.size())];
    switch (dice_.Below(11)) {
      case 0:
      case 1:
      case 2:
        return SetPlace(message);
      case 3:
        return SetTemplate(message);
      case 4:
        return SetWidth(message);
      case 5:
        return SetBitmap(message);
      case 6:
        return SetPoints(message);
      case 7:
        return SetLength(message);
      case 8:
        return MoveSection(message);
      case 9:
        return MoveMessage();
      default:
        return SetByte(message);
    }
  }

  // Returns a section of this kind, or null.
  static Part* Find(Parts& message, int kind) {
    const auto found = std::ranges::find(message.sections, kind, &Part::Kind);
    return found == message.sections.end() ? nullptr : &*found;
  }

  std::uint64_t SomeNumber(std::uint64_t near) {
    constexpr std::array<std::uint64_t, 17> kValues = {
        0,      1,           2,           3,           8,
        16,     31,          32,          33,          0x7FFF,
        0x8000, 0xFFFF'FFFF, 0x7FFF'FFFF, 0x8000'0000, 1'000'000'000,
        255,    0x8000'0001};
    switch (dice_.Below(3)) {
      case 0:
        return dice_.Of(kValues);
      case 1:
        return near + dice_.Below(5) - 2;
      default:
        return dice_.Below(dice_.OneIn(2) ? 256 : std::size_t{1} << 32U);
    }
  }

  // Sets a number in a section of one message, or of all messages alike. A storm's messages agree
  // on the grid, the time and the origin, so a change of one message mostly ends in a refusal.
  void Set(Parts& message, const Place& place, std::uint64_t number, std::size_t more_bytes) {
    const bool in_all = place.section <= 4 && !dice_.OneIn(3);
    for (Parts& each : messages_) {
      if (!in_all && &each != &message) continue;
      Part* const section = Find(each, place.section);
      if (section == nullptr) continue;
      SetNumber(section->bytes, place.octet - 1, place.octets, number);
      section->bytes.resize(section->bytes.size() + more_bytes);
    }
  }

  void SetPlace(Parts& message) {
    const Place place = dice_.Of(kPlaces);
    Part* const section = Find(message, place.section);
    if (section == nullptr) return;
    Set(message, place, SomeNumber(NumberAt(section->bytes, place.octet - 1, place.octets)), 0);
  }

  void SetTemplate(Parts& message) {
    const auto [kind, number] = dice_.Of(kTemplates);
    const std::size_t octet = kind == 3 ? 13 : kind == 4 ? 8 : 10;
    // Another template often has another length, so some bytes may be added.
    const std::size_t more_bytes = dice_.OneIn(2) ? dice_.Below(40) : 0;
    Set(message, {kind, octet, 2}, static_cast<std::uint64_t>(number), more_bytes);
  }

  // Sets the bits of a packed value, usually with as much data as they need.
  void SetWidth(Parts& message) {
    Part* const packing = Find(message, 5);
    Part* const data = Find(message, 7);
    if (packing == nullptr || data == nullptr) return;
    const std::size_t bits = dice_.Below(dice_.OneIn(4) ? 256 : 34);
    SetNumber(packing->bytes, 19, 1, bits);
    if (dice_.OneIn(4)) return;
    const std::uint64_t values = NumberAt(packing->bytes, 5, 4);
    constexpr std::uint64_t kMostBytes = 4096;
    const std::uint64_t bytes = std::min(kMostBytes, (values * bits + 7) / 8);
    data->bytes.resize(kHeaderBytes);
    for (std::uint64_t i = 0; i < bytes; ++i) data->bytes += static_cast<char>(dice_.Below(256));
  }

  void SetBitmap(Parts& message) {
    Part* const packing = Find(message, 5);
    Part* const bitmap = Find(message, 6);
    Part* const grid = Find(message, 3);
    if (packing == nullptr || bitmap == nullptr || grid == nullptr) return;
    bitmap->bytes.resize(kHeaderBytes);
    constexpr std::array kIndicators = {0, 0, 0, 0, 254, 255, 1};
    const int indicator = dice_.Of(kIndicators);
    bitmap->bytes += static_cast<char>(indicator);
    if (indicator != 0) return;
    constexpr std::uint64_t kMostBytes = 4096;
    const std::uint64_t bytes = std::min(kMostBytes, (NumberAt(grid->bytes, 6, 4) + 7) / 8);
    std::uint64_t set = 0;
    for (std::uint64_t i = 0; i < bytes; ++i) {
      const auto bits = static_cast<unsigned>(dice_.Below(256));
      bitmap->bytes += static_cast<char>(bits);
      set += static_cast<std::uint64_t>(std::popcount(bits));
    }
    if (!dice_.OneIn(4)) SetNumber(packing->bytes, 5, 4, set);
  }

  // Sets the number of points of one message, or of all messages, to the same number in every
  // section. If the number of bits per value is set to 0, no data are needed for any number of
  // points. A few bytes then announce far more values than memory can hold.
  void SetPoints(Parts& message) {
    const std::uint64_t columns = dice_.OneIn(8) ? 40'000 : dice_.Below(40);
    const std::uint64_t rows = dice_.OneIn(8) ? 40'000 : dice_.Below(40);
    const bool in_all = !dice_.OneIn(3);
    const bool without_bits = !dice_.OneIn(3);
    for (Parts& each : messages_) {
      if (!in_all && &each != &message) continue;
      Part* const grid = Find(each, 3);
      Part* const packing = Find(each, 5);
      if (grid == nullptr || packing == nullptr) continue;
      SetNumber(grid->bytes, 6, 4, columns * rows);
      SetNumber(grid->bytes, 30, 4, columns);
      SetNumber(grid->bytes, 34, 4, rows);
      // The flags say that the grid does not give the distances of its points, so that readers
      // derive them from the corners.
      SetNumber(grid->bytes, 54, 1, 0);
      SetNumber(grid->bytes, 63, 8, ~std::uint64_t{0});
      SetNumber(packing->bytes, 5, 4, columns * rows);
      if (without_bits) SetNumber(packing->bytes, 19, 1, 0);
    }
  }

  void SetLength(Parts& message) {
    if (message.sections.empty() || dice_.OneIn(4)) {
      SetNumber(message.indicator, 8, 8, SomeNumber(NumberAt(message.indicator, 8, 8)));
      message.wrong_length = true;
      return;
    }
    Part& section = message.sections[dice_.Below(message.sections.size())];
    const std::size_t size = section.bytes.size();
    switch (dice_.Below(3)) {
      case 0:
        SetNumber(section.bytes, 0, 4, SomeNumber(size));
        section.wrong_length = true;
        return;
      case 1:
        section.bytes.resize(std::max(kHeaderBytes, size - std::min(size, dice_.Below(40))));
        return;
      default:
        section.bytes.resize(size + dice_.Below(40));
    }
  }

  void MoveSection(Parts& message) {
    std::vector<Part>& sections = message.sections;
    if (sections.empty()) return;
    const auto at = static_cast<std::ptrdiff_t>(dice_.Below(sections.size()));
    switch (dice_.Below(4)) {
      case 0:
        sections.erase(sections.begin() + at);
        return;
      case 1:
        std::swap(sections[static_cast<std::size_t>(at)], sections[dice_.Below(sections.size())]);
        return;
      case 2: {
        // Sections may be repeated within a message: here those of another field.
        const std::vector<Part>& other = messages_[dice_.Below(messages_.size())].sections;
        std::vector<Part> more;
        for (const Part& section : other) {
          if (section.Kind() >= 4) more.push_back(section);
        }
        sections.insert(sections.end(), more.begin(), more.end());
        return;
      }
      default: {
        const std::vector<Part>& other = messages_[dice_.Below(messages_.size())].sections;
        if (other.empty()) return;
        sections[static_cast<std::size_t>(at)] = Part(other[dice_.Below(other.size())]);
      }
    }
  }

  void MoveMessage() {
    const auto at = static_cast<std::ptrdiff_t>(dice_.Below(messages_.size()));
    switch (dice_.Below(3)) {
      case 0:
        messages_.erase(messages_.begin() + at);
        return;
      case 1:
        messages_.push_back(Parts(messages_[static_cast<std::size_t>(at)]));
        return;
      default:
        std::swap(messages_[static_cast<std::size_t>(at)],
                  messages_[dice_.Below(messages_.size())]);
    }
  }

  void SetByte(Parts& message) {
    if (message.sections.empty()) return;
    Part& section = message.sections[dice_.Below(message.sections.size())];
    if (section.bytes.size() <= kHeaderBytes) return;
    const std::size_t at = kHeaderBytes + dice_.Below(section.bytes.size() - kHeaderBytes);
    section.bytes[at] = static_cast<char>(dice_.Below(256));
  }

  std::string Compressed(const std::string& file) {
    std::string packed(file.size() + file.size() / 50 + 1000, '\0');
    if (dice_.OneIn(2)) {
      auto size = static_cast<unsigned>(packed.size());
      BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(file.data()),
                               static_cast<unsigned>(file.size()), 1, 0, 0);
      packed.resize(size);
    } else {
      z_stream stream{};
      constexpr int kGzip = 16 + MAX_WBITS;
      deflateInit2(&stream, 1, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.data()));
      stream.avail_in = static_cast<uInt>(file.size());
      stream.next_out = reinterpret_cast<Bytef*>(packed.data());
      stream.avail_out = static_cast<uInt>(packed.size());
      deflate(&stream, Z_FINISH);
      packed.resize(stream.total_out);
      deflateEnd(&stream);
    }
    if (dice_.OneIn(2))
      packed[dice_.Below(packed.size())] ^= static_cast<char>(1 + dice_.Below(255));
    return packed;
  }

  std::vector<Parts> messages_;
  Dice dice_;
};

}  // namespace

std::string MutateGrib(const std::string& file, std::uint64_t seed) {
  return Mutation(Split(file), seed).Run();
}

}  // namespace thunderhead::testing
