// An input stream over bytes in memory, without a copy. Its position can be set.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <streambuf>

namespace thunderhead::interchange {

class MemoryBuffer final : public std::streambuf {
 public:
  // `progress` receives the share of the bytes before the place of reading, 0 to 1, about a hundred
  // times.
  MemoryBuffer(std::span<const std::byte> bytes, std::function<void(double share)> progress);

 protected:
  std::streamsize xsgetn(char* to, std::streamsize count) override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type place, std::ios_base::openmode which) override;

 private:
  std::function<void(double share)> progress_;
  std::ptrdiff_t reported_ = 0;  // place of the last report
};

}  // namespace thunderhead::interchange
