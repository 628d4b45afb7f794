// Reads a grid of an untrusted OpenVDB file by a confined process.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "interchange/vdb_volume.h"
#include "storm_files/storm_file.h"

namespace thunderhead::interchange {

// Returns the memory in bytes that the reader of an OpenVDB file may use by default, if the file
// has `file_bytes` bytes. It is 512 MiB plus 100 times the file's size, but at most this machine's
// memory. The limit depends on the file's size because a small hostile file may state any size.
// Other files need less. Their tree of voxels takes up to 40 times the file's size. The dense array
// of a cloud that fills a tenth of its box takes about 30 times the file's size.
std::uint64_t DefaultVdbMemory_bytes(std::uint64_t file_bytes);

struct VdbReaderOptions {
  std::uint64_t memory_bytes = 0;  // limit for the reader; 0 for DefaultVdbMemory_bytes
  std::string memory_flag = {};    // the flag by which users set the limit, for errors
  std::string program = {};   // the reader; if empty, thunderhead-vdb-reader next to this program
  std::stop_token stop = {};  // a request to stop ends the reader, and the error is CANCELLED
};

// Reads the grid named `grid` of the file at `path` by a confined process. `checkpoint` may be
// empty. Errors are those of ReadVdbGrid, INVALID_ARGUMENT if the file does not begin like an
// OpenVDB file, and INTERNAL if the reader program is missing. The errors of a reader that fails
// are those of sandbox::Readers.
absl::StatusOr<VdbVolume> ReadVdb(const std::string& path, const std::string& grid,
                                  const storm_files::ReadCheckpoint& checkpoint,
                                  const VdbReaderOptions& options = {});

}  // namespace thunderhead::interchange
