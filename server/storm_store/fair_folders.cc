#include "storm_store/fair_folders.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

namespace thunderhead::storm_store {
namespace {

// Returns the index behind the next component of `path`, which begins at `from` or after the
// slashes there. Returns the path's length if there is no further component.
std::size_t EndOfComponent(const std::string& path, std::size_t from) {
  const std::size_t begin = path.find_first_not_of('/', from);
  return begin == std::string::npos ? path.size() : std::min(path.find('/', begin), path.size());
}

// Returns the keys of a folder: those of the folders above it from the top, its own, and one for
// its own files. These files count as one more subfolder.
std::vector<std::string> KeysOf(const std::string& folder) {
  std::vector<std::string> keys;
  for (std::size_t end = 0; end < folder.size();) {
    end = EndOfComponent(folder, end);
    keys.push_back(folder.substr(0, end));
  }
  keys.push_back(folder + "/");
  return keys;
}

}  // namespace

bool FolderOrder::operator()(const std::string& one, const std::string& other) const {
  return std::ranges::lexicographical_compare(
      one, other, {}, [](char c) { return c == '/' ? 0 : static_cast<unsigned char>(c); },
      [](char c) { return c == '/' ? 0 : static_cast<unsigned char>(c); });
}

FairFolders::Share& FairFolders::ShareOf(const std::string& key) {
  const auto [at, is_new] = shares_.try_emplace(key);
  if (is_new) at->second.came = ++came_;
  return at->second;
}

const std::string& FairFolders::Next(const FolderSet& waiting) {
  // At each level, the candidates are in the range from `begin` to `end`, and have the first
  // `length` characters in common.
  auto begin = waiting.begin();
  auto end = waiting.end();
  std::size_t length = 0;
  while (std::next(begin) != end) {
    auto best_begin = begin;
    auto best_end = end;
    std::size_t best_length = 0;
    std::tuple<double, std::uint64_t> best{};
    for (auto group = begin; group != end;) {
      const bool is_own = group->size() == length;
      const std::size_t next = EndOfComponent(*group, length);
      const std::string key = is_own ? *group + "/" : group->substr(0, next);
      auto group_end = std::next(group);
      while (!is_own && group_end != end && group_end->compare(0, next, key) == 0 &&
             (group_end->size() == next || (*group_end)[next] == '/')) {
        ++group_end;
      }
      const Share& share = ShareOf(key);
      const std::tuple candidate(share.used_s, share.came);
      if (best_length == 0 || candidate < best) {
        best = candidate;
        best_begin = group;
        best_end = group_end;
        best_length = std::max<std::size_t>(next, 1);
      }
      group = group_end;
    }
    if (best_begin->size() == length) return *best_begin;
    begin = best_begin;
    end = best_end;
    length = best_length;
  }
  return *begin;
}

void FairFolders::Used(const std::string& folder, double seconds) {
  for (const std::string& key : KeysOf(folder)) ShareOf(key).used_s += seconds;
}

void FairFolders::KeepOnly(const FolderSet& waiting) {
  std::set<std::string> kept;
  for (const std::string& folder : waiting) {
    for (std::string& key : KeysOf(folder)) kept.insert(std::move(key));
  }
  std::erase_if(shares_, [&](const auto& share) { return !kept.contains(share.first); });
}

}  // namespace thunderhead::storm_store
