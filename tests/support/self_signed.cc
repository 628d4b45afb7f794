#include "tests/support/self_signed.h"

#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "base/status.h"

namespace thunderhead::testing {
namespace {

constexpr long kDay_s = 86'400;

void AddExtension(X509* certificate, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, value), &X509_EXTENSION_free);
  THUNDERHEAD_CHECK(extension != nullptr, value);
  X509_add_ext(certificate, extension.get(), -1);
}

template <typename Write>
void WritePem(const std::string& path, Write write) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> bytes(BIO_new(BIO_s_mem()), &BIO_free);
  THUNDERHEAD_CHECK(write(bytes.get()) == 1, path);
  char* text = nullptr;
  const long size = BIO_get_mem_data(bytes.get(), &text);
  const std::string next = path + ".next";
  std::ofstream(next).write(text, size);
  std::filesystem::permissions(next, std::filesystem::perms::owner_read);
  std::filesystem::rename(next, path);
}

}  // namespace

void WriteSelfSigned(const std::string& certificate_path, const std::string& key_path,
                     long serial) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"),
                                                                &EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(X509_new(), &X509_free);
  X509* const x509 = certificate.get();
  X509_set_version(x509, X509_VERSION_3);
  ASN1_INTEGER_set(X509_get_serialNumber(x509), serial);
  X509_gmtime_adj(X509_getm_notBefore(x509), -kDay_s);
  X509_gmtime_adj(X509_getm_notAfter(x509), kDay_s);
  X509_set_pubkey(x509, key.get());
  X509_NAME* const name = X509_get_subject_name(x509);
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>("localhost"), -1, -1, 0);
  X509_set_issuer_name(x509, name);
  AddExtension(x509, NID_subject_alt_name, "DNS:localhost,IP:127.0.0.1");
  AddExtension(x509, NID_basic_constraints, "critical,CA:TRUE");
  THUNDERHEAD_CHECK(X509_sign(x509, key.get(), EVP_sha256()) > 0, "cannot sign");
  WritePem(key_path, [&](BIO* out) {
    return PEM_write_bio_PrivateKey(out, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
  WritePem(certificate_path, [&](BIO* out) { return PEM_write_bio_X509(out, x509); });
}

}  // namespace thunderhead::testing
