// The errors of refusals by the gateway's own rules and limits, and a function that reports a
// refusal to the audit log and the metrics.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "gateway/gateway.h"

namespace thunderhead::gateway {

absl::Status HostNotAllowed();
absl::Status OriginNotAllowed();
absl::Status HeaderTooLarge();
absl::Status MessageTooLarge();
absl::Status AnswersNotTaken();
absl::Status TooManyEmptyFrames();

void TellOfRefusal(const GatewayOptions& options, const std::string& peer, const char* act,
                   const absl::Status& why);

}  // namespace thunderhead::gateway
