#include "storm_store/storm_ids.h"

#include "base/digits.h"

namespace thunderhead::storm_store {
namespace {

// Returns the next part of `text` up to a zero byte, which no path contains, and removes it.
// Returns nothing if there is no further zero byte.
std::optional<std::string> NextPart(std::string_view& text) {
  const std::size_t end = text.find('\0');
  if (end == std::string_view::npos) return std::nullopt;
  std::string part(text.substr(0, end));
  text.remove_prefix(end + 1);
  return part;
}

// Returns whether the store could have made `id` of `stem`.
bool IsIdOf(const std::string& stem, std::string_view id) {
  if (!id.starts_with(stem)) return false;
  id.remove_prefix(stem.size());
  return id.empty() || (id.front() == '-' && base::IsDigits(id.substr(1)));
}

}  // namespace

StormIds::StormIds(std::string_view text) {
  while (ids_.size() < kMost) {
    const auto stem = NextPart(text);
    const auto file = NextPart(text);
    const auto id = NextPart(text);
    if (!id.has_value()) return;
    if (IsIdOf(*stem, *id)) ids_[{*stem, *file}] = *id;
  }
}

std::string StormIds::ToText() const {
  std::string text;
  for (const auto& [key, id] : ids_) {
    for (const std::string* part : {&key.first, &key.second, &id})
      text.append(*part).push_back('\0');
  }
  return text;
}

std::optional<std::string> StormIds::Of(const CataloguedStorm& storm) const {
  if (storm.info.files.empty()) return std::nullopt;
  for (const std::string* file : {&storm.info.files.front(), &storm.info.files.back()}) {
    const auto known = ids_.find({storm.stem, *file});
    if (known != ids_.end()) return known->second;
  }
  return std::nullopt;
}

void StormIds::Set(const CataloguedStorm& storm, const std::string& id) {
  if (storm.info.files.empty() || ids_.size() + 2 > kMost) return;
  ids_[{storm.stem, storm.info.files.front()}] = id;
  ids_[{storm.stem, storm.info.files.back()}] = id;
}

}  // namespace thunderhead::storm_store
