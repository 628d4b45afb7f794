// Log lines as JSON, an object each: time, level, message.
#pragma once

#include <memory>
#include <string>

#include "spdlog/formatter.h"

namespace thunderhead::app {

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override;
  std::unique_ptr<spdlog::formatter> clone() const override;
};

// The text as a JSON string, with its quotes. Bytes that are not UTF-8 become question marks.
std::string JsonString(const std::string& text);

}  // namespace thunderhead::app
