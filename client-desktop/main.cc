#include "desktop/app.h"

int main(int argc, char** argv) {
  const thunderhead::desktop::ParsedFlags parsed = thunderhead::desktop::ParseFlags(argc, argv);
  return parsed.flags ? thunderhead::desktop::RunDesktop(*parsed.flags) : parsed.exit_status;
}
