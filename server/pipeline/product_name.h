// Names of products by a template, such as
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

// The contents of a product.
struct ProductKey {
  std::string storm;
  std::optional<absl::Time> run;  // when the run began; nothing if that is not known
  absl::Time valid;
  int time_index = 0;  // among the run's times
  std::string view;
};

class ProductName {
 public:
  // {storm}, {view}; {run:%...} and {valid:%...} with strftime's %Y %y %m %d %j %H %M %S, in UTC;
  // {lead}, hours since the run began, {lead_min}, minutes, and {time}, the index of the time, each
  // also with a width as in {lead:03d}. INVALID_ARGUMENT names the part that is wrong and `flag`.
  static absl::StatusOr<ProductName> Parse(std::string_view flag, std::string_view text);

  // INVALID_ARGUMENT if the name needs a start of the run that is not known.
  absl::StatusOr<std::string> For(const ProductKey& key) const;

  // True if names depend on a field, such as "view".
  bool Has(std::string_view field) const;

  const std::string& Text() const { return text_; }
  // The deepest folder that all products are in, "." if that is the current one.
  std::string Folder() const;

 private:
  // A field with its format, or fixed text if `field` is empty.
  struct Part {
    std::string field;
    std::string format;  // of times, or the text
    int width = 0;       // of numbers, filled with zeros
  };

  static absl::StatusOr<Part> ParseField(std::string_view field);

  std::string text_;
  std::vector<Part> parts_;
};

// INVALID_ARGUMENT, naming both, if two products of `keys` would have one name.
absl::Status CheckDistinct(const ProductName& name, const std::vector<ProductKey>& keys);

}  // namespace thunderhead::pipeline
