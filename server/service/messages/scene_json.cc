#include "service/messages/scene_json.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/named_file.h"
#include "base/status.h"
#include "nlohmann/json.hpp"

namespace thunderhead::service {
namespace {

using Descriptor = google::protobuf::Descriptor;
using FieldDescriptor = google::protobuf::FieldDescriptor;
using nlohmann::json;

constexpr std::size_t kMaxLevels = 100;
constexpr std::size_t kLongestName_bytes = 64;

// An iterator that stores how far the text has been read, so that errors can say where they are.
class TrackedText {
 public:
  using iterator_category = std::forward_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackedText(pointer at, pointer* reached) : at_(at), reached_(reached) {}
  reference operator*() const { return *at_; }
  TrackedText& operator++() {
    *reached_ = ++at_;
    return *this;
  }
  bool operator==(const TrackedText& other) const { return at_ == other.at_; }

 private:
  pointer at_;
  pointer* reached_;
};

// Returns the line and column of byte number `count` of the text, counted from 1.
std::string PlaceOf(std::string_view text, std::size_t count) {
  const std::string_view before = text.substr(0, std::max<std::size_t>(count, 1) - 1);
  const auto line = 1 + std::ranges::count(before, '\n');
  // The column counts from 1. This also holds in the first line, in which rfind() returns npos,
  // because subtracting npos adds 1.
  const std::size_t column = before.size() - before.rfind('\n');
  return absl::StrCat("line ", line, ", column ", column, ": ");
}

// Returns the reason in a message of the JSON parser, such as "unexpected '}'; expected string
// literal". The rest of the message is dropped: it states the place, and can quote much of the
// text.
std::string ReasonIn(std::string_view message) {
  constexpr std::string_view kBefore = " - ";
  const std::size_t start = message.find(kBefore);
  if (start != std::string_view::npos) message.remove_prefix(start + kBefore.size());
  message = message.substr(0, message.find("; last read: "));
  return std::string(message);
}

// Checks a text while it is parsed.
class SceneJsonCheck final : public nlohmann::json_sax<json> {
 public:
  explicit SceneJsonCheck(std::string_view text) : text_(text) {}

  absl::Status Check() {
    const TrackedText begin(text_.data(), &reached_);
    const TrackedText end(text_.data() + text_.size(), &reached_);
    (void)json::sax_parse(begin, end, this);
    return error_;
  }

  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(number_integer_t /*value*/) override { return true; }
  bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return true; }
  bool string(string_t& /*value*/) override { return true; }
  bool binary(binary_t& /*value*/) override { return true; }

  bool start_object(std::size_t /*size*/) override { return Enter(); }
  bool end_object() override { return Leave(); }
  bool start_array(std::size_t /*size*/) override { return Enter(); }
  bool end_array() override { return Leave(); }

  bool key(string_t& name) override {
    Level& level = levels_.back();
    const FieldDescriptor* const field = FieldNamed(level.message, name);
    next_ = field == nullptr ? nullptr : field->message_type();
    // A field has two names, such as "maxError" and "max_error".
    if (level.names.insert(field == nullptr ? name : field->name()).second) return true;
    return Refuse(absl::StrCat("'", name.substr(0, kLongestName_bytes),
                               "' is given a second time; give each value once"));
  }

  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const json::exception& error) override {
    reached_ = text_.data() + std::min(position, text_.size());
    const bool is_too_large = dynamic_cast<const json::out_of_range*>(&error) != nullptr;
    if (is_too_large) return Refuse("a number is too large");
    return Refuse(absl::StrCat("this is not JSON: ", ReasonIn(error.what())));
  }

 private:
  // An object that has the type `message`, or an array of such objects, which is being parsed.
  struct Level {
    const Descriptor* message = nullptr;  // null for unknown objects
    std::set<std::string> names;
  };

  static const FieldDescriptor* FieldNamed(const Descriptor* message, const std::string& name) {
    if (message == nullptr || message->options().map_entry()) return nullptr;
    for (int i = 0; i < message->field_count(); ++i) {
      const FieldDescriptor* const field = message->field(i);
      if (field->name() == name || field->json_name() == name) return field;
    }
    return nullptr;
  }

  bool Enter() {
    if (levels_.size() == kMaxLevels) {
      return Refuse(absl::StrCat("there are more than ", kMaxLevels, " levels of nesting"));
    }
    levels_.push_back({next_, {}});
    return true;
  }

  bool Leave() {
    levels_.pop_back();
    return true;
  }

  bool Refuse(const std::string& why) {
    const auto count = static_cast<std::size_t>(reached_ - text_.data());
    error_ = absl::InvalidArgumentError(absl::StrCat(PlaceOf(text_, count), why));
    return false;
  }

  std::string_view text_;
  const char* reached_ = text_.data();
  std::vector<Level> levels_;
  const Descriptor* next_ = v1::Scene::descriptor();  // the type of the object that comes next
  absl::Status error_;
};

}  // namespace

absl::StatusOr<v1::Scene> SceneOfJson(const std::string& json) {
  if (json.size() > kMaxSceneJson_bytes) return base::TooLarge("the JSON", kMaxSceneJson_bytes);
  THUNDERHEAD_RETURN_IF_ERROR(SceneJsonCheck(json).Check());
  v1::Scene scene;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &scene);
  if (status.ok()) return scene;
  // The parser's message quotes the text with its line breaks, which are removed here.
  std::string why(status.message());
  absl::RemoveExtraAsciiWhitespace(&why);
  return absl::InvalidArgumentError(why);
}

}  // namespace thunderhead::service
