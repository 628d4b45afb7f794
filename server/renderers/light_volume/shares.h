// Runs work on many cells in parallel, in ranges (shares) of equal size.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace thunderhead::renderers {

// Number of cells in a range that one thread processes at a time. Sums are computed for each range
// and added in order, so they do not depend on the number of threads.
inline constexpr std::size_t kShare = 4096;

// Divides `count` cells into ranges and calls `work` with the first cell of each range and the cell
// after its last.
template <typename Work>
void ForShares(std::size_t count, const Work& work, std::size_t in_share = kShare) {
  tbb::parallel_for(std::size_t{0}, (count + in_share - 1) / in_share, [&](std::size_t share) {
    work(share * in_share, std::min((share + 1) * in_share, count));
  });
}

}  // namespace thunderhead::renderers
