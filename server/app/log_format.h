// The two formats of log lines: text, and JSON with one object per line. Both make messages
// printable, so that a name from a file or from a client cannot forge a log line.
#pragma once

#include <memory>
#include <string>

#include "spdlog/formatter.h"

namespace thunderhead::app {

// Returns a formatter that writes time, logger, level and message, as spdlog does by default.
std::unique_ptr<spdlog::formatter> TextFormatter();

// A formatter that writes a JSON object with time, level and message.
class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override;
  std::unique_ptr<spdlog::formatter> clone() const override;
};

// Returns the text, made printable (base/utf8.h), as a JSON string including the quotes.
std::string JsonString(const std::string& text);

}  // namespace thunderhead::app
