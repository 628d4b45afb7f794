#include "netcdf/hdf5_layout.h"

#include <hdf5.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <set>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "base/utf8.h"

namespace thunderhead::netcdf {
namespace {

// The maximum number of groups and datasets in a file, and the maximum depth of nested groups.
// NetCDF-C takes seconds for 10,000 datasets, and its time grows with the square of the depth.
// Model output stays far below both limits.
constexpr int kMostObjects = 10'000;
constexpr std::ptrdiff_t kDeepest = 16;

constexpr unsigned char kSignature[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};

// An HDF5 identifier, which the destructor closes.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  hid_t get() const { return id_; }
  bool ok() const { return id_ >= 0; }

 private:
  const hid_t id_;
  herr_t (*const close_)(hid_t);
};

// The state of a traversal of the file.
struct Walk {
  int objects = 0;
  std::set<haddr_t> groups;  // addresses in the file of the groups found so far
  std::string complaint;
};

herr_t Refuse(Walk& walk, const char* name, const std::string& what) {
  walk.complaint = absl::StrCat(base::Printable(name), " ", what);
  return 1;  // ends the traversal
}

herr_t LookAtLink(hid_t root, const char* name, const H5L_info_t* info, void* data) {
  Walk& walk = *static_cast<Walk*>(data);
  if (++walk.objects > kMostObjects) {
    return Refuse(walk, name, absl::StrCat("is one object more than ", kMostObjects));
  }
  const std::string_view path = name;
  if (std::count(path.begin(), path.end(), '/') >= kDeepest) {
    return Refuse(walk, name, absl::StrCat("is in more than ", kDeepest, " groups"));
  }
  if (info->type != H5L_TYPE_HARD && info->type != H5L_TYPE_SOFT) {
    return Refuse(walk, name, "is a link to another file");
  }
  H5O_info_t target;
  const bool is_group =
      H5Oget_info_by_name2(root, name, &target, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 &&
      target.type == H5O_TYPE_GROUP;
  // NetCDF-C follows every link, so it would never finish on a cycle of groups.
  if (is_group && !walk.groups.insert(target.addr).second) {
    return Refuse(walk, name, "is a second link to a group");
  }
  return 0;
}

herr_t LookAtObject(hid_t root, const char* name, const H5O_info_t* info, void* data) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  Walk& walk = *static_cast<Walk*>(data);
  const Handle dataset(H5Dopen2(root, name, H5P_DEFAULT), &H5Dclose);
  if (!dataset.ok()) return Refuse(walk, name, "cannot be opened");
  const Handle creation(H5Dget_create_plist(dataset.get()), &H5Pclose);
  if (!creation.ok()) return Refuse(walk, name, "has no readable layout");
  if (H5Pget_external_count(creation.get()) != 0) {
    return Refuse(walk, name, "keeps its values in other files (external storage)");
  }
  if (H5Pget_layout(creation.get()) == H5D_VIRTUAL) {
    return Refuse(walk, name, "takes its values from other files (virtual dataset)");
  }
  return 0;
}

absl::Status Look(const std::string& path, hid_t opened) {
  const Handle file(opened, &H5Fclose);
  if (!file.ok()) {
    return absl::DataLossError(
        absl::StrCat(path,
                     ": cannot be opened as HDF5; it is cut short, damaged or still being "
                     "written: wait for the model to finish, or copy the file again"));
  }
  Walk walk;
  H5O_info_t root;
  if (H5Oget_info2(file.get(), &root, H5O_INFO_BASIC) >= 0) walk.groups.insert(root.addr);
  herr_t status = H5Lvisit(file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, &LookAtLink, &walk);
  if (status == 0) {
    status =
        H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, &LookAtObject, &walk, H5O_INFO_BASIC);
  }
  if (status < 0) {
    return absl::DataLossError(
        absl::StrCat(path, ": its HDF5 structure is damaged; copy the file again"));
  }
  if (status == 0) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(
      path, ": ", walk.complaint,
      "; write the storm's variables into the root group of one file, without links, for "
      "example with nccopy, and give that"));
}

// Returns callbacks with which HDF5 uses the bytes of a file in place, without copying or freeing
// them.
H5FD_file_image_callbacks_t ImageInPlace(void* image) {
  return {.image_malloc = [](std::size_t, H5FD_file_image_op_t, void* bytes) { return bytes; },
          .image_memcpy = [](void* to, const void*, std::size_t, H5FD_file_image_op_t,
                             void*) { return to; },
          .image_realloc = [](void*, std::size_t, H5FD_file_image_op_t,
                              void*) { return static_cast<void*>(nullptr); },
          .image_free = [](void*, H5FD_file_image_op_t, void*) { return herr_t{0}; },
          .udata_copy = [](void* bytes) { return bytes; },
          .udata_free = [](void*) { return herr_t{0}; },
          .udata = image};
}

}  // namespace

bool IsHdf5Signature(std::span<const std::byte> bytes) {
  return bytes.size() >= sizeof(kSignature) &&
         std::memcmp(bytes.data(), kSignature, sizeof(kSignature)) == 0;
}

absl::Status CheckHdf5File(const std::string& path) {
  if (H5Fis_hdf5(path.c_str()) <= 0) return absl::OkStatus();
  return Look(path, H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
}

absl::Status CheckHdf5Bytes(const std::string& path, std::span<const std::byte> bytes) {
  bool found = IsHdf5Signature(bytes);
  for (std::size_t at = kFirstHdf5Offset; at < bytes.size() && !found; at *= 2) {
    found = IsHdf5Signature(bytes.subspan(at));
  }
  if (!found) return absl::OkStatus();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
  void* const image = const_cast<std::byte*>(bytes.data());  // HDF5 only reads the image
  H5FD_file_image_callbacks_t callbacks = ImageInPlace(image);
  constexpr std::size_t kGrowth_bytes = 1 << 16;
  if (!access.ok() || H5Pset_fapl_core(access.get(), kGrowth_bytes, false) < 0 ||
      H5Pset_file_image_callbacks(access.get(), &callbacks) < 0 ||
      H5Pset_file_image(access.get(), image, bytes.size()) < 0) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": HDF5 has no memory to look at it"));
  }
  // The name has no meaning, but HDF5 fails if a file with this name exists.
  return Look(path, H5Fopen("bytes in memory, no file", H5F_ACC_RDONLY, access.get()));
}

}  // namespace thunderhead::netcdf
