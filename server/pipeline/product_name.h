// Names of products from a template, such as
// "out/{storm}_{run:%Y%m%d%H}_{valid:%Y%m%d_%H%M}_{lead:03d}_{view}.png".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace thunderhead::pipeline {

// The properties of a product that its name may contain.
struct ProductKey {
  std::string storm;
  std::optional<absl::Time> run;  // start of the run; absent if unknown
  absl::Time valid;
  // The lead time, if it is not the difference of `valid` and `run`, because the model counts in
  // another calendar.
  std::optional<absl::Duration> lead = {};
  int time_index = 0;  // index of the time in the run, counted from 0
  std::string view;

  // Returns the time since `run`, which must be known.
  absl::Duration Lead() const { return lead.value_or(valid - *run); }
};

class ProductName {
 public:
  // Parses a template. It may have these fields:
  //
  //   {storm}, {view}           texts
  //
  //   {run:%...}, {valid:%...}  times, in UTC, with strftime's %Y %y %m %d %j %H %M %S
  //
  //   {lead}, {lead_min}        hours or minutes since the run began
  //
  //   {time}                    the index of the time
  //
  // A number may have a width, as in {lead:03d}. INVALID_ARGUMENT names the wrong part and the
  // command-line option `flag`.
  static absl::StatusOr<ProductName> Parse(std::string_view flag, std::string_view text);

  // Returns the product's name. INVALID_ARGUMENT if the name needs the start of the run, which is
  // unknown. Also INVALID_ARGUMENT if the text of a field contains a slash or a control character,
  // or is "." or "..". The storm's id may come from a server or from the name of a file.
  absl::StatusOr<std::string> For(const ProductKey& key) const;

  // Returns true if the names contain a field, such as "view".
  bool Has(std::string_view field) const;

  const std::string& Text() const { return text_; }
  // Returns the deepest folder that contains all products; "." for the current folder.
  std::string Folder() const;

 private:
  // A field with its format; if `field` is empty, fixed text.
  struct Part {
    std::string field;
    std::string format;  // format of a time, or the fixed text
    int width = 0;       // width of a number, which is padded with zeros
  };

  static absl::StatusOr<Part> ParseField(std::string_view field);

  std::string text_;
  std::vector<Part> parts_;
};

// INVALID_ARGUMENT if two products of `keys` would have the same name. The error names both
// products.
absl::Status CheckDistinct(const ProductName& name, const std::vector<ProductKey>& keys);

}  // namespace thunderhead::pipeline
