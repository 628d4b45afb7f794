// A fair scheduler: it chooses the client that has used the least processing time so far. It is a
// plain value type.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace thunderhead::base {

class FairShare {
 public:
  // Returns the client of `waiting` that has used the least time, or the first of several with
  // equal times. `waiting` must not be empty. A client that is new, or that returns after a pause,
  // starts with the least time of the waiting clients that are already known.
  std::string Next(const std::vector<std::string>& waiting);
  // Considers only the clients for which `may` returns true. Returns nothing if there is no such
  // client.
  std::optional<std::string> Next(const std::vector<std::string>& waiting,
                                  const std::function<bool(const std::string&)>& may);

  // Adds `milliseconds` to the time that the client has used. A negative value corrects an earlier
  // charge that was too high.
  void Used(const std::string& id, double milliseconds);

 private:
  std::map<std::string, double> used_ms_;  // time used by each client in `waiting` of the last call
                                           // of Next
};

}  // namespace thunderhead::base
