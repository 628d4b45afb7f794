// A service with access control, for tests of which role may make which call.
#pragma once

#include <grpcpp/generic/generic_stub.h>
#include <openssl/sha.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/escaping.h"
#include "access/access_control.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {

inline const std::vector<std::string> kRoles = {"viewer", "presenter", "pipeline", "operator"};

inline std::string TokenOf(const std::string& role) { return role + "-token"; }

inline std::string Sha256OfToken(const std::string& text) {
  std::string digest(SHA256_DIGEST_LENGTH, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(),
         reinterpret_cast<unsigned char*>(digest.data()));
  return absl::BytesToHexString(digest);
}

// A service that knows one token for each role.
class GuardedService {
 public:
  explicit GuardedService(service::ServerOptions options = Patient(),
                          access::QuotaLimits quotas = {}) {
    const std::string path = folder_.File("tokens");
    {
      std::ofstream file(path);
      for (const std::string& role : kRoles) {
        file << "a-" << role << " " << role << " " << Sha256OfToken(TokenOf(role)) << "\n";
      }
    }
    std::filesystem::permissions(path, std::filesystem::perms::owner_read);
    auto audit = std::make_shared<access::Audit>([this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      lines_.push_back(line);
    });
    options.access_control = std::make_shared<access::AccessControl>(
        *access::TrustTokens(path), audit, quotas, base::TrustedProxies(), *options.time);
    service_.emplace(options);
  }

  // Revokes the token of `role`.
  void TakeAwayToken(const std::string& role) {
    const std::string next = folder_.File("next");
    {
      std::ofstream file(next);
      for (const std::string& other : kRoles) {
        if (other == role) continue;
        file << "a-" << other << " " << other << " " << Sha256OfToken(TokenOf(other)) << "\n";
      }
    }
    std::filesystem::permissions(next, std::filesystem::perms::owner_read);
    std::filesystem::rename(next, folder_.File("tokens"));
  }

  FakeService& service() { return *service_; }
  v1::ThunderheadService::Stub& stub() { return service_->stub(); }

  std::vector<std::string> Audit() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

  // Calls any rpc with an empty request and returns the status code.
  grpc::StatusCode Ask(const std::string& method, const std::string& token,
                       const std::string& service = v1::ThunderheadService::service_full_name()) {
    grpc::GenericStub stub(service_->server().LocalChannel());
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    grpc::CompletionQueue queue;
    const auto await = [&queue] {
      void* tag = nullptr;
      bool ok = false;
      return queue.Next(&tag, &ok) && ok;
    };
    const auto call = stub.PrepareCall(&context, "/" + service + "/" + method, &queue);
    call->StartCall(nullptr);
    await();
    call->WriteLast(grpc::ByteBuffer(nullptr, 0), {}, nullptr);
    await();
    grpc::ByteBuffer reply;
    do {
      call->Read(&reply, nullptr);
    } while (await());
    grpc::Status status;
    call->Finish(&status, nullptr);
    await();
    queue.Shutdown();
    return status.error_code();
  }

  template <typename Method, typename Request, typename Response>
  grpc::Status Call(const std::string& role, Method method, const Request& request,
                    Response* response) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    context.AddMetadata("authorization", "Bearer " + TokenOf(role));
    return (stub().*method)(&context, request, response);
  }

  v1::CreateSessionResponse Create(const std::string& role = "presenter") {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = SmallScene();
    v1::CreateSessionResponse response;
    const grpc::Status status =
        Call(role, &v1::ThunderheadService::Stub::CreateSession, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

 private:
  TemporaryFolder folder_;
  std::mutex mutex_;
  std::vector<std::string> lines_;
  std::optional<FakeService> service_;
};

}  // namespace thunderhead::testing
