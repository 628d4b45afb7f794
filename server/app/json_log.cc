#include "app/json_log.h"

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"

namespace thunderhead::app {
namespace {

std::string PrintableOf(std::string text) {
  google::protobuf::Value value;
  value.set_string_value(text);
  std::string json;
  if (google::protobuf::util::MessageToJsonString(value, &json).ok()) return json;
  for (char& c : text) {
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  }
  return JsonString(text);
}

}  // namespace

std::string JsonString(const std::string& text) { return PrintableOf(text); }

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
