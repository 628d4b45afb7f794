// Decodes the details of an error as a client does: google.rpc's details in
// grpc-status-details-bin.
#pragma once

#include <grpcpp/support/error_details.h>

#include <map>
#include <string>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "gtest/gtest.h"

namespace thunderhead::testing {

// The decoded details of an error.
struct Decoded {
  std::string reason;
  std::map<std::string, std::string> metadata;
  std::string field;
  std::string description;
  bool bad_request = false;
  // Delay before a retry, in seconds; negative if the error contains no delay.
  double retry_s = -1.0;
};

// Returns the details, after checking that they repeat the status.
inline Decoded Decode(const grpc::Status& refusal) {
  Decoded decoded;
  google::rpc::Status status;
  EXPECT_TRUE(grpc::ExtractErrorDetails(refusal, &status).ok());
  EXPECT_EQ(status.code(), refusal.error_code());
  EXPECT_EQ(status.message(), refusal.error_message());
  google::rpc::ErrorInfo info;
  google::rpc::RetryInfo retry;
  google::rpc::BadRequest request;
  for (const auto& detail : status.details()) {
    if (detail.UnpackTo(&info)) {
      EXPECT_EQ(info.domain(), "thunderhead");
      decoded.reason = info.reason();
      decoded.metadata = {info.metadata().begin(), info.metadata().end()};
    } else if (detail.UnpackTo(&retry)) {
      decoded.retry_s =
          static_cast<double>(retry.retry_delay().seconds()) + 1e-9 * retry.retry_delay().nanos();
    } else if (detail.UnpackTo(&request)) {
      decoded.bad_request = true;
      EXPECT_EQ(request.field_violations_size(), 1);
      decoded.field = request.field_violations(0).field();
      decoded.description = request.field_violations(0).description();
    } else {
      ADD_FAILURE() << "unknown detail " << detail.type_url();
    }
  }
  return decoded;
}

}  // namespace thunderhead::testing
