// Tests of access control: tokens and their file, JWTs, quotas, and the audit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jwt.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <openssl/sha.h>
#include <openssl/x509.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "access/access_control.h"
#include "access/jwt_key.h"
#include "access/rules.h"
#include "access/secret_file.h"
#include "access/token_list.h"
#include "base/error_details.h"
#include "tests/support/captured_log.h"
#include "tests/support/manual_time.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::access {
namespace {

using std::chrono::seconds;
using std::chrono::system_clock;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string Sha256(const std::string& text) {
  std::string digest(SHA256_DIGEST_LENGTH, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(),
         reinterpret_cast<unsigned char*>(digest.data()));
  return absl::BytesToHexString(digest);
}

std::string LineOf(const std::string& name, const std::string& role, const std::string& token) {
  return absl::StrCat(name, " ", role, " ", Sha256(token), "\n");
}

// A clock that stands still. The timeout of reading a file therefore never expires, however slow
// the machine is.
const base::TimeSource& StandingTime() {
  static const testing::ManualTime time;
  return time;
}

class SecretFile {
 public:
  explicit SecretFile(const std::string& text) { Write(text); }
  void Write(const std::string& text) {
    // The file is replaced in one step, as an administrator should do it.
    const std::string next = folder_.File("next");
    std::ofstream(next) << text;
    std::filesystem::permissions(next, std::filesystem::perms::owner_read);
    std::filesystem::rename(next, Path());
  }
  std::string Path() const { return folder_.File("tokens"); }

 private:
  testing::TemporaryFolder folder_;
};

TEST(TokenListTest, FindsTheNameAndRoleOfAToken) {
  const auto list = TokenList::Parse("# people\n\n" + LineOf("anna", "presenter", "one") +
                                     LineOf("night-run", "pipeline", "two"));
  ASSERT_TRUE(list.ok()) << list.status();
  const auto anna = list->Find("one");
  ASSERT_TRUE(anna.has_value());
  EXPECT_EQ(anna->name, "anna");
  EXPECT_EQ(anna->role, Role::kPresenter);
  EXPECT_EQ(list->Find("two")->role, Role::kPipeline);
  EXPECT_FALSE(list->Find("three").has_value());
  EXPECT_FALSE(list->Find("").has_value());
  // The file contains hashes of tokens. A hash itself is not a valid token.
  EXPECT_FALSE(list->Find(Sha256("one")).has_value());
}

TEST(TokenListTest, WrongLinesAreNamedAndNotRepeated) {
  const std::string good = LineOf("anna", "viewer", "one");
  const auto complaint = [&](const std::string& line) {
    return std::string(TokenList::Parse(good + line).status().message());
  };
  EXPECT_THAT(complaint("ben viewer hunter2"), HasSubstr("line 2"));
  EXPECT_THAT(complaint("ben viewer hunter2"), Not(HasSubstr("hunter2")));
  EXPECT_THAT(complaint("ben king " + Sha256("x")), HasSubstr("'king' is not a role"));
  EXPECT_THAT(complaint("ben viewer"), HasSubstr("three words"));
  EXPECT_THAT(std::string(TokenList::Parse("# nobody\n").status().message()),
              HasSubstr("no one could use the server"));
}

TEST(TokenFileTest, IsReadAgainWhenItChanges) {
  SecretFile file(LineOf("anna", "viewer", "one"));
  const auto tokens = TrustTokens(file.Path(), StandingTime());
  ASSERT_TRUE(tokens.ok()) << tokens.status();
  EXPECT_TRUE((*tokens)->Identify({"one", ""}).ok());
  file.Write(LineOf("ben", "viewer", "two"));
  EXPECT_TRUE(absl::IsUnauthenticated((*tokens)->Identify({"one", ""}).status()));
  EXPECT_TRUE((*tokens)->Identify({"two", ""}).ok());
  // A mistake in the file locks no user out.
  file.Write("ben viewer");
  EXPECT_TRUE((*tokens)->Identify({"two", ""}).ok());
}

TEST(TokenFileTest, AFileThatOthersMayReadOrWriteIsRefused) {
  SecretFile file(LineOf("anna", "viewer", "one"));
  for (const auto wrong : {std::filesystem::perms::others_read, std::filesystem::perms::group_write,
                           std::filesystem::perms::others_write}) {
    std::filesystem::permissions(file.Path(), std::filesystem::perms::owner_read | wrong);
    EXPECT_THAT(std::string(TrustTokens(file.Path(), StandingTime()).status().message()),
                HasSubstr("chmod"))
        << static_cast<int>(wrong);
  }
  std::filesystem::permissions(
      file.Path(), std::filesystem::perms::owner_read | std::filesystem::perms::group_read);
  EXPECT_TRUE(TrustTokens(file.Path(), StandingTime()).ok());
}

struct Claims {
  std::string subject = "anna";
  std::string role = "presenter";
  std::string issuer;
  std::string audience;
  std::string json;  // a JSON object with further claims
  long expires_in_s = 600;
  long begins_in_s = 0;
};

class JwtTest : public ::testing::Test {
 protected:
  // The time of all tokens and all checks, however long a test takes.
  static inline const system_clock::time_point kNow = system_clock::now();

