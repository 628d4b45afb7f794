// SHA-256 of bytes that are added piece by piece.
#pragma once

#include <openssl/evp.h>

#include <memory>
#include <string>
#include <string_view>

namespace thunderhead::streams {

class Sha256Digest {
 public:
  Sha256Digest();

  void Add(std::string_view bytes);
  // Returns the digest in lower-case hexadecimal, as sha256sum prints it. Nothing may be added
  // afterwards.
  std::string Hexadecimal();

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace thunderhead::streams
