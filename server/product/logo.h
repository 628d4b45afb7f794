// A picture that is laid over products, such as the mark of who publishes them.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

// Cairo's own name, so that who passes a logo on needs no header of Cairo.
struct _cairo_surface;  // NOLINT(bugprone-reserved-identifier)

namespace thunderhead::product {

class Logo {
 public:
  // A PNG of at most 4096 x 4096 pixels, which may be transparent. `what` names it in errors:
  // DATA_LOSS for anything else.
  static absl::StatusOr<Logo> Decode(std::string_view png, const std::string& what);

  _cairo_surface* Surface() const { return surface_.get(); }

 private:
  explicit Logo(std::shared_ptr<_cairo_surface> surface) : surface_(std::move(surface)) {}

  std::shared_ptr<_cairo_surface> surface_;
};

}  // namespace thunderhead::product
