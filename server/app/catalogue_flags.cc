#include "app/catalogue_flags.h"

#include <chrono>

namespace thunderhead::app {
namespace {

std::chrono::milliseconds Milliseconds(double seconds) {
  return std::chrono::round<std::chrono::milliseconds>(std::chrono::duration<double>(seconds));
}

}  // namespace

void AddCatalogueFlags(CLI::App& command, CatalogueFlags& flags) {
  command
      .add_option(
          "--rescan-seconds", flags.rescan_s,
          "Seconds between two searches of the --data folders, which find changes that the kernel "
          "does not report, such as on a network file system; 0: no search after the start")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  command
      .add_option("--settle-seconds", flags.settle_s,
                  "Seconds for which a file must be unchanged to count as complete")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command.add_option(
      "--untrusted", flags.untrusted,
      "Folders into which other people may put files; symbolic links in them are not followed");
  command.add_option(
      "--allow-links-to", flags.allowed_links,
      "Folders that symbolic links in the data folders may lead to; links into the data "
      "folders are always followed, and links in --untrusted folders never");
}

storm_store::LinkPolicy LinksOf(const CatalogueFlags& flags) {
  return {.allowed = flags.allowed_links, .untrusted = flags.untrusted};
}

std::optional<storm_store::LiveCatalogueOptions> LiveCatalogueOf(const CatalogueFlags& flags) {
  if (flags.rescan_s <= 0.0) return std::nullopt;
  return storm_store::LiveCatalogueOptions{.rescan = Milliseconds(flags.rescan_s),
                                           .settle = Milliseconds(flags.settle_s),
                                           .first_search = std::chrono::milliseconds(0)};
}

}  // namespace thunderhead::app
