#include "service/status_table.h"

#include <array>
#include <string>

namespace thunderhead::service {
namespace {

struct Row {
  absl::StatusCode engine;
  grpc::StatusCode wire;
};

// OUT_OF_RANGE is a wrong value like any other to a client, so it joins INVALID_ARGUMENT.
constexpr std::array kTable = {
    Row{absl::StatusCode::kOk, grpc::StatusCode::OK},
    Row{absl::StatusCode::kCancelled, grpc::StatusCode::CANCELLED},
    Row{absl::StatusCode::kInvalidArgument, grpc::StatusCode::INVALID_ARGUMENT},
    Row{absl::StatusCode::kOutOfRange, grpc::StatusCode::INVALID_ARGUMENT},
    Row{absl::StatusCode::kNotFound, grpc::StatusCode::NOT_FOUND},
    Row{absl::StatusCode::kAlreadyExists, grpc::StatusCode::ALREADY_EXISTS},
    Row{absl::StatusCode::kPermissionDenied, grpc::StatusCode::PERMISSION_DENIED},
    Row{absl::StatusCode::kResourceExhausted, grpc::StatusCode::RESOURCE_EXHAUSTED},
    Row{absl::StatusCode::kFailedPrecondition, grpc::StatusCode::FAILED_PRECONDITION},
    Row{absl::StatusCode::kAborted, grpc::StatusCode::ABORTED},
    Row{absl::StatusCode::kUnimplemented, grpc::StatusCode::UNIMPLEMENTED},
    Row{absl::StatusCode::kDataLoss, grpc::StatusCode::DATA_LOSS},
    Row{absl::StatusCode::kUnavailable, grpc::StatusCode::UNAVAILABLE},
    Row{absl::StatusCode::kDeadlineExceeded, grpc::StatusCode::DEADLINE_EXCEEDED},
    Row{absl::StatusCode::kInternal, grpc::StatusCode::INTERNAL},
};

}  // namespace

grpc::Status ToGrpcStatus(const absl::Status& status) {
  for (const Row& row : kTable) {
    if (row.engine == status.code()) return {row.wire, std::string(status.message())};
  }
  return {grpc::StatusCode::UNKNOWN, std::string(status.message())};
}

}  // namespace thunderhead::service
