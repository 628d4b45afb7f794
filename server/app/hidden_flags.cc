#include "app/hidden_flags.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace thunderhead::app {
namespace {

// The heading of the hidden flags in the file of --print-config.
constexpr char kHidden[] = "Rarely changed settings";

class Formatter final : public CLI::Formatter {
 public:
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    if (group == kHidden) return "";
    return CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
  }

  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    if (is_positional || option->get_lnames().size() < 2) {
      return CLI::Formatter::make_option_name(option, is_positional);
    }
    std::string names;
    for (const std::string& letter : option->get_snames()) names += "-" + letter + ",";
    return names + "--" + option->get_lnames().front();
  }
};

}  // namespace

void HideFromHelp(CLI::Option& option) { option.group(kHidden); }

std::shared_ptr<CLI::Formatter> HelpFormatter() { return std::make_shared<Formatter>(); }

}  // namespace thunderhead::app
