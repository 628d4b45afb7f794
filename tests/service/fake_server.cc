// A complete server that uses the fakes, for measuring clients. It needs no files and no OpenGL,
// and draws in no time.
//   fake_server PORT
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "service/server.h"
#include "tests/service/fake_engine.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fake_server PORT\n");
    return 64;
  }
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  namespace fakes = thunderhead::testing;
  thunderhead::service::ServerOptions options;
  options.address = absl::StrCat("127.0.0.1:", argv[1]);
  const auto server = thunderhead::service::Server::Start(
      options, std::make_shared<fakes::FakeStormStore>(),
      fakes::FakeFrameSources(std::make_shared<fakes::FakeMachine>()));
  if (!server.ok()) {
    std::fprintf(stderr, "%s\n", server.status().ToString().c_str());
    return 1;
  }
  std::printf("port %d\n", (*server)->Port());
  std::fflush(stdout);
  int received = 0;
  sigwait(&signals, &received);
  return 0;
}
