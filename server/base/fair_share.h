// The next of those who wait: the one for whom least was done so far, in milliseconds. A plain
// value.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace thunderhead::base {

class FairShare {
 public:
  // One of `waiting`, which must not be empty; the first where several are equal. Newcomers, and
  // those who come back after a pause, start with as much as the one with least has had.
  std::string Next(const std::vector<std::string>& waiting);
  // One of those for whom `may` is true; none if there is none.
  std::optional<std::string> Next(const std::vector<std::string>& waiting,
                                  const std::function<bool(const std::string&)>& may);

  // So much was done for it, or less than was said if it is negative.
  void Used(const std::string& id, double milliseconds);

 private:
  std::map<std::string, double> used_ms_;  // of those that waited last
};

}  // namespace thunderhead::base
