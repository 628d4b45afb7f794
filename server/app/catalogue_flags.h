// How `thunderhead serve` follows its folders of storms, as flags.
#pragma once

#include <optional>

#include "CLI/CLI.hpp"
#include "volume/storm_store.h"

namespace thunderhead::app {

struct CatalogueFlags {
  double rescan_s = 30.0;
  double settle_s = 3.0;
};

void AddCatalogueFlags(CLI::App& command, CatalogueFlags& flags);

// Nothing where the storms are to stay those of the start.
std::optional<volume::LiveCatalogueOptions> LiveCatalogueOf(const CatalogueFlags& flags);

}  // namespace thunderhead::app
