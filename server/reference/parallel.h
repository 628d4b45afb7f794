// Runs independent tasks on all cores or on a given number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace thunderhead::reference {

// Calls work(0) to work(count - 1) in any order and returns when all calls have returned. If
// `threads` is 0, it uses as many threads as the machine has. It never uses more than that. If a
// call throws, it starts no further calls and throws the exception again.
void ParallelFor(int threads, int count, const std::function<void(int)>& work);

// Runs `count` small tasks in the same way. A thread takes a block of up to `block` tasks at a time
// and calls work(begin, end).
void ParallelForBlocks(int threads, std::size_t count, std::size_t block,
                       const std::function<void(std::size_t, std::size_t)>& work);

}  // namespace thunderhead::reference
