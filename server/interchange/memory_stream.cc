#include "interchange/memory_stream.h"

#include <utility>

namespace thunderhead::interchange {

MemoryBuffer::MemoryBuffer(std::span<const std::byte> bytes,
                           std::function<void(double share)> progress)
    : progress_(std::move(progress)) {
  // The cast is safe, because a stream buffer takes pointers to bytes that are not constant, but
  // reading never writes to them.
  char* const begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
  setg(begin, begin, begin + bytes.size());
}

std::streamsize MemoryBuffer::xsgetn(char* to, std::streamsize count) {
  const std::streamsize read = std::streambuf::xsgetn(to, count);
  constexpr std::ptrdiff_t kReports = 100;
  const std::ptrdiff_t size = egptr() - eback();
  const std::ptrdiff_t place = gptr() - eback();
  if (place - reported_ > size / kReports) {
    reported_ = place;
    progress_(static_cast<double>(place) / static_cast<double>(size));
  }
  return read;
}

std::streambuf::pos_type MemoryBuffer::seekoff(off_type offset, std::ios_base::seekdir from,
                                               std::ios_base::openmode) {
  const char* base = gptr();
  if (from == std::ios_base::beg) base = eback();
  if (from == std::ios_base::end) base = egptr();
  if (offset < eback() - base || offset > egptr() - base) return pos_type(off_type(-1));
  setg(eback(), eback() + (base - eback()) + offset, egptr());
  return pos_type(gptr() - eback());
}

std::streambuf::pos_type MemoryBuffer::seekpos(pos_type place, std::ios_base::openmode which) {
  return seekoff(off_type(place), std::ios_base::beg, which);
}

}  // namespace thunderhead::interchange