  // Signs a token whose header also contains the fields of a JSON object.
  static std::string Sign(const Claims& claims, jwt_alg_t algorithm, const std::string& key,
                          const std::string& header = "") {
    jwt_t* jwt = nullptr;
    jwt_new(&jwt);
    if (!header.empty()) jwt_add_headers_json(jwt, header.c_str());
    const long now = system_clock::to_time_t(kNow);
    if (!claims.subject.empty()) jwt_add_grant(jwt, "sub", claims.subject.c_str());
    if (!claims.role.empty()) jwt_add_grant(jwt, "thunderhead_role", claims.role.c_str());
    if (!claims.issuer.empty()) jwt_add_grant(jwt, "iss", claims.issuer.c_str());
    if (!claims.audience.empty()) jwt_add_grant(jwt, "aud", claims.audience.c_str());
    if (!claims.json.empty()) jwt_add_grants_json(jwt, claims.json.c_str());
    if (claims.expires_in_s != 0) jwt_add_grant_int(jwt, "exp", now + claims.expires_in_s);
    if (claims.begins_in_s != 0) jwt_add_grant_int(jwt, "nbf", now + claims.begins_in_s);
    const bool none = algorithm == JWT_ALG_NONE;
    EXPECT_EQ(jwt_set_alg(jwt, algorithm,
                          none ? nullptr : reinterpret_cast<const unsigned char*>(key.data()),
                          none ? 0 : static_cast<int>(key.size())),
              0);
    char* text = jwt_encode_str(jwt);
    std::string token = text == nullptr ? "" : text;
    std::free(text);
    jwt_free(jwt);
    return token;
  }

  std::string Sign(const Claims& claims = {}) const { return Sign(claims, JWT_ALG_HS256, secret_); }

  std::string SignWithHeader(const std::string& header) const {
    return Sign({}, JWT_ALG_HS256, secret_, header);
  }

  // Signs a token of any header and claims by HS256, without libjwt, which would change them.
  std::string SignText(const std::string& header, const std::string& claims) const {
    std::string text =
        absl::StrCat(absl::WebSafeBase64Escape(header), ".", absl::WebSafeBase64Escape(claims));
    std::string signature(SHA256_DIGEST_LENGTH, '\0');
    HMAC(EVP_sha256(), secret_.data(), static_cast<int>(secret_.size()),
         reinterpret_cast<const unsigned char*>(text.data()), text.size(),
         reinterpret_cast<unsigned char*>(signature.data()), nullptr);
    return absl::StrCat(text, ".", absl::WebSafeBase64Escape(signature));
  }

  // Returns valid claims, preceded by `more`, such as "\"x\": 1,".
  static std::string AnnasClaims(const std::string& more) {
    return absl::StrCat("{", more, R"("sub": "anna", "thunderhead_role": "viewer", "exp": )",
                        system_clock::to_time_t(kNow) + 600, "}");
  }

  // Returns the error; empty if the token is accepted.
  std::string Complaint(const std::string& token, const JwtClaims& wanted = {}) const {
    const auto identity = JwtKey::Parse(secret_)->Verify(token, wanted, kNow);
    return std::string(identity.status().message());
  }

  const std::string kHeader = R"({"alg":"HS256","typ":"JWT"})";
  const std::string secret_ = std::string(32, 's');
};

TEST_F(JwtTest, ASignedTokenIsBelieved) {
  const auto identity = JwtKey::Parse(secret_ + "\n")->Verify(Sign(), {}, kNow);
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->name, "anna");
  EXPECT_EQ(identity->role, Role::kPresenter);
  ASSERT_TRUE(identity->expires_at.has_value());
}

