#include "rpc_port/status_table.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "base/error_details.h"
#include "base/utf8.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "telemetry/metrics.h"

namespace thunderhead::rpc_port {
namespace {

using std::chrono::milliseconds;

constexpr char kDomain[] = "thunderhead";

// Maximum sizes of an error's texts. gRPC drops a status of more than 8 KiB, and a shader's error
// log may be longer. A status contains its message twice, the second time as base64 in the details.
constexpr std::size_t kMaxMessageBytes = 2000;
constexpr std::size_t kMaxDetailBytes = 600;

struct Row {
  absl::StatusCode engine;
  grpc::StatusCode wire;
  const char* reason;  // default reason, if the status has none
  // Default retry delay, if the status has none. 0 means that a retry does not help.
  milliseconds retry_after = {};
};

// For a client, OUT_OF_RANGE is a wrong value like any other, so it maps to INVALID_ARGUMENT.
constexpr std::array kTable = {
    Row{absl::StatusCode::kInvalidArgument, grpc::StatusCode::INVALID_ARGUMENT, "INVALID_ARGUMENT"},
    Row{absl::StatusCode::kOutOfRange, grpc::StatusCode::INVALID_ARGUMENT, "VALUE_OUT_OF_RANGE"},
    Row{absl::StatusCode::kNotFound, grpc::StatusCode::NOT_FOUND, "NOT_FOUND"},
    Row{absl::StatusCode::kAlreadyExists, grpc::StatusCode::ALREADY_EXISTS, "ALREADY_EXISTS"},
    Row{absl::StatusCode::kUnauthenticated, grpc::StatusCode::UNAUTHENTICATED, "UNAUTHENTICATED"},
    Row{absl::StatusCode::kPermissionDenied, grpc::StatusCode::PERMISSION_DENIED,
        "PERMISSION_DENIED"},
    // Memory may become free later, so a retry may succeed.
    Row{absl::StatusCode::kResourceExhausted, grpc::StatusCode::RESOURCE_EXHAUSTED,
        "RESOURCE_EXHAUSTED", std::chrono::seconds(30)},
    Row{absl::StatusCode::kFailedPrecondition, grpc::StatusCode::FAILED_PRECONDITION,
        "FAILED_PRECONDITION"},
    Row{absl::StatusCode::kAborted, grpc::StatusCode::ABORTED, "ABORTED"},
    Row{absl::StatusCode::kUnimplemented, grpc::StatusCode::UNIMPLEMENTED, "UNIMPLEMENTED"},
    Row{absl::StatusCode::kDataLoss, grpc::StatusCode::DATA_LOSS, "DATA_LOSS"},
    Row{absl::StatusCode::kUnavailable, grpc::StatusCode::UNAVAILABLE, "UNAVAILABLE",
        std::chrono::seconds(5)},
    Row{absl::StatusCode::kDeadlineExceeded, grpc::StatusCode::DEADLINE_EXCEEDED,
        "DEADLINE_EXCEEDED"},
    Row{absl::StatusCode::kInternal, grpc::StatusCode::INTERNAL, "INTERNAL"},
};

constexpr Row kOther{absl::StatusCode::kUnknown, grpc::StatusCode::UNKNOWN, "UNKNOWN"};

const Row& RowOf(absl::StatusCode code) {
  for (const Row& row : kTable) {
    if (row.engine == code) return row;
  }
  return kOther;
}

// Returns the text made printable, as protobuf strings and log lines require, and truncated to
// `max_bytes`. The size is counted in the encoding of grpc-message, which uses three bytes for each
// byte outside ASCII.
std::string Sendable(std::string_view text, std::size_t max_bytes) {
  std::string printable = base::Printable(text, {.max_bytes = max_bytes + 3});
  std::size_t bytes = 0;
  for (std::size_t end = 0; end < printable.size();) {
    const std::size_t size = base::Utf8CharacterBytes(std::string_view(printable).substr(end));
    bytes += size == 1 ? 1 : 3 * size;
    if (bytes > max_bytes) return printable.substr(0, end) + "...";
    end += size;
  }
  return printable;
}

google::rpc::ErrorInfo ErrorInfoOf(const base::ErrorDetails& details, const Row& row) {
  google::rpc::ErrorInfo info;
  info.set_reason(details.reason.empty() ? row.reason : details.reason);
  info.set_domain(kDomain);
  for (const auto& [key, value] : details.metadata) {
    (*info.mutable_metadata())[key] = Sendable(value, kMaxDetailBytes);
  }
  return info;
}

google::rpc::RetryInfo RetryInfoOf(milliseconds delay) {
  google::rpc::RetryInfo retry;
  const auto seconds = std::chrono::floor<std::chrono::seconds>(delay);
  retry.mutable_retry_delay()->set_seconds(seconds.count());
  retry.mutable_retry_delay()->set_nanos(
      static_cast<int>(std::chrono::nanoseconds(delay - seconds).count()));
  return retry;
}

google::rpc::BadRequest BadRequestOf(const base::ErrorDetails& details,
                                     const std::string& message) {
  google::rpc::BadRequest request;
  auto& violation = *request.add_field_violations();
  violation.set_field(Sendable(details.field, kMaxDetailBytes));
  violation.set_description(
      Sendable(details.description.empty() ? message : details.description, kMaxDetailBytes));
  return request;
}

}  // namespace

int CodeOf(const absl::Status& status) { return static_cast<int>(RowOf(status.code()).wire); }

std::string ReasonOf(const absl::Status& status) {
  const std::string reason = base::DetailsOf(status).reason;
  return reason.empty() ? RowOf(status.code()).reason : reason;
}

std::string SendableMessage(const absl::Status& status) {
  return Sendable({status.message().data(), status.message().size()}, kMaxMessageBytes);
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  const std::string message = SendableMessage(status);
  if (status.ok()) return grpc::Status::OK;
  // A client that cancelled its call does not read details, so none are sent.
  if (absl::IsCancelled(status)) return {grpc::StatusCode::CANCELLED, message};
  const Row& row = RowOf(status.code());
  const base::ErrorDetails details = base::DetailsOf(status);
  telemetry::Counted().refusals.Of(details.reason.empty() ? row.reason : details.reason).Add();
  google::rpc::Status all;
  all.set_code(row.wire);
  // Clients that read the details expect the code and the message there too.
  all.set_message(message);
  all.add_details()->PackFrom(ErrorInfoOf(details, row));
  const milliseconds retry_after =
      details.permanent ? milliseconds::zero() : details.retry_after.value_or(row.retry_after);
  if (retry_after > milliseconds::zero()) all.add_details()->PackFrom(RetryInfoOf(retry_after));
  if (row.wire == grpc::StatusCode::INVALID_ARGUMENT) {
    all.add_details()->PackFrom(BadRequestOf(details, message));
  }
  return {row.wire, message, all.SerializeAsString()};
}

}  // namespace thunderhead::rpc_port
