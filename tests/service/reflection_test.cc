// Tests gRPC's reflection as tools use it, and clients that misuse it.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "grpc/reflection/v1alpha/reflection.grpc.pb.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/service/guarded_service.h"
#include "tests/support/running_time.h"
#include "tests/support/wait_for.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::testing {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::FileDescriptorProto;
using grpc::reflection::v1alpha::ServerReflection;
using grpc::reflection::v1alpha::ServerReflectionRequest;
using grpc::reflection::v1alpha::ServerReflectionResponse;
using ::testing::UnorderedElementsAre;

// A reflection call without a token.
class Asking {
 public:
  explicit Asking(service::Server& server)
      : stub_(ServerReflection::NewStub(server.LocalChannel())) {
    context_.set_deadline(std::chrono::system_clock::now() + kPatience);
    call_ = stub_->ServerReflectionInfo(&context_);
  }
  ~Asking() {
    context_.TryCancel();
    if (!ended_) End();
  }
  Asking(const Asking&) = delete;
  Asking& operator=(const Asking&) = delete;

  // Returns whether the server has answered.
  bool Ask(const ServerReflectionRequest& request, ServerReflectionResponse* response) {
    return call_->Write(request) && call_->Read(response);
  }
  ServerReflectionResponse Answer(const ServerReflectionRequest& request) {
    ServerReflectionResponse response;
    EXPECT_TRUE(Ask(request, &response));
    return response;
  }
  std::vector<std::string> ListServices() {
    ServerReflectionRequest request;
    request.set_list_services("");
    const ServerReflectionResponse response = Answer(request);
    std::vector<std::string> names;
    for (const auto& service : response.list_services_response().service()) {
      names.push_back(service.name());
    }
    return names;
  }
  ServerReflectionResponse Find(const std::string& symbol) {
    ServerReflectionRequest request;
    request.set_file_containing_symbol(symbol);
    return Answer(request);
  }
  // Ends the client's side and returns how the call ended.
  grpc::Status Close() {
    call_->WritesDone();
    return End();
  }
  // Waits for the end of the call.
  grpc::Status End() {
    ServerReflectionResponse response;
    while (call_->Read(&response)) {
    }
    ended_ = true;
    return call_->Finish();
  }

 private:
  std::unique_ptr<ServerReflection::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<ServerReflectionRequest, ServerReflectionResponse>>
      call_;
  bool ended_ = false;
};

// Adds `name` to the pool, after the files that it imports. Each file must have been received.
const google::protobuf::FileDescriptor* Build(
    DescriptorPool& pool, const std::map<std::string, FileDescriptorProto>& received,
    const std::string& name) {
  if (const auto* const known = pool.FindFileByName(name); known != nullptr) return known;
  const auto file = received.find(name);
  if (file == received.end()) return nullptr;
  for (const std::string& imported : file->second.dependency()) {
    EXPECT_NE(Build(pool, received, imported), nullptr) << imported;
  }
  return pool.BuildFile(file->second);
}

TEST(ReflectionTest, EveryServiceOfTheServerIsListed) {
  GuardedService guarded;
  Asking asking(guarded.service().server());
  EXPECT_THAT(asking.ListServices(),
              UnorderedElementsAre(v1::ThunderheadService::service_full_name(),
                                   v1::RenderJobService::service_full_name(),
                                   grpc::health::v1::Health::service_full_name(),
                                   ServerReflection::service_full_name()));
  EXPECT_TRUE(asking.Close().ok());
}

TEST(ReflectionTest, EveryServiceIsDescribedWithAllThatItNeeds) {
  FakeService fake;
  Asking asking(fake.server());
  for (const std::string& service : asking.ListServices()) {
    SCOPED_TRACE(service);
    std::map<std::string, FileDescriptorProto> received;
    std::string first;
    const ServerReflectionResponse answer = asking.Find(service);
    for (const auto& bytes : answer.file_descriptor_response().file_descriptor_proto()) {
      FileDescriptorProto file;
      ASSERT_TRUE(file.ParseFromString(bytes));
      if (first.empty()) first = file.name();
      received[file.name()] = file;
    }
    DescriptorPool pool;
    const auto* const built = Build(pool, received, first);
    ASSERT_NE(built, nullptr);
    const auto* const described = pool.FindServiceByName(service);
    ASSERT_NE(described, nullptr);
    const auto* const own = DescriptorPool::generated_pool()->FindServiceByName(service);
    EXPECT_EQ(described->DebugString(), own->DebugString());
  }
}

TEST(ReflectionTest, ACallGoesOnAfterAnUnknownName) {
  FakeService fake;
  Asking asking(fake.server());
  EXPECT_EQ(asking.Find("thunderhead.v1.Nothing").error_response().error_code(),
            grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(asking.Answer({}).error_response().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_TRUE(asking.Find("thunderhead.v1.Scene").has_file_descriptor_response());
  EXPECT_TRUE(asking.Close().ok());
}

TEST(ReflectionTest, NewerVersionsAreUnknownSoThatClientsUseThisOne) {
  GuardedService guarded;
  EXPECT_EQ(guarded.Ask("ServerReflectionInfo", "", "grpc.reflection.v1.ServerReflection"),
            grpc::StatusCode::UNIMPLEMENTED);
}

TEST(ReflectionTest, ACallThatNeverAsksIsCancelled) {
  RunningTime time;
  service::ServerOptions options = Patient(time);
  options.limits.delivery_time = std::chrono::hours(1);
  FakeService fake(options);
  Asking silent(fake.server());
  auto end = std::async(std::launch::async, [&silent] { return silent.End(); });
  EXPECT_TRUE(WaitFor([&] {
    // The call may begin on the server after the time has moved.
    time.Advance(options.limits.delivery_time);
    return end.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }));
  EXPECT_EQ(end.get().error_code(), grpc::StatusCode::CANCELLED);
}

TEST(ReflectionTest, ACallThatAsksNoMoreIsCancelled) {
  RunningTime time;
  service::ServerOptions options = Patient(time);
  options.limits.delivery_time = std::chrono::hours(1);
  FakeService fake(options);
  Asking silent(fake.server());
  Asking asking(fake.server());
  // The server answers one call after the other has been idle for most of the time.
  EXPECT_FALSE(silent.ListServices().empty());
  time.Advance(std::chrono::minutes(40));
  EXPECT_FALSE(asking.ListServices().empty());
  time.Advance(std::chrono::minutes(40));
  EXPECT_EQ(silent.End().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_FALSE(asking.ListServices().empty());
}

TEST(ReflectionTest, SixteenCallsMayBeOpen) {
  FakeService fake;
  std::vector<std::unique_ptr<Asking>> open;
  for (int i = 0; i < 16; ++i) {
    open.push_back(std::make_unique<Asking>(fake.server()));
    EXPECT_FALSE(open.back()->ListServices().empty()) << i;
  }
  EXPECT_EQ(Asking(fake.server()).End().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_FALSE(open.front()->ListServices().empty()) << "others go on";
  EXPECT_TRUE(open.back()->Close().ok());
  // The server notices a little later that the call has ended.
  EXPECT_TRUE(WaitFor([&] {
    ServerReflectionRequest request;
    request.set_list_services("");
    ServerReflectionResponse response;
    return Asking(fake.server()).Ask(request, &response);
  }));
}

}  // namespace
}  // namespace thunderhead::testing
