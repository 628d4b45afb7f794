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
      .add_option("--rescan-seconds", flags.rescan_s,
                  "How often the --data folders are looked through for what the kernel does not "
                  "tell, as on a network file system; 0: the storms stay those of the start")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  command
      .add_option("--settle-seconds", flags.settle_s,
                  "How long a file must have stayed the same to count as complete")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command.add_option("--untrusted", flags.untrusted,
                     "Folders in which others may put files: no symbolic link there is followed");
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
