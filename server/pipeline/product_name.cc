#include "pipeline/product_name.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "base/status.h"
#include "base/utf8.h"

namespace thunderhead::pipeline {
namespace {

constexpr std::string_view kFields =
    "{storm}, {view}, {time}, {run:%Y%m%d%H}, {valid:%Y%m%d_%H%M}, {lead:03d} or {lead_min:04d}";
constexpr std::string_view kConversions = "YymdjHMS";
constexpr int kWidest = 12;

bool IsTime(std::string_view field) { return field == "run" || field == "valid"; }
bool IsNumber(std::string_view field) {
  return field == "lead" || field == "lead_min" || field == "time";
}

// Returns true if the format has at least one conversion and all of them are in kConversions.
bool IsTimeFormat(std::string_view format) {
  bool any = false;
  for (std::size_t i = 0; i < format.size(); ++i) {
    if (format[i] == '/') return false;
    if (format[i] != '%') continue;
    if (++i == format.size() || kConversions.find(format[i]) == std::string_view::npos) {
      return false;
    }
    any = true;
  }
  return any;
}

// Returns the width of a format; "03d" is 3.
std::optional<int> WidthOf(std::string_view format) {
  if (format.size() < 2 || format.front() != '0' || format.back() != 'd') return std::nullopt;
  int width = 0;
  const char* end = format.data() + format.size() - 1;
  const auto [parsed, error] = std::from_chars(format.data(), end, width);
  if (error != std::errc() || parsed != end || width > kWidest) return std::nullopt;
  return width;
}

std::string Formatted(std::string_view format, absl::Time time) {
  // Years before 1000 must have four digits too, so %Y is replaced by %E4Y.
  const std::string four =
      absl::StrReplaceAll(absl::string_view(format.data(), format.size()), {{"%Y", "%E4Y"}});
  return absl::FormatTime(four, time, absl::UTCTimeZone());
}

bool IsControl(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7f;
}

// Returns INVALID_ARGUMENT if the text of a field would choose the folder of the product, or would
// forge lines where the name is printed.
absl::Status CheckText(std::string_view field, std::string_view text) {
  const bool fits = text != "." && text != ".." && text.find('/') == std::string_view::npos &&
                    std::ranges::none_of(text, IsControl);
  if (fits) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "{", absl::string_view(field.data(), field.size()), "} is '", base::Printable(text),
      "', which cannot be part of a file name; leave the field out, or rename what it names"));
}

std::string Described(const ProductKey& key) {
  return absl::StrCat("storm ", key.storm, ", valid ", Formatted("%Y-%m-%dT%H:%M:%SZ", key.valid),
                      ", view ", key.view);
}

}  // namespace

absl::StatusOr<ProductName::Part> ProductName::ParseField(std::string_view field) {
  const std::size_t colon = field.find(':');
  const bool formatted = colon != std::string_view::npos;
  Part part;
  part.field = std::string(field.substr(0, colon));
  part.format = formatted ? std::string(field.substr(colon + 1)) : "";
  if (IsTime(part.field)) {
    if (IsTimeFormat(part.format)) return part;
    return absl::InvalidArgumentError(
        absl::StrCat("needs a time format made of %Y %y %m %d %j %H %M %S, such as {", part.field,
                     ":%Y%m%d%H}"));
  }
  if (IsNumber(part.field)) {
    const std::optional<int> width = formatted ? WidthOf(part.format) : std::optional<int>(0);
    if (!width.has_value()) {
      return absl::InvalidArgumentError(
          absl::StrCat("needs a width such as {", part.field, ":03d}, or none"));
    }
    part.width = *width;
    return part;
  }
  if ((part.field == "storm" || part.field == "view") && !formatted) return part;
  return absl::InvalidArgumentError(
      absl::StrCat("is not one of ", absl::string_view(kFields.data(), kFields.size())));
}

absl::StatusOr<ProductName> ProductName::Parse(std::string_view flag, std::string_view text) {
  const std::string what = absl::StrCat(absl::string_view(flag.data(), flag.size()), " is '",
                                        absl::string_view(text.data(), text.size()), "'; ");
  if (text.empty() || text.back() == '/') {
    return absl::InvalidArgumentError(absl::StrCat(what, "it must name a file"));
  }
  ProductName name;
  name.text_ = std::string(text);
  while (!text.empty()) {
    const std::size_t open = text.find_first_of("{}");
    if (open != 0) name.parts_.push_back({"", std::string(text.substr(0, open))});
    if (open == std::string_view::npos) break;
    const std::size_t close = text.find('}', open);
    if (text[open] == '}' || close == std::string_view::npos) {
      return absl::InvalidArgumentError(absl::StrCat(what, "it has an unmatched brace"));
    }
    const std::string_view field = text.substr(open + 1, close - open - 1);
    absl::StatusOr<Part> part = ParseField(field);
    if (!part.ok()) {
      return base::Annotate(part.status(), absl::StrCat(what, "{", std::string(field), "}"));
    }
    name.parts_.push_back(*std::move(part));
    text.remove_prefix(close + 1);
  }
  return name;
}

absl::StatusOr<std::string> ProductName::For(const ProductKey& key) const {
  std::string name;
  for (const Part& part : parts_) {
    const bool of_run = part.field == "run" || part.field == "lead" || part.field == "lead_min";
    if (of_run && !key.run.has_value()) {
      return absl::InvalidArgumentError(
          absl::StrCat("'", text_, "' asks for {", part.field, "}, but the files of storm ",
                       key.storm, " do not say when their run began; use {valid:...}"));
    }
    if (part.field.empty()) {
      absl::StrAppend(&name, part.format);
    } else if (part.field == "storm" || part.field == "view") {
      const std::string& text = part.field == "storm" ? key.storm : key.view;
      THUNDERHEAD_RETURN_IF_ERROR(CheckText(part.field, text));
      absl::StrAppend(&name, text);
    } else if (part.field == "time") {
      absl::StrAppendFormat(&name, "%0*d", part.width, key.time_index);
    } else if (part.field == "run" || part.field == "valid") {
      absl::StrAppend(&name, Formatted(part.format, part.field == "run" ? *key.run : key.valid));
    } else {
      const absl::Duration unit = part.field == "lead" ? absl::Hours(1) : absl::Minutes(1);
      absl::Duration rest;
      absl::StrAppendFormat(&name, "%0*d", part.width, absl::IDivDuration(key.Lead(), unit, &rest));
    }
  }
  return name;
}

bool ProductName::Has(std::string_view field) const {
  return std::ranges::any_of(parts_, [field](const Part& part) { return part.field == field; });
}

std::string ProductName::Folder() const {
  const std::string fixed = parts_.front().field.empty() ? parts_.front().format : "";
  const std::size_t slash = fixed.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : fixed.substr(0, slash);
}

absl::Status CheckDistinct(const ProductName& name, const std::vector<ProductKey>& keys) {
  std::map<std::string, const ProductKey*> known;
  for (const ProductKey& key : keys) {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::string path, name.For(key));
    const auto [at, added] = known.try_emplace(std::move(path), &key);
    if (added) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("two products would both be '", at->first, "' (", Described(*at->second),
                     "; and ", Described(key),
                     "): add a field that tells them apart, such as {valid:%Y%m%d_%H%M} or "
                     "{view}; nothing was drawn"));
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::pipeline
