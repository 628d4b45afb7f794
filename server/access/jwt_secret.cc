#include "access/jwt_secret.h"

#include <openssl/asn1.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/utf8.h"
#include "nlohmann/json.hpp"

namespace thunderhead::access {
namespace {

// The minimum length of a secret (RFC 7518, 3.2).
constexpr std::size_t kMinSecretBytes = 32;
// The maximum length of a secret. A public RSA key of 2048 bits is longer: its modulus alone has
// 342 characters in base64url.
constexpr std::size_t kMaxSecretBytes = 256;

// Reads the header of the ASN.1 element at the start of `bytes`. Returns its tag, or -1 if it is
// incomplete, and moves `bytes` to its contents.
int EnterElement(std::string_view* bytes) {
  const auto* const start = reinterpret_cast<const unsigned char*>(bytes->data());
  const unsigned char* at = start;
  long length = 0;
  int tag = 0;
  int kind = 0;
  const int result = ASN1_get_object(&at, &length, &tag, &kind, static_cast<long>(bytes->size()));
  constexpr int kFailed = 0x80;
  if ((result & kFailed) != 0 || kind != V_ASN1_UNIVERSAL) return -1;
  *bytes = bytes->substr(static_cast<std::size_t>(at - start), static_cast<std::size_t>(length));
  return tag;
}

// Returns whether the bytes are a key or a certificate in DER: a sequence that ends with the bytes
// and begins with a number or with another sequence.
bool IsDer(std::string_view bytes) {
  std::string_view contents = bytes;
  if (EnterElement(&contents) != V_ASN1_SEQUENCE || contents.empty()) return false;
  if (contents.data() + contents.size() != bytes.data() + bytes.size()) return false;
  const int first = EnterElement(&contents);
  return first == V_ASN1_SEQUENCE || first == V_ASN1_INTEGER;
}

bool IsDerInBase64(const std::string& text) {
  std::string bytes;
  return (absl::Base64Unescape(text, &bytes) || absl::WebSafeBase64Unescape(text, &bytes)) &&
         IsDer(bytes);
}

bool IsJson(const std::string& text) {
  constexpr bool kThrows = false;
  return absl::StrContains(text, "\"kty\"") ||
         nlohmann::json::parse(text, nullptr, kThrows).is_structured();
}

// Returns whether the text is or contains a public key of OpenSSH. The base64 text of such a key
// begins with the encoded name of its kind.
bool IsOfOpenSsh(std::string_view text) {
  constexpr std::array<std::string_view, 4> kKinds = {"ssh-", "ecdsa-", "sk-ssh-", "sk-ecdsa-"};
  constexpr std::array<std::string_view, 5> kInBase64 = {"AAAAB3NzaC", "AAAAC3NzaC", "AAAAE2VjZHNh",
                                                         "AAAAGnNrLX", "AAAAInNrLW"};
  return std::ranges::any_of(kKinds,
                             [&](std::string_view kind) { return text.starts_with(kind); }) ||
         std::ranges::any_of(kInBase64, [&](std::string_view start) {
           return text.find(start) != std::string_view::npos;
         });
}

bool IsUtf16(std::string_view text) {
  return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
         text.find('\0') != std::string_view::npos;
}

bool IsOnePrintableLine(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = base::Utf8CharacterBytes(text);
    if (bytes == 0 || absl::ascii_iscntrl(static_cast<unsigned char>(text.front()))) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

absl::Status RefusedForm(const std::string& seems, const std::string& todo) {
  return absl::InvalidArgumentError(
      absl::StrCat("the JWT key seems to be ", seems, ", not PEM and not a secret: ", todo));
}

absl::Status CheckIsNoKey(const std::string& text) {
  if (IsDer(text)) {
    return RefusedForm(
        "a key or certificate in DER",
        "convert a public key with openssl pkey -pubin -inform DER -outform PEM, and a "
        "certificate with openssl x509 -inform DER -pubkey -noout");
  }
  if (IsDerInBase64(text)) {
    return RefusedForm(
        "a key or certificate in base64",
        "decode it with openssl base64 -d -A, then convert a public key with openssl "
        "pkey -pubin -inform DER -outform PEM");
  }
  if (absl::StartsWith(text, "\xef\xbb\xbf")) {
    return RefusedForm("text with a byte order mark", "save it as UTF-8 without that mark");
  }
  if (IsUtf16(text)) return RefusedForm("binary or UTF-16", "save it as plain text (UTF-8)");
  if (IsJson(text)) {
    return RefusedForm("JSON, such as a key in JWK", "ask its issuer for the public key in PEM");
  }
  if (IsOfOpenSsh(text)) {
    return RefusedForm("a key of OpenSSH", "convert it with ssh-keygen -e -m PKCS8 -f FILE");
  }
  if (absl::StrContains(text, "BEGIN ")) {
    return RefusedForm("a key in a form like PEM",
                       "convert a private key with openssl pkey -pubout -outform PEM, and a key of "
                       "OpenSSH with ssh-keygen -e -m PKCS8 -f FILE");
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckSecret(const std::string& text) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckIsNoKey(text));
  constexpr char kMakeOne[] = "make a secret with openssl rand -hex 32";
  if (text.size() < kMinSecretBytes) {
    return absl::InvalidArgumentError(absl::StrCat("the JWT key has ", text.size(),
                                                   " bytes; a secret for HS256 needs at least ",
                                                   kMinSecretBytes, ": ", kMakeOne));
  }
  if (text.size() > kMaxSecretBytes || !IsOnePrintableLine(text)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the JWT key is neither PEM nor a secret for HS256, which is one line of printable text of "
        "at most ",
        kMaxSecretBytes, " bytes: convert a public key with openssl pkey -pubin -outform PEM, or ",
        kMakeOne));
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::access
