#include "tests/service/served_program.h"

#include <grpcpp/grpcpp.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <regex>

#include "base/status.h"

namespace thunderhead::testing {

ServedProgram::ServedProgram(const std::string& program, const std::string& storm,
                             const std::string& state) {
  int out[2];
  THUNDERHEAD_CHECK(pipe(out) == 0, "no pipe");
  process_ = fork();
  THUNDERHEAD_CHECK(process_ >= 0, "no process");
  if (process_ == 0) {
    dup2(out[1], STDOUT_FILENO);
    close(out[0]);
    close(out[1]);
    execl(program.c_str(), program.c_str(), "serve", "--device", "software", "--data",
          storm.c_str(), "--http", "127.0.0.1:0", "--grpc", "127.0.0.1:0", "--state", state.c_str(),
          nullptr);
    _exit(127);
  }
  close(out[1]);
  // One line, or none if it ends before.
  std::string line;
  for (char next = 0; read(out[0], &next, 1) == 1 && next != '\n';) line += next;
  close(out[0]);
  std::smatch address;
  if (!std::regex_search(line, address, std::regex("gRPC ([0-9.:]+)"))) return;
  stub_ = v1::ThunderheadService::NewStub(
      grpc::CreateChannel(address[1].str(), grpc::InsecureChannelCredentials()));
}

ServedProgram::~ServedProgram() { End(SIGKILL); }

void ServedProgram::End(int signal) {
  if (process_ < 0) return;
  kill(process_, signal);
  waitpid(process_, nullptr, 0);
  process_ = -1;
}

}  // namespace thunderhead::testing
