// A picture that is drawn over products, such as the publisher's logo.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

// Cairo's own name, so that code that only passes a logo on needs no Cairo header.
struct _cairo_surface;  // NOLINT(bugprone-reserved-identifier)

namespace thunderhead::product {

class Logo {
 public:
  // Decodes a PNG of at most 4096 x 4096 pixels, which may be transparent. Returns DATA_LOSS for
  // anything else. The error names the file as `what`.
  static absl::StatusOr<Logo> Decode(std::string_view png, const std::string& what);

  _cairo_surface* Surface() const { return surface_.get(); }

 private:
  explicit Logo(std::shared_ptr<_cairo_surface> surface) : surface_(std::move(surface)) {}

  std::shared_ptr<_cairo_surface> surface_;
};

}  // namespace thunderhead::product
