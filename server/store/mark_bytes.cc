#include "store/mark_bytes.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

namespace thunderhead::store {
namespace {

constexpr std::size_t kWordBytes = 8;
// The number of words of a mark without its positions: id, person, three for the colour, and the
// number of positions.
constexpr std::size_t kMarkWords = 6;
constexpr std::size_t kPositionWords = 3;  // x, y and z

void Append(std::uint64_t word, std::string* bytes) {
  for (std::size_t i = 0; i < kWordBytes; ++i) bytes->push_back(static_cast<char>(word >> (8 * i)));
}

void Append(double value, std::string* bytes) {
  Append(std::bit_cast<std::uint64_t>(value), bytes);
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  std::size_t WordsLeft() const { return bytes_.size() / kWordBytes; }

  std::uint64_t Word() {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < kWordBytes; ++i) {
      word |= std::uint64_t{static_cast<unsigned char>(bytes_[i])} << (8 * i);
    }
    bytes_.remove_prefix(kWordBytes);
    return word;
  }

  double Number() { return std::bit_cast<double>(Word()); }

  // The components are read by separate statements, because the order of evaluation of arguments is
  // not defined.
  glm::dvec3 Vector() {
    const double x = Number();
    const double y = Number();
    return {x, y, Number()};
  }

 private:
  std::string_view bytes_;
};

}  // namespace

std::string ToBytes(const std::vector<session::Mark>& marks) {
  std::string bytes;
  for (const session::Mark& mark : marks) {
    Append(mark.id, &bytes);
    Append(mark.person_id, &bytes);
    for (int i = 0; i < 3; ++i) Append(double{mark.color[i]}, &bytes);
    Append(std::uint64_t{mark.positions_m.size()}, &bytes);
    for (const glm::dvec3& position_m : mark.positions_m) {
      for (int i = 0; i < 3; ++i) Append(position_m[i], &bytes);
    }
  }
  return bytes;
}

absl::StatusOr<std::vector<session::Mark>> MarksFrom(const std::string& bytes) {
  const absl::Status damaged = absl::DataLossError("its marks are damaged");
  if (bytes.size() % kWordBytes != 0) return damaged;
  std::vector<session::Mark> marks;
  Reader reader(bytes);
  while (reader.WordsLeft() > 0) {
    if (reader.WordsLeft() < kMarkWords) return damaged;
    session::Mark mark;
    mark.id = reader.Word();
    mark.person_id = reader.Word();
    mark.color = reader.Vector();
    const std::uint64_t positions = reader.Word();
    if (positions > reader.WordsLeft() / kPositionWords) return damaged;
    for (std::uint64_t i = 0; i < positions; ++i) mark.positions_m.push_back(reader.Vector());
    marks.push_back(std::move(mark));
  }
  return marks;
}

}  // namespace thunderhead::store
