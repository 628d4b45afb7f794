#include "app/log_format.h"

#include <ctime>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "base/utf8.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"
#include "spdlog/pattern_formatter.h"

namespace thunderhead::app {
namespace {

// Writes the message of a line, made printable.
class PrintableMessage final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/,
              spdlog::memory_buf_t& line) override {
    const std::string text = base::Printable({message.payload.data(), message.payload.size()},
                                             {.max_bytes = base::kMaxLineBytes});
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableMessage>();
  }
};

}  // namespace

std::unique_ptr<spdlog::formatter> TextFormatter() {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableMessage>('*').set_pattern("[%Y-%m-%d %H:%M:%S.%e] [%n] [%^%l%$] %*");
  return formatter;
}

std::string JsonString(const std::string& text) {
  google::protobuf::Value value;
  value.set_string_value(base::Printable(text, {.max_bytes = base::kMaxLineBytes}));
  std::string json;
  (void)google::protobuf::util::MessageToJsonString(value, &json);
  return json;
}

void JsonFormatter::format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) {
  const std::string time = absl::FormatTime("%E4Y-%m-%dT%H:%M:%E3SZ",
                                            absl::FromChrono(message.time), absl::UTCTimeZone());
  const auto level = spdlog::level::to_string_view(message.level);
  const std::string text = absl::StrCat(
      "{\"time\":\"", time, "\",\"level\":\"", std::string(level.data(), level.size()),
      "\",\"message\":", JsonString({message.payload.data(), message.payload.size()}), "}\n");
  line.append(text.data(), text.data() + text.size());
}

std::unique_ptr<spdlog::formatter> JsonFormatter::clone() const {
  return std::make_unique<JsonFormatter>();
}

}  // namespace thunderhead::app
