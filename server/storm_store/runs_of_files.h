// Groups files by model run, and names the storms of a folder or file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "storm_files/storm_file.h"

namespace thunderhead::storm_store {

// A storm's name and files, before it has an id.
struct NamedFiles {
  std::string name;
  std::vector<storm_files::StormFile> files;
};

// Returns the file's name without a netCDF extension. Other dots stay, because they may be part of
// a date.
std::string NameOfFile(const std::filesystem::path& path);

// Returns the name of a storm that is in one file. `runs` is the number of runs in that file.
std::string NameInFile(const std::string& name, const storm_files::StormFile& file,
                       std::size_t runs);

// Groups a folder's files into runs. Files that do not continue one another become separate storms.
std::vector<NamedFiles> GroupRuns(const std::filesystem::path& folder,
                                  std::vector<storm_files::StormFile> files);

// Groups the files by model run. A file with several storms counts as several files. Files of one
// run have the same domain, grid, member and start of the run.
std::vector<std::vector<storm_files::StormFile>> FilesOfRuns(
    std::vector<storm_files::StormFile> files);

}  // namespace thunderhead::storm_store
