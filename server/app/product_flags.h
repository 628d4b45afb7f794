// The flags of commands that write product files.
#pragma once

#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "runs/product_files.h"

namespace thunderhead::app {

struct ProductFlags {
  bool annotate = false;
  std::string title;  // if empty, the storm's title
  std::string logo;   // path of a PNG file; empty for no logo
  bool world_file = false;
};

void AddProductOptions(CLI::App& command, ProductFlags& flags);

// Returns the format that results from the extension of the product's name `path` and from the
// flags. INVALID_ARGUMENT names a wrong flag, and DATA_LOSS reports a bad logo.
absl::StatusOr<runs::ProductFormat> ProductFormatOf(const std::string& flag,
                                                    const std::string& path,
                                                    const ProductFlags& flags);

}  // namespace thunderhead::app
