// The next of those who wait: the one for whom least was done so far, in milliseconds. A plain
// value.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace thunderhead::jobs {

class FairShare {
 public:
  // One of `waiting`, which must not be empty; of several the first. Who is new, or comes back
  // after not having waited, begins with what was done for the one with least.
  std::string Next(const std::vector<std::string>& waiting);

  // So much was done for it, or less than was said if it is negative.
  void Used(const std::string& id, double milliseconds);

 private:
  std::map<std::string, double> used_ms_;  // of those that waited last
};

}  // namespace thunderhead::jobs
