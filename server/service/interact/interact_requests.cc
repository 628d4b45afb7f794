#include "service/interact/interact_requests.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/random_hex.h"
#include "base/utf8.h"
#include "glm/geometric.hpp"

namespace thunderhead::service {
namespace {

constexpr std::size_t kMaxNameCharacters = 40;
constexpr int kParticipantKeyWords = 4;  // a key has this many words of 8 hexadecimal digits

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
  std::size_t end = 0;
  std::size_t characters = 0;
  for (std::size_t at = 0; at < name.size(); ++characters) {
    const std::size_t size = base::Utf8CharacterBytes(std::string_view(name).substr(at));
    if (size == 0) return base::InvalidField(path, "is not UTF-8", "TEXT_NOT_UTF8");
    at += size;
    if (characters < kMaxNameCharacters) end = at;
  }
  const std::string shown = base::Printable(name.substr(0, end), {.instead = ' '});
  return std::string(absl::StripAsciiWhitespace(shown));
}

}  // namespace thunderhead::service
