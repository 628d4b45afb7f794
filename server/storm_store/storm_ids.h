// The ids that a server gave to its storms. They are kept across a restart, so that a file that
// appeared meanwhile does not get the id of another storm with the same name.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "storm_store/storm_catalogue.h"

namespace thunderhead::storm_store {

class StormIds {
 public:
  // The most entries that are kept. A storm needs up to two.
  static constexpr std::size_t kMost = 100'000;

  StormIds() = default;
  // Reads what ToText wrote. Entries that are cut short are left out.
  explicit StormIds(std::string_view text);
  std::string ToText() const;

  // Returns the id of the storm if it is known. A storm is known by its stem and its first or last
  // file.
  std::optional<std::string> Of(const CataloguedStorm& storm) const;
  void Set(const CataloguedStorm& storm, const std::string& id);
  // Adds the entries of `earlier` whose ids `is_free` accepts. Their storms may come back, for
  // example when a disk is mounted.
  template <typename IsFree>
  void AddEarlier(const StormIds& earlier, const IsFree& is_free) {
    for (const auto& [key, id] : earlier.ids_) {
      if (ids_.size() >= kMost) return;
      if (is_free(id)) ids_.emplace(key, id);
    }
  }

  bool operator==(const StormIds&) const = default;

 private:
  std::map<std::pair<std::string, std::string>, std::string> ids_;  // by stem and file
};

}  // namespace thunderhead::storm_store
