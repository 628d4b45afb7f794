#include "pipeline/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::pipeline {
namespace {

constexpr std::size_t kPieceBytes = 1 << 20;

class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    THUNDERHEAD_CHECK(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1, "SHA-256");
  }

  void Add(const char* bytes, std::size_t count) {
    THUNDERHEAD_CHECK(EVP_DigestUpdate(context_.get(), bytes, count) == 1, "SHA-256");
  }

  std::string Hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    THUNDERHEAD_CHECK(EVP_DigestFinal_ex(context_.get(), digest.data(), &size) == 1, "SHA-256");
    return absl::BytesToHexString(
        absl::string_view(reinterpret_cast<const char*>(digest.data()), size));
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string Sha256(std::string_view bytes) {
  Digest digest;
  digest.Add(bytes.data(), bytes.size());
  return digest.Hexadecimal();
}

absl::StatusOr<std::string> Sha256OfFile(const std::string& path, const std::stop_token& stop) {
  std::ifstream file(path, std::ios::binary);
  Digest digest;
  std::vector<char> piece(kPieceBytes);
  while (file) {
    if (stop.stop_requested()) return absl::CancelledError(absl::StrCat(path, ": interrupted"));
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    digest.Add(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) {
    return absl::UnavailableError(absl::StrCat(path, ": cannot be read; check the path"));
  }
  return digest.Hexadecimal();
}

}  // namespace thunderhead::pipeline
