// Fair scheduling: chooses the client that has used the least time so far, in milliseconds. A plain
// value type.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace thunderhead::base {

class FairShare {
 public:
  // Returns one of `waiting`, which must not be empty, or the first of several with the same time.
  // A client that is new, or that returns after a pause, starts with the least time of those
  // waiting.
  std::string Next(const std::vector<std::string>& waiting);
  // Returns one of those for which `may` is true, or nothing if there is none.
  std::optional<std::string> Next(const std::vector<std::string>& waiting,
                                  const std::function<bool(const std::string&)>& may);

  // Charges the client this time. A negative value corrects an earlier charge that was too high.
  void Used(const std::string& id, double milliseconds);

 private:
  std::map<std::string, double> used_ms_;  // only of the clients that waited last
};

}  // namespace thunderhead::base