TEST_F(JwtTest, ForgedTokensAreNot) {
  EXPECT_THAT(Complaint(Sign({}, JWT_ALG_HS256, std::string(32, 'x'))), HasSubstr("not signed"));
  EXPECT_THAT(Complaint(Sign({}, JWT_ALG_NONE, "")), HasSubstr("has no signature"));
  EXPECT_THAT(Complaint(Sign({}, JWT_ALG_HS512, std::string(64, 's'))),
              HasSubstr("another algorithm (alg) than HS256"));
  // Changes the payload under the signature.
  std::string token = Sign();
  const std::string other = Sign({.subject = "otto"});
  token.replace(token.find('.'), token.rfind('.') - token.find('.'), other, other.find('.'),
                other.rfind('.') - other.find('.'));
  EXPECT_THAT(Complaint(token), HasSubstr("not signed"));
  // Removes the signature, as with alg none.
  EXPECT_THAT(Complaint(token.substr(0, token.rfind('.') + 1)), HasSubstr("has no signature"));
  EXPECT_THAT(Complaint("nonsense"), HasSubstr("the form"));
  EXPECT_THAT(Complaint(std::string(10'000, 'a')), HasSubstr("too long"));
}

TEST_F(JwtTest, NothingMayFollowAPart) {
  const std::string token = Sign();
  for (const char* const more : {"=", "==", "!", "=forged", " ", "\n", ".", ".x", "%00"}) {
    EXPECT_THAT(Complaint(token + more), HasSubstr("the form")) << more;
  }
  EXPECT_THAT(Complaint(absl::StrReplaceAll(token, {{".", "=."}})), HasSubstr("the form"));
  EXPECT_EQ(Complaint(token), "");
}

// RFC 7515, 4.1.11: a token whose extensions are not understood must be refused.
TEST_F(JwtTest, ExtensionsAreNotUnderstood) {
  EXPECT_EQ(Complaint(SignWithHeader("")), "");
  EXPECT_THAT(Complaint(SignWithHeader(R"({"crit": ["exp"], "exp": 1})")), HasSubstr("(crit)"));
  EXPECT_THAT(Complaint(SignWithHeader(R"({"crit": []})")), HasSubstr("(crit)"));
}

TEST_F(JwtTest, TimesAndClaimsAreChecked) {
  EXPECT_EQ(Complaint(Sign({.expires_in_s = -10})),
            "");  // expired, but within the tolerated clock difference
  EXPECT_THAT(Complaint(Sign({.expires_in_s = -60})), HasSubstr("has expired"));
  EXPECT_THAT(Complaint(Sign({.expires_in_s = 0})), HasSubstr("no time at which it expires"));
  EXPECT_EQ(Complaint(Sign({.expires_in_s = 253'402'300'799})), "") << "beyond the year 9999";
  EXPECT_THAT(Complaint(Sign({.begins_in_s = 120})), HasSubstr("not valid yet"));
  EXPECT_THAT(Complaint(Sign({.begins_in_s = 253'402'300'799})), HasSubstr("not valid yet"));
  // These are kNow plus an hour, in forms that are not whole numbers.
  const auto later = std::chrono::system_clock::to_time_t(kNow) + 3600;
  EXPECT_THAT(Complaint(Sign({.json = absl::StrCat("{\"nbf\": ", later, ".5}")})),
              HasSubstr("not valid yet"));
  for (const std::string& no_time : {absl::StrCat("\"", later, "\""), std::string("null"),
                                     std::string("[]"), std::string("true")}) {
    EXPECT_THAT(Complaint(Sign({.json = absl::StrCat("{\"nbf\": ", no_time, "}")})),
                HasSubstr("from which it is valid (nbf) that is not a number"))
        << no_time;
    EXPECT_THAT(
        Complaint(Sign({.json = absl::StrCat("{\"exp\": ", no_time, "}"), .expires_in_s = 0})),
        HasSubstr("at which it expires (exp) that is not a number"))
        << no_time;
  }
  EXPECT_EQ(Complaint(Sign({.json = absl::StrCat("{\"exp\": ", later, ".5}"), .expires_in_s = 0})),
            "");
  for (const char* const past : {"0", "-1", "1", "0.5"}) {
    EXPECT_THAT(Complaint(Sign({.json = absl::StrCat("{\"exp\": ", past, "}"), .expires_in_s = 0})),
                HasSubstr("has expired"))
        << past;
  }
  EXPECT_EQ(Complaint(Sign({.json = "{\"nbf\": 1.5}"})), "");
  EXPECT_THAT(Complaint(Sign({.subject = ""})), HasSubstr("(sub)"));
  EXPECT_THAT(Complaint(Sign({.role = ""})), HasSubstr("no role"));
  EXPECT_THAT(Complaint(Sign({.role = "king"})),
              HasSubstr("has another role (thunderhead_role) than viewer, presenter"));
  EXPECT_THAT(Complaint(Sign({.role = "", .json = R"({"thunderhead_role": ["operator"]})"})),
              HasSubstr("has a claim thunderhead_role that is not a text"));
  EXPECT_THAT(Complaint(Sign({.subject = std::string(65, 'a')})),
              HasSubstr("has a name (sub) of 65 bytes, and 1 to 64 are allowed"));
  EXPECT_THAT(Complaint(Sign({.subject = "", .json = R"({"sub": 5})"})),
              HasSubstr("has a claim sub that is not a text"));
  EXPECT_THAT(Complaint(Sign(), {.issuer = "us"}), HasSubstr("(iss)"));
  EXPECT_EQ(Complaint(Sign({.issuer = "us"}), {.issuer = "us"}), "");
  EXPECT_THAT(Complaint(Sign({.audience = "mail"}), {.audience = "storms"}), HasSubstr("(aud)"));
  EXPECT_EQ(Complaint(Sign({.audience = "storms"}), {.audience = "storms"}), "");
  // A list of audiences is valid for each text in the list, but not for a part of such a text.
  for (const char* const list : {R"(["storms"])", R"(["mail", "storms"])"}) {
    const std::string json = absl::StrCat(R"({"aud": )", list, "}");
    EXPECT_EQ(Complaint(Sign({.json = json}), {.audience = "storms"}), "") << list;
  }
  for (const char* const other : {R"(["mail"])", R"([{"storms": 1}])", R"([["storms"]])",
                                  R"({"storms": 1})", "[]", "1", R"(["mail\",\"storms"])"}) {
    const std::string json = absl::StrCat(R"({"aud": )", other, "}");
    EXPECT_THAT(Complaint(Sign({.json = json}), {.audience = "storms"}), HasSubstr("(aud)"))
        << other;
  }
}

TEST_F(JwtTest, ClaimsAreOneJsonObjectAndNothingElse) {
  const std::string object = AnnasClaims("");
  EXPECT_EQ(Complaint(SignText(kHeader, object)), "");
  EXPECT_EQ(Complaint(SignText(kHeader, "\r\n " + object + " \n")), "");
  const std::string nul(1, '\0');
  for (const std::string& text :
       {object + nul, object + nul + "x", object + object, nul + object, "\xef\xbb\xbf" + object,
        std::string(R"({"exp": 1e400})"), std::string("null"), std::string("[]"), std::string("{"),
        std::string("\"\xff\"")}) {
    EXPECT_THAT(Complaint(SignText(kHeader, text)),
                HasSubstr("has claims that are not a valid JSON object"))
        << text;
  }
  EXPECT_THAT(Complaint(SignText(kHeader + nul, object)),
              HasSubstr("header fields that are not a valid JSON object"));
  EXPECT_THAT(Complaint(SignText("{}", object)), HasSubstr("without the algorithm"));
}

TEST_F(JwtTest, UnusualClaimsAreNotCalledAWrongSignature) {
  EXPECT_EQ(Complaint(SignText(kHeader, AnnasClaims(R"("x": 18446744073709551616,)"))), "");
  EXPECT_EQ(Complaint(SignText(kHeader, AnnasClaims("\"x\": " + std::string(2000, '[') +
                                                    std::string(2000, ']') + ","))),
            "");
  EXPECT_EQ(Complaint(SignText(kHeader, AnnasClaims(R"("x": "a\u0000b",)"))), "");
  EXPECT_THAT(Complaint(SignText(kHeader, R"({"sub": "anna\u0000", "exp": 18446744073709551616})")),
              HasSubstr("NUL character"));
}

// RFC 9068, 2.1: the access tokens of identity providers have the type at+jwt.
TEST_F(JwtTest, TheTypeIsThatOfAnAccessTokenOrNone) {
  const std::string claims = AnnasClaims("");
  const auto header = [](const std::string& type) {
    return absl::StrCat(R"({"alg":"HS256","typ":)", type, "}");
  };
  EXPECT_EQ(Complaint(SignText(R"({"alg":"HS256"})", claims)), "");
  for (const char* const type : {R"("JWT")", R"("jwt")", R"("at+jwt")", R"("AT+JWT")",
                                 R"("application/at+jwt")", R"("application/jwt")"}) {
    EXPECT_EQ(Complaint(SignText(header(type), claims)), "") << type;
    EXPECT_THAT(Complaint(SignText(header(type), claims) + "A"), HasSubstr("not signed")) << type;
  }
  EXPECT_EQ(Complaint(SignWithHeader(R"({"typ": "at+jwt"})")), "");
  for (const char* const type :
       {R"("dpop+jwt")", R"("")", R"("JWT ")", "5", "null", R"(["JWT"])"}) {
    EXPECT_EQ(Complaint(SignText(header(type), claims)),
              "the token has another type (typ) than JWT or at+jwt")
        << type;
  }
}

// Another spelling of the same signature, which differs in bits that encode nothing.
TEST_F(JwtTest, ASignatureHasOneSpelling) {
  std::string token = Sign();
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  token.back() = letters[letters.find(token.back()) ^ 1];
  EXPECT_THAT(Complaint(token), HasSubstr("the form"));
  token = Sign();
  EXPECT_THAT(Complaint(token.substr(0, token.size() - 3)), HasSubstr("not signed"));
}

// RFC 7519, 4.1.3 forbids to accept tokens for others.
TEST(JwtAudienceTest, AServerWithoutAudienceSaysSo) {
  const SecretFile file(std::string(32, 's'));
  const testing::CapturedLog log;
  ASSERT_TRUE(TrustJwt(file.Path(), {.audience = "storms"}).ok());
  EXPECT_EQ(log.Text(), "");
  ASSERT_TRUE(TrustJwt(file.Path(), {.issuer = "us"}).ok());
  EXPECT_THAT(log.Text(), HasSubstr("give --jwt-audience"));
}

TEST_F(JwtTest, APublicKeyIsForRs256Alone) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> pair(EVP_RSA_gen(2048), &EVP_PKEY_free);
  const auto pem = [&](auto write) {
    const std::unique_ptr<BIO, decltype(&BIO_free)> bytes(BIO_new(BIO_s_mem()), &BIO_free);
    write(bytes.get());
    char* text = nullptr;
    const long size = BIO_get_mem_data(bytes.get(), &text);
    return std::string(text, static_cast<std::size_t>(size));
  };
  const std::string public_key = pem([&](BIO* out) { PEM_write_bio_PUBKEY(out, pair.get()); });
  const std::string private_key = pem([&](BIO* out) {
    PEM_write_bio_PrivateKey(out, pair.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
  const auto key = JwtKey::Parse(public_key);
  ASSERT_TRUE(key.ok()) << key.status();
  const std::string token = Sign({}, JWT_ALG_RS256, private_key);
  EXPECT_TRUE(key->Verify(token, {}, kNow).ok());
  EXPECT_FALSE(key->Verify(token + "=forged", {}, kNow).ok());
  EXPECT_FALSE(key->Verify(token + "AAAA", {}, kNow).ok());
  // The public key is known to all, so it must not be accepted as if it were a secret to sign with.
  EXPECT_FALSE(key->Verify(Sign({}, JWT_ALG_HS256, public_key), {}, kNow).ok());
  EXPECT_FALSE(key->Verify(Sign({}, JWT_ALG_NONE, ""), {}, kNow).ok());
  EXPECT_THAT(std::string(JwtKey::Parse(private_key).status().message()),
              HasSubstr("not a public RSA key"));
  EXPECT_THAT(std::string(JwtKey::Parse("short").status().message()), HasSubstr("32"));
}

// A public key in another form than PEM must not become the secret of HS256, because everyone knows
// it.
TEST(JwtSecretTest, AKeyInAnotherFormIsNoSecret) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> pair(EVP_RSA_gen(2048), &EVP_PKEY_free);
  const auto written = [](auto write) {
    const std::unique_ptr<BIO, decltype(&BIO_free)> bytes(BIO_new(BIO_s_mem()), &BIO_free);
    EXPECT_GT(write(bytes.get()), 0);
    char* text = nullptr;
    const long size = BIO_get_mem_data(bytes.get(), &text);
    return std::string(text, static_cast<std::size_t>(size));
  };
  const auto complaint = [](const std::string& text) {
    const auto key = JwtKey::Parse(text);
    return std::string(key.ok() ? "" : key.status().message());
  };
  const std::string der = written([&](BIO* out) { return i2d_PUBKEY_bio(out, pair.get()); });
  const std::string pem = written([&](BIO* out) { return PEM_write_bio_PUBKEY(out, pair.get()); });
  const std::string private_der =
      written([&](BIO* out) { return i2d_PrivateKey_bio(out, pair.get()); });
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(X509_new(), &X509_free);
  X509_set_pubkey(certificate.get(), pair.get());
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), 0);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), 60);
  ASSERT_GT(X509_sign(certificate.get(), pair.get(), EVP_sha256()), 0);
  const std::string certificate_der =
      written([&](BIO* out) { return i2d_X509_bio(out, certificate.get()); });
  for (const std::string& bytes : {der, private_der, certificate_der}) {
    EXPECT_THAT(complaint(bytes), HasSubstr("in DER"));
    EXPECT_THAT(complaint(absl::Base64Escape(bytes)), HasSubstr("in base64"));
    EXPECT_THAT(complaint(absl::WebSafeBase64Escape(bytes)), HasSubstr("in base64"));
  }
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> curve(EVP_EC_gen("P-256"),
                                                                  &EVP_PKEY_free);
  const std::string curve_der = written([&](BIO* out) { return i2d_PUBKEY_bio(out, curve.get()); });
  EXPECT_THAT(complaint(absl::Base64Escape(curve_der)), HasSubstr("in base64")) << "124 characters";

  const std::size_t begin = pem.find('\n') + 1;
  EXPECT_THAT(complaint(pem.substr(begin, pem.rfind("-----END") - begin)), HasSubstr("in base64"));
  EXPECT_THAT(complaint(pem.substr(5)), HasSubstr("like PEM"));
  std::string little = "\xff\xfe";
  for (const char each : pem) little.append({each, '\0'});
  EXPECT_THAT(complaint(little), HasSubstr("UTF-16"));
  EXPECT_THAT(complaint(little.substr(2)), HasSubstr("UTF-16")) << "without a byte order mark";
  EXPECT_THAT(complaint("\xef\xbb\xbf" + std::string(64, 's')), HasSubstr("byte order mark"));

  const std::string modulus = absl::WebSafeBase64Escape(std::string(256, '\x9f'));
  EXPECT_THAT(complaint(absl::StrCat(R"({"kty":"RSA","e":"AQAB","n":")", modulus, "\"}")),
              HasSubstr("JWK"));
  EXPECT_THAT(complaint(R"({"kty":"EC","crv":"P-256","x":"AAAAAAAAAAAAAAAAA","y":"AAAAA"},)"),
              HasSubstr("JWK"));
  EXPECT_THAT(complaint(R"(["AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"])"), HasSubstr("JWK"));
  const std::string curve_line = "AAAAC3NzaC1lZDI1NTE5AAAAI" + std::string(43, 'a');
  EXPECT_THAT(complaint("ssh-ed25519 " + curve_line + " anna"), HasSubstr("OpenSSH"));
  EXPECT_THAT(complaint(curve_line), HasSubstr("OpenSSH"));
  EXPECT_THAT(complaint("no-pty ssh-ed25519 " + curve_line), HasSubstr("OpenSSH"));
  EXPECT_THAT(complaint("ecdsa-sha2-nistp256 AAAAE2VjZHNh" + std::string(99, 'a')),
              HasSubstr("OpenSSH"));
  EXPECT_THAT(complaint(modulus), HasSubstr("at most 256 bytes")) << "a form without a name";
}

TEST(JwtSecretTest, ASecretIsOneLineOfText) {
  for (const std::string& text : {std::string(32, 's'), std::string(256, 'f'),
                                  "3082" + std::string(60, '0'), "MIIB" + std::string(40, 'a'),
                                  std::string("a phrase of more than 32 bytes, gr\u00fc\u00df"),
                                  std::string("{not JSON, but a phrase of more than 32 bytes")}) {
    EXPECT_TRUE(JwtKey::Parse(text).ok()) << text;
    EXPECT_TRUE(JwtKey::Parse(text + "\r\n").ok()) << text;
  }
  for (const std::string& text :
       {std::string(31, 's'), std::string(257, 's'), std::string(40, '\xc8'),
        std::string(32, 's') + "\n" + std::string(32, 's'), std::string(40, '\x1b'),
        std::string(40, '\0'), std::string()}) {
    EXPECT_FALSE(JwtKey::Parse(text).ok()) << text;
  }
}

TEST(QuotasTest, RequestsComeBackWithTime) {
  Quotas quotas({.requests_per_second = 10.0});
  const auto start = Quotas::Time();
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(quotas.TakeRequest("anna", start).ok()) << i;
  const absl::Status refused = quotas.TakeRequest("anna", start);
  EXPECT_TRUE(absl::IsResourceExhausted(refused));
  EXPECT_EQ(base::DetailsOf(refused).retry_after, std::chrono::milliseconds(100));
  EXPECT_TRUE(quotas.TakeRequest("ben", start).ok());
  EXPECT_TRUE(quotas.TakeRequest("anna", start + std::chrono::milliseconds(100)).ok());
}

TEST(QuotasTest, StreamsAreGivenBack) {
  Quotas quotas({.max_streams = 3, .max_streams_per_identity = 2});
  auto one = quotas.TakeStream("anna");
  auto two = quotas.TakeStream("anna");
  EXPECT_TRUE(absl::IsResourceExhausted(quotas.TakeStream("anna").status()));
  auto three = quotas.TakeStream("ben");
  EXPECT_TRUE(absl::IsResourceExhausted(quotas.TakeStream("carl").status()));
  one->reset();
  EXPECT_TRUE(quotas.TakeStream("carl").ok());
}

TEST(QuotasTest, UnreadAnswersAreLimitedInBytes) {
  constexpr std::size_t kMiB = std::size_t{1} << 20;
  Quotas quotas({.max_unread_bytes = 10 * kMiB, .max_unread_bytes_per_identity = 4 * kMiB});
  auto one = quotas.TakeAnswer("anna", 3 * kMiB);
  ASSERT_TRUE(one.ok());
  const absl::Status refused = quotas.TakeAnswer("anna", 2 * kMiB).status();
  EXPECT_TRUE(absl::IsResourceExhausted(refused));
  EXPECT_EQ(base::DetailsOf(refused).reason, "ANSWERS_NOT_TAKEN");
  EXPECT_TRUE(base::DetailsOf(refused).retry_after.has_value());
  EXPECT_FALSE(quotas.TakeUnread("anna", 2 * kMiB).ok()) << "streams share the memory";
  EXPECT_TRUE(quotas.TakeAnswer("anna", Quotas::kSmallMessage_bytes).ok());
  one->reset();
  EXPECT_TRUE(quotas.TakeAnswer("anna", 2 * kMiB).ok()) << "the memory is given back";
}

TEST(QuotasTest, OneLargeAnswerIsAlwaysPossible) {
  constexpr std::size_t kMiB = std::size_t{1} << 20;
  Quotas quotas({.max_unread_bytes = 10 * kMiB, .max_unread_bytes_per_identity = 4 * kMiB});
  auto small = quotas.TakeAnswer("anna", kMiB);
  auto large = quotas.TakeAnswer("ben", 20 * kMiB);
  ASSERT_TRUE(large.ok());
  EXPECT_FALSE(quotas.TakeAnswer("carl", kMiB).ok()) << "the total is reached";
  EXPECT_TRUE(quotas.TakeAnswer("carl", Quotas::kSmallMessage_bytes).ok());
  large->reset();
  EXPECT_TRUE(quotas.TakeAnswer("carl", kMiB).ok());
}

TEST(AuditTest, ALineCannotBeForged) {
  std::vector<std::string> lines;
  Audit audit([&](const std::string& line) { lines.push_back(line); });
  audit.Write({"an\"na\nverdict=allowed", "viewer", "192.0.2.7:1", "CloseSession"},
              base::WithDetails(absl::PermissionDeniedError("the key 'secret' is wrong"),
                                {.reason = "NOT_PRESENTER"}),
              Audit::Clock::time_point(seconds(1'700'000'000)));
  EXPECT_THAT(lines, ElementsAre("audit time=2023-11-14T22:13:20.000Z "
                                 "identity=\"an\\x22na\\x0averdict=allowed\" role=viewer "
                                 "peer=\"192.0.2.7:1\" act=CloseSession verdict=refused "
                                 "reason=\"NOT_PRESENTER\""));
}

TEST(AuditTest, AFloodOfRefusalsIsCounted) {
  std::vector<std::string> lines;
  Audit audit([&](const std::string& line) { lines.push_back(line); });
  const auto now = Audit::Clock::time_point(seconds(1'700'000'000));
  for (int i = 0; i < 1000; ++i)
    audit.Write({"", "", "", "X"}, absl::UnauthenticatedError(""), now);
  EXPECT_EQ(lines.size(), 50U);
  audit.Write({"", "", "", "X"}, absl::OkStatus(), now);
  EXPECT_EQ(lines.size(), 51U);
  audit.Write({"", "", "", "X"}, absl::UnauthenticatedError(""), now + seconds(1));
  EXPECT_THAT(lines.back(), HasSubstr("left_out=950"));
}

TEST(AuditTest, AFloodBeforeCallsHidesNoRefusedCall) {
  std::vector<std::string> lines;
  Audit audit([&](const std::string& line) { lines.push_back(line); });
  const auto now = Audit::Clock::time_point(seconds(1'700'000'000));
  const absl::Status refused = absl::ResourceExhaustedError("");
  for (int i = 0; i < 1000; ++i) audit.Write({"", "", "", "Connect", true}, refused, now);
  EXPECT_EQ(lines.size(), 50U);
  audit.Write({"", "", "", "CreateSession"}, absl::UnauthenticatedError(""), now);
  ASSERT_EQ(lines.size(), 51U);
  EXPECT_THAT(lines.back(), HasSubstr("act=CreateSession"));
  EXPECT_THAT(lines.back(), Not(HasSubstr("left_out")));
  audit.Write({"", "", "", "Connect", true}, refused, now + seconds(1));
  EXPECT_THAT(lines.back(), HasSubstr("left_out=950"));
}

TEST(AccessControlTest, WhatTheGatewayRefusesIsWrittenWithoutAnIdentity) {
  std::vector<std::string> lines;
  SecretFile file(LineOf("anna", "viewer", "one"));
  AccessControl access_control(
      *TrustTokens(file.Path(), StandingTime()),
      std::make_shared<Audit>([&](const std::string& line) { lines.push_back(line); }), {});
  access_control.ReportBeforeCall("192.0.2.7:1", "Request",
                                  base::WithDetails(absl::PermissionDeniedError("evil.example"),
                                                    {.reason = "HOST_NOT_ALLOWED"}));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(lines[0], HasSubstr("identity=\"\" role=none peer=\"192.0.2.7:1\" act=Request "
                                  "verdict=refused reason=\"HOST_NOT_ALLOWED\""));
}

TEST(AccessControlTest, ATokenThatIsTakenAwayEndsWhatItOpened) {
  std::vector<std::string> lines;
  SecretFile file(LineOf("anna", "viewer", "one"));
  AccessControl access_control(
      *TrustTokens(file.Path(), StandingTime()),
      std::make_shared<Audit>([&](const std::string& line) { lines.push_back(line); }), {});
  const auto caller = access_control.Admit("Interact", CallKind::kStream, {"one", "192.0.2.7:1"});
  ASSERT_TRUE(caller.ok()) << caller.status();
  const auto now = std::chrono::steady_clock::now();
  EXPECT_TRUE((*caller)->StillKnown(now).ok());
  EXPECT_THAT(lines, IsEmpty());
  file.Write(LineOf("anna", "operator", "one"));
  EXPECT_TRUE(absl::IsUnauthenticated((*caller)->StillKnown(now + seconds(2))));
  file.Write(LineOf("ben", "viewer", "two"));
  EXPECT_TRUE(absl::IsUnauthenticated((*caller)->StillKnown(now + seconds(4))));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_THAT(lines[0], HasSubstr("identity=\"anna\" role=viewer peer=\"192.0.2.7:1\" act=Interact "
                                  "verdict=refused"));
}

TEST(AccessControlTest, ItsOwnTokenIsAnOperators) {
  SecretFile file(LineOf("anna", "viewer", "one"));
  AccessControl access_control(*TrustTokens(file.Path(), StandingTime()),
                               std::make_shared<Audit>([](const std::string&) {}), {});
  EXPECT_TRUE(
      access_control.Admit("RenderImage", CallKind::kUnary, {access_control.OwnToken(), ""}).ok());
  std::string other = access_control.OwnToken();
  other.back() = other.back() == '0' ? '1' : '0';
  EXPECT_FALSE(access_control.Admit("RenderImage", CallKind::kUnary, {other, ""}).ok());
}

TEST(RulesTest, WhatHasNoRuleIsNobodys) {
  EXPECT_FALSE(HasRule("NewCall"));
  EXPECT_FALSE(MayCall(Role::kOperator, "NewCall"));
}

}  // namespace
}  // namespace thunderhead::access
