// The state that all connections of a gateway share.
#pragma once

#include <memory>

#include "base/line_limit.h"
#include "base/time_source.h"
#include "gateway/file_closer.h"
#include "gateway/file_threads.h"
#include "gateway/gateway.h"
#include "gateway/http_policy.h"
#include "gateway/static_files.h"
#include "gateway/unsent_answers.h"
#include "grpcpp/generic/generic_stub.h"

namespace thunderhead::gateway {

struct Site {
  base::TimeSource::Clock::time_point Now() const { return options.time->Now(); }

  GatewayOptions options;
  // The files are shared, because the threads that read files may outlive the site.
  std::shared_ptr<const StaticFiles> files;
  HttpPolicy policy;
  grpc::GenericStub stub;
  // The page and the service's files have separate threads, so that a blocked storage of results
  // does not affect the page.
  FileThreads page_threads{options.file_timeout, *options.time};
  FileThreads kept_threads{options.file_timeout, *options.time};
  base::LineLimit failed_reads{1};  // limits the number of log lines about failed reads
  std::shared_ptr<FileCloser> file_closer = std::make_shared<FileCloser>(::close, *options.time);
  UnsentAnswers unsent_answers{options.max_unsent_bytes, *options.time};
};

}  // namespace thunderhead::gateway
