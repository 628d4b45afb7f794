// A fixture with a gateway to the test service, which is started when a test first asks for it.
#pragma once

#include <memory>

#include "gtest/gtest.h"
#include "tests/gateway/echo_service.h"

namespace thunderhead::gateway::test {

class EchoTest : public ::testing::Test {
 protected:
  EchoSite& Site() {
    if (site_ == nullptr) site_ = EchoSite::Start(options_);
    return *site_;
  }
  EchoRecord& Record() { return Site().Record(); }

  GatewayOptions options_;

 private:
  std::unique_ptr<EchoSite> site_;
};

}  // namespace thunderhead::gateway::test
