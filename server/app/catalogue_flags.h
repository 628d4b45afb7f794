// The flags of `thunderhead serve` that control how it follows its folders of storms.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "storm_store/storm_store.h"

namespace thunderhead::app {

struct CatalogueFlags {
  double rescan_s = 30.0;
  double settle_s = 3.0;
  std::vector<std::string> untrusted;
  std::vector<std::string> allowed_links;
};

void AddCatalogueFlags(CLI::App& command, CatalogueFlags& flags);

storm_store::LinkPolicy LinksOf(const CatalogueFlags& flags);

// Returns nothing if the list of storms should stay as it was at the start.
std::optional<storm_store::LiveCatalogueOptions> LiveCatalogueOf(const CatalogueFlags& flags);

}  // namespace thunderhead::app
