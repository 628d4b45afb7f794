#include "sandbox/archive.h"

#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace thunderhead::sandbox {

std::optional<std::size_t> SharedPlaces::Next(std::size_t bytes) {
  constexpr std::size_t kSmall = 64 << 10;
  constexpr std::size_t kAlignment = 64;
  if (bytes < kSmall || bytes > size_ - used_) return std::nullopt;
  const std::size_t place = used_;
  used_ = std::min(size_, place + (bytes + kAlignment - 1) / kAlignment * kAlignment);
  return place;
}

void Populate(std::span<const std::byte> memory, Use use) {
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t before = reinterpret_cast<std::uintptr_t>(memory.data()) % page;
  madvise(const_cast<std::byte*>(memory.data()) - before, memory.size() + before,
          use == Use::kWriting ? MADV_POPULATE_WRITE : MADV_POPULATE_READ);
}

void PrepareForArray(std::span<std::byte> memory) {
  constexpr std::uintptr_t kHugePage = 2 << 20;
  const std::uintptr_t first = reinterpret_cast<std::uintptr_t>(memory.data());
  const std::uintptr_t begin = (first + kHugePage - 1) / kHugePage * kHugePage;
  const std::uintptr_t end = (first + memory.size()) / kHugePage * kHugePage;
  if (begin >= end) return;
  madvise(memory.data() + (begin - first), end - begin, MADV_HUGEPAGE);
}

void Sender::Write(const void* bytes, std::size_t count) {
  const auto* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = write(pipe_, from, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    from += written;
    count -= static_cast<std::size_t>(written);
  }
}

bool Receiver::Read(void* bytes, std::size_t count) {
  auto* to = static_cast<char*>(bytes);
  while (Ok() && count > 0) {
    if (!AwaitBytes()) return false;
    const ssize_t got = read(pipe_, to, count);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      failure_ = Failure::kEnded;
      return false;
    }
    anything_came_ = true;
    to += got;
    count -= static_cast<std::size_t>(got);
  }
  return Ok();
}

bool Receiver::AwaitBytes() {
  using std::chrono::milliseconds;
  // The longest pause between two checks of stop_.
  const std::int64_t most_ms = stop_.stop_possible() ? 100 : 60'000;
  while (true) {
    if (stop_.stop_requested()) {
      failure_ = Failure::kStopped;
      return false;
    }
    const auto start = time_.Now();
    pollfd ready{pipe_, POLLIN, 0};
    const auto longest = std::min(patience_, longest_silence_ - silence_);
    const auto look_again_after = time_.LookAgainAt(start + longest) - base::SteadyTime().Now();
    const auto wait = std::chrono::ceil<milliseconds>(look_again_after).count();
    const int found = poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(wait, 0, most_ms)));
    const auto waited = time_.Now() - start;
    patience_ -= waited;
    silence_ += waited;
    if (found > 0) {
      silence_ = {};
      return true;
    }
    if (found < 0 && errno != EINTR) {
      failure_ = Failure::kEnded;
      return false;
    }
    if (patience_ <= std::chrono::nanoseconds::zero()) {
      failure_ = Failure::kTooLate;
      return false;
    }
    if (silence_ < longest_silence_) continue;
    if (!is_excused_()) {
      failure_ = Failure::kSilent;
      return false;
    }
    silence_ = {};
  }
}

}  // namespace thunderhead::sandbox
