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
                             const std::string& state, const std::vector<std::string>& more) {
  std::vector<std::string> words = {program,  "serve",       "--device", "software",
                                    "--data", storm,         "--http",   "127.0.0.1:0",
                                    "--grpc", "127.0.0.1:0", "--state",  state};
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int out[2];
  THUNDERHEAD_CHECK(pipe(out) == 0, "no pipe");
  process_ = fork();
  THUNDERHEAD_CHECK(process_ >= 0, "no process");
  if (process_ == 0) {
    dup2(out[1], STDOUT_FILENO);
    close(out[0]);
    close(out[1]);
    execv(program.c_str(), arguments.data());
    _exit(127);
  }
  close(out[1]);
  // The output is one line, or none if the program ends before.
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
