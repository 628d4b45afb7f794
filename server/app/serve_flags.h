// The flags of `thunderhead serve`, and what they imply for access control and limits.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "access/access_control.h"
#include "app/address.h"
#include "app/catalogue_flags.h"
#include "app/jobs_flags.h"
#include "app/operation.h"
#include "app/reader_flags.h"
#include "base/certificate_files.h"
#include "base/executor.h"
#include "base/memory_budget.h"
#include "drawing/render_loop.h"
#include "gateway/gateway.h"
#include "service/server.h"

namespace thunderhead::app {

struct ServeFlags {
  std::string config;  // a file with further flags
  bool print_config = false;
  std::vector<std::string> data;
  std::string http = "127.0.0.1:8080";
  std::string grpc = "127.0.0.1:50051";
  std::string device = "auto";
  std::string page;
  std::string clouds;
  std::string state;
  std::string roster_timeouts;         // file with roster timeouts, for tests
  std::uint64_t memory_bytes = 0;      // 0 means half of the machine's memory
  std::uint64_t gpu_memory_bytes = 0;  // 0 means 4 GiB
  double read_deadline_s = 60.0;
  CatalogueFlags catalogue;
  ReaderFlags reader;
  OperationFlags operation;
  JobsFlags jobs;

  // Flags for access.
  std::vector<std::string> auth = {"none"};
  std::string jwt_issuer;
  std::string jwt_audience;
  base::TlsFiles tls;
  bool insecure = false;
  std::vector<std::string> allowed_hosts;
  std::vector<std::string> allowed_origins;
  std::vector<std::string> trusted_proxies;
  std::string audit_log;

  // Flags for limits.
  session::SessionsOptions sessions;
  service::Limits limits;
  access::QuotaLimits quotas;
  drawing::RenderLoopOptions render_loop;
  base::Executor::Limits executor;
  gateway::GatewayOptions gateway;
  double max_render_s = 1800.0;
  double max_megasamples = 137439.0;
  double max_megapixels = 33.6;
  int max_message_kib = 1024;
  int grpc_memory_mib = 1024;
  int max_unsent_mib = 512;
};

// The memory budgets that --memory-budget and --gpu-memory-budget set.
struct Budgets {
  std::shared_ptr<base::MemoryBudget> memory;
  std::shared_ptr<base::MemoryBudget> gpu;
};
Budgets BudgetsOf(const ServeFlags& flags);

void AddServeFlags(CLI::App& serve, ServeFlags& flags);

// Creates the access control from --auth and the related flags. Returns INVALID_ARGUMENT for a
// wrong flag, and errors of files name the file.
absl::StatusOr<std::shared_ptr<access::AccessControl>> MakeAccessControl(const ServeFlags& flags);

// Fills in settings that depend on others: limits in the units of the code, allowed hosts, and TLS.
// Returns INVALID_ARGUMENT for a wrong flag, and FAILED_PRECONDITION for a TLS key that other users
// may read.
absl::Status CompleteFlags(ServeFlags& flags);

// Returns INVALID_ARGUMENT if another machine could reach a port without access control or without
// encryption, unless --insecure allows this. The operator port always has neither.
absl::Status CheckReach(const ServeFlags& flags, const Address& http, const Address& grpc);

}  // namespace thunderhead::app
