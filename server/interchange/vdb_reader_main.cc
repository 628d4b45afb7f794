#include "interchange/vdb_reader_main.h"

#include <span>
#include <vector>

#include "base/status.h"
#include "interchange/vdb_grid_reader.h"
#include "interchange/vdb_volume.h"
#include "sandbox/reader_process.h"

namespace thunderhead::interchange {
namespace {

class VdbReader final : public sandbox::FileReader {
 public:
  absl::Status Prepare(const std::vector<sandbox::BundledFile>& files) override {
    if (files.size() != 1) return absl::InternalError("one OpenVDB file is read at a time");
    bytes_ = files.front().bytes;
    PrepareVdb();
    return absl::OkStatus();
  }

  absl::Status Answer(const sandbox::Request& request, sandbox::Replies& replies) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(VdbVolume volume, ReadVdbGrid(request.path, bytes_, request.part,
                                                               sandbox::Replies::SendProgress));
    replies.Send(sandbox::Reply::kOther, volume);
    return absl::OkStatus();
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace

int ReadVdbFile() {
  VdbReader reader;
  return sandbox::RunReader(reader);
}

}  // namespace thunderhead::interchange
