// A gateway for the test service, for clients in other languages: prints its port, then the counts
// of its calls for every line read, and ends at the end of its input. With the argument
// "in-process" it calls the service without HTTP/2.
#include <cstdio>
#include <iostream>
#include <string>
#include <string_view>

#include "tests/gateway/echo_service.h"

int main(int argc, char** argv) {
  using namespace thunderhead::gateway::test;
  const bool in_process = argc > 1 && std::string_view(argv[1]) == "in-process";
  const auto site = EchoSite::Start({}, in_process ? Path::kInProcess : Path::kUnixSocket);
  std::cout << "{\"port\": " << site->Port() << "}" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    const EchoRecord& record = site->Record();
    std::cout << "{\"started\": " << record.started << ", \"written\": " << record.written
              << ", \"cancelled\": " << record.cancelled << ", \"done\": " << record.done << "}"
              << std::endl;
  }
  return 0;
}
