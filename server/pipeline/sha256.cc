#include "pipeline/sha256.h"

#include <fstream>
#include <vector>

#include "absl/strings/str_cat.h"
#include "streams/sha256_digest.h"

namespace thunderhead::pipeline {
namespace {

constexpr std::size_t kPieceBytes = 1 << 20;

}  // namespace

std::string Sha256(std::string_view bytes) {
  streams::Sha256Digest digest;
  digest.Add(bytes);
  return digest.Hexadecimal();
}

absl::StatusOr<std::string> Sha256OfFile(const std::string& path, const std::stop_token& stop) {
  std::ifstream file(path, std::ios::binary);
  streams::Sha256Digest digest;
  std::vector<char> piece(kPieceBytes);
  while (file) {
    if (stop.stop_requested()) return absl::CancelledError(absl::StrCat(path, ": interrupted"));
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    digest.Add({piece.data(), static_cast<std::size_t>(file.gcount())});
  }
  if (!file.eof()) {
    return absl::UnavailableError(absl::StrCat(path, ": cannot be read; check the path"));
  }
  return digest.Hexadecimal();
}

}  // namespace thunderhead::pipeline
