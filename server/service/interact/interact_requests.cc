#include "service/interact/interact_requests.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/random_hex.h"
#include "glm/geometric.hpp"

namespace thunderhead::service {
namespace {

constexpr std::size_t kMaxNameCharacters = 40;
constexpr int kParticipantKeyWords = 4;  // each of 8 hexadecimal digits

// Returns the length in bytes of the UTF-8 character that begins with `byte`; 0 if no character
// does.
std::size_t CharacterBytes(unsigned char byte) {
  if (byte < 0x80) return 1;
  if (byte >= 0xc2 && byte < 0xe0) return 2;
  if (byte >= 0xe0 && byte < 0xf0) return 3;
  return byte >= 0xf0 && byte < 0xf5 ? 4 : 0;
}

// Returns the code point of one UTF-8 character.
std::uint32_t CodePointOf(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first;
  std::uint32_t code = first & (0x7fU >> character.size());
  for (const char byte : character.substr(1)) {
    code = code << 6U | (static_cast<unsigned char>(byte) & 0x3fU);
  }
  return code;
}

// Returns true for control characters, and for characters that have no width or change the text
// direction. With such characters, a name could imitate another name. Joiners are allowed, because
// some scripts need them.
bool IsHidden(std::uint32_t code) {
  constexpr std::array<std::pair<std::uint32_t, std::uint32_t>, 8> kHidden{{{0x00, 0x1f},
                                                                            {0x7f, 0x9f},
                                                                            {0x61c, 0x61c},
                                                                            {0x200b, 0x200b},
                                                                            {0x200e, 0x200f},
                                                                            {0x2028, 0x202e},
                                                                            {0x2060, 0x206f},
                                                                            {0xfeff, 0xfeff}}};
  return std::ranges::any_of(
      kHidden, [code](const auto& range) { return range.first <= code && code <= range.second; });
}

}  // namespace

session::Rules RulesOf(const v1::SessionRules& message, session::Rules rules) {
  if (message.has_viewers_may_steer()) rules.viewers_may_steer = message.viewers_may_steer();
  if (message.has_control_locked()) rules.control_locked = message.control_locked();
  if (message.has_following_locked()) rules.following_locked = message.following_locked();
  if (message.has_viewers_may_mark()) rules.viewers_may_mark = message.viewers_may_mark();
  if (message.has_free_when_away()) rules.free_when_away = message.free_when_away();
  return rules;
}

absl::StatusOr<session::Ray> RayOf(const v1::Ray& message, const std::string& path) {
  const v1::Vector& to = message.direction();
  const glm::dvec3 direction(to.x(), to.y(), to.z());
  const double length = glm::length(direction);
  if (!(length > 0.0)) {
    return base::InvalidField(absl::StrCat(path, ".direction"), "has length 0; give a direction",
                              "VALUE_OUT_OF_RANGE");
  }
  const v1::RayOrigin& from = message.origin();
  return session::Ray{glm::dvec3(from.x_m(), from.y_m(), from.z_m()), direction / length};
}

absl::StatusOr<std::string> ParticipantKeyOf(const std::string& key, const std::string& path) {
  if (key.empty()) return base::RandomHex(kParticipantKeyWords);
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (key.size() != 8 * kParticipantKeyWords || !std::ranges::all_of(key, is_digit)) {
    return base::InvalidField(path,
                              "is not a key that Joined returned; omit it to join as a new person",
                              "KEY_MALFORMED");
  }
  return key;
}

absl::StatusOr<std::string> NameOf(const std::string& name, const std::string& path) {
  std::string shown;
  std::size_t characters = 0;
  for (std::size_t at = 0; at < name.size() && characters < kMaxNameCharacters;) {
    const auto first = static_cast<unsigned char>(name[at]);
    const std::size_t size = CharacterBytes(first);
    if (size == 0 || at + size > name.size()) {
      return base::InvalidField(path, "is not UTF-8", "TEXT_NOT_UTF8");
    }
    shown += IsHidden(CodePointOf(name.substr(at, size))) ? " " : name.substr(at, size);
    at += size;
    ++characters;
  }
  return std::string(absl::StripAsciiWhitespace(shown));
}

}  // namespace thunderhead::service
