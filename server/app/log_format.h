// The two formats of log lines: text, and JSON with one object per line. Both make a message
// printable, so that a name from a file or a client cannot forge a line.
#pragma once

#include <memory>
#include <string>

#include "spdlog/formatter.h"

namespace thunderhead::app {

// Returns a formatter for time, logger, level and message, as spdlog writes them by default.
std::unique_ptr<spdlog::formatter> TextFormatter();

// Writes an object with time, level and message.
class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override;
  std::unique_ptr<spdlog::formatter> clone() const override;
};

// Returns the text, made printable (base/utf8.h), as a JSON string with its quotes.
std::string JsonString(const std::string& text);

}  // namespace thunderhead::app
