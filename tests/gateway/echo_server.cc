// A gateway for the test service, for clients in other languages. It prints its port, then the
// counts of its calls for every line read. It exits at the end of its input.
#include <cstdio>
#include <iostream>
#include <string>

#include "tests/gateway/echo_service.h"

int main() {
  using namespace thunderhead::gateway::test;
  const auto site = EchoSite::Start();
  std::cout << "{\"port\": " << site->Port() << "}" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    const EchoRecord& record = site->Record();
    std::cout << "{\"started\": " << record.started << ", \"written\": " << record.written
              << ", \"cancelled\": " << record.cancelled << ", \"done\": " << record.done << "}"
              << std::endl;
  }
  return 0;
}
