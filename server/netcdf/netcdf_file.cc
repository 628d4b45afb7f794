#include "netcdf/netcdf_file.h"

#include <netcdf.h>
#include <netcdf_mem.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <streambuf>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/byte_source.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "netcdf/classic_file_size.h"
#include "netcdf/classic_header.h"
#include "netcdf/filters.h"
#include "netcdf/hdf5_layout.h"
#include "netcdf/netcdf_lock.h"
#include "netcdf/open_errors.h"
#include "netcdf/packing.h"

namespace thunderhead::netcdf {
namespace {

constexpr int kNoHandle = -1;

// Maximum length in bytes of a text attribute. No attribute that a reader needs is longer.
constexpr std::size_t kLongestText = 1 << 20;

// Maximum number of groups that NetcdfFile::Groups returns.
constexpr std::size_t kMostGroups = 1000;

// Appends the full names of the groups within a group.
void AppendGroups(int group, const std::string& path, std::vector<std::string>& names) {
  int count = 0;
  if (nc_inq_grps(group, &count, nullptr) != NC_NOERR || count <= 0) return;
  std::vector<int> inner(static_cast<std::size_t>(count));
  if (nc_inq_grps(group, &count, inner.data()) != NC_NOERR) return;
  for (const int id : inner) {
    char name[NC_MAX_NAME + 1];
    if (names.size() >= kMostGroups || nc_inq_grpname(id, name) != NC_NOERR) return;
    const std::string full = absl::StrCat(path, "/", name);
    names.push_back(full);
    AppendGroups(id, full, names);
  }
}

// A stream buffer that reads bytes in memory and never writes to them.
class BytesBuffer final : public std::streambuf {
 public:
  explicit BytesBuffer(std::span<const std::byte> bytes) {
    char* const first = reinterpret_cast<char*>(const_cast<std::byte*>(bytes.data()));
    setg(first, first, first + bytes.size());
  }
};

absl::Status CheckHeader(const std::string& path, std::istream& file) {
  return base::Annotate(CheckClassicHeader(file), path);
}

// Opens the bytes. NetCDF-C neither writes to the bytes nor frees them.
int OpenMemory(const std::string& path, std::span<const std::byte> bytes, int& handle) {
  constexpr std::size_t kMagicBytes = 8;  // for fewer bytes, netCDF-C reports an invalid argument
  if (bytes.size() < kMagicBytes) return NC_ENOTNC;
  return nc_open_mem(path.c_str(), NC_NOWRITE, bytes.size(), const_cast<std::byte*>(bytes.data()),
                     &handle);
}

}  // namespace

bool NetcdfFile::BeginsLikeNetcdf(std::string_view start) {
  if (start.starts_with("CDF") || IsHdf5Signature(std::as_bytes(std::span(start)))) return true;
  for (std::size_t at = kFirstHdf5Offset; at < start.size(); at *= 2) {
    if (IsHdf5Signature(std::as_bytes(std::span(start.substr(at))))) return true;
  }
  return false;
}

absl::Status NetcdfFile::CheckStart(const std::string& path, int file) {
  if (IsHeldByWriter(file)) return HeldByWriter(path);
  std::array<char, 8> start{};
  const auto read_at = [&](std::uint64_t offset) {
    return pread(file, start.data(), start.size(), static_cast<off_t>(offset));
  };
  ssize_t count = read_at(0);
  if (count == 0) return EmptyFile(path);
  if (std::string_view(start.data(), 3) == "CDF") return absl::OkStatus();
  for (std::uint64_t offset = kFirstHdf5Offset; count == std::ssize(start); offset *= 2) {
    if (IsHdf5Signature(std::as_bytes(std::span(start)))) return absl::OkStatus();
    count = read_at(offset);
  }
  return OpenError(path, NC_ENOTNC);
}

absl::StatusOr<NetcdfFile> NetcdfFile::Open(const std::string& path, const std::string& group) {
  THUNDERHEAD_ASSIGN_OR_RETURN(NetcdfFile file, OpenRoot(path));
  if (group.empty()) return file;
  bool found = false;
  {
    const NetcdfLock lock;
    found = nc_inq_grp_full_ncid(file.handle_, group.c_str(), &file.group_) == NC_NOERR;
  }
  if (found) return file;
  return absl::DataLossError(
      absl::StrCat(path, ": has no group ", group, "; was the file replaced?"));
}

absl::StatusOr<NetcdfFile> NetcdfFile::OpenRoot(const std::string& path) {
  if (base::ReadsOnlyFromMemory()) {
    const std::optional<std::span<const std::byte>> bytes = base::RegisteredBytes(path);
    if (!bytes.has_value()) return OpenError(path, EACCES);
    if (bytes->empty()) return EmptyFile(path);
    BytesBuffer buffer(*bytes);
    std::istream header(&buffer);
    THUNDERHEAD_RETURN_IF_ERROR(CheckHeader(path, header));
    int handle = kNoHandle;
    const NetcdfLock lock;
    THUNDERHEAD_RETURN_IF_ERROR(CheckHdf5Bytes(path, *bytes));
    if (const int code = OpenMemory(path, *bytes, handle); code != NC_NOERR)
      return OpenError(path, code);
    return Checked(path, handle, bytes->size());
  }
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return OpenError(path, ENOENT);
  if (!std::filesystem::is_regular_file(path, error)) return OpenError(path, NC_ENOTNC);
  if (std::filesystem::file_size(path, error) == 0) return EmptyFile(path);
  std::ifstream header(path, std::ios::binary);
  THUNDERHEAD_RETURN_IF_ERROR(CheckHeader(path, header));
  int handle = kNoHandle;
  const NetcdfLock lock;
  if (const absl::Status layout = CheckHdf5File(path); !layout.ok()) {
    return IsHeldByWriter(path) ? HeldByWriter(path) : layout;
  }
  if (const int code = nc_open(path.c_str(), NC_NOWRITE, &handle); code != NC_NOERR) {
    return IsHeldByWriter(path) ? HeldByWriter(path) : OpenError(path, code);
  }
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return Checked(path, handle, error ? std::numeric_limits<std::uintmax_t>::max() : bytes);
}

absl::StatusOr<NetcdfFile> NetcdfFile::Checked(const std::string& path, int handle,
                                               std::uintmax_t bytes) {
  NetcdfFile file(path, handle);
  const std::uintmax_t expected = ClassicFileSize(handle);
  if (bytes >= expected) return file;
  // The file is closed here, because ~NetcdfFile would take the lock again.
  nc_close(std::exchange(file.handle_, kNoHandle));
  return absl::DataLossError(absl::StrCat(
      path, ": has ", bytes, " bytes where its header promises ", expected,
      "; it is cut short or still being written: wait for the model to finish, or copy it again"));
}

NetcdfFile::NetcdfFile(std::string path, int handle)
    : path_(std::move(path)), handle_(handle), group_(handle) {}

NetcdfFile::NetcdfFile(NetcdfFile&& other) noexcept
    : path_(std::move(other.path_)),
      handle_(std::exchange(other.handle_, kNoHandle)),
      group_(other.group_) {}

NetcdfFile& NetcdfFile::operator=(NetcdfFile&& other) noexcept {
  if (this != &other) {
    Close();
    path_ = std::move(other.path_);
    handle_ = std::exchange(other.handle_, kNoHandle);
    group_ = other.group_;
  }
  return *this;
}

NetcdfFile::~NetcdfFile() { Close(); }

void NetcdfFile::Close() {
  if (handle_ == kNoHandle) return;
  const NetcdfLock lock;
  nc_close(std::exchange(handle_, kNoHandle));
}

int NetcdfFile::Find(const std::string& variable, Variable& found) const {
  found.group = group_;
  while (true) {
    const int code = nc_inq_varid(found.group, variable.c_str(), &found.id);
    if (code != NC_ENOTVAR || found.group == handle_) return code;
    if (nc_inq_grp_parent(found.group, &found.group) != NC_NOERR) return code;
  }
}

std::optional<NetcdfFile::Variable> NetcdfFile::FindHolder(const std::string& variable,
                                                           const std::string& attribute) const {
  Variable holder{group_, NC_GLOBAL};
  if (!variable.empty()) {
    return Find(variable, holder) == NC_NOERR ? std::optional(holder) : std::nullopt;
  }
  // A group without the attribute inherits it from the group around it.
  while (holder.group != handle_ &&
         nc_inq_att(holder.group, NC_GLOBAL, attribute.c_str(), nullptr, nullptr) != NC_NOERR) {
    if (nc_inq_grp_parent(holder.group, &holder.group) != NC_NOERR) break;
  }
  return holder;
}

bool NetcdfFile::HasVariable(const std::string& variable) const {
  const NetcdfLock lock;
  Variable found;
  return Find(variable, found) == NC_NOERR;
}

std::vector<std::string> NetcdfFile::Groups() const {
  const NetcdfLock lock;
  std::vector<std::string> names;
  AppendGroups(handle_, "", names);
  return names;
}

std::optional<std::size_t> NetcdfFile::DimensionLength(const std::string& dimension) const {
  const NetcdfLock lock;
  int id = 0;
  std::size_t length = 0;
  if (nc_inq_dimid(group_, dimension.c_str(), &id) != NC_NOERR ||
      nc_inq_dimlen(group_, id, &length) != NC_NOERR) {
    return std::nullopt;
  }
  return length;
}

std::vector<std::string> NetcdfFile::Variables() const {
  const NetcdfLock lock;
  std::vector<std::string> names;
  for (int group = group_;;) {
    int count = 0;
    nc_inq_nvars(group, &count);
    for (int id = 0; id < count; ++id) {
      char name[NC_MAX_NAME + 1];
      if (nc_inq_varname(group, id, name) != NC_NOERR) continue;
      // A variable of the inner group hides one of the same name around it.
      if (group == group_ || std::ranges::find(names, name) == names.end()) {
        names.emplace_back(name);
      }
    }
    if (group == handle_ || nc_inq_grp_parent(group, &group) != NC_NOERR) return names;
  }
}

absl::StatusOr<std::vector<std::string>> NetcdfFile::Dimensions(const std::string& variable) const {
  const NetcdfLock lock;
  Variable found;
  int rank = 0;
  int dimensions[NC_MAX_VAR_DIMS];
  if (Find(variable, found) != NC_NOERR) {
    return absl::NotFoundError(absl::StrCat(path_, ": has no variable ", variable));
  }
  if (int code = nc_inq_var(found.group, found.id, nullptr, nullptr, &rank, dimensions, nullptr);
      code != NC_NOERR) {
    return ReadError(variable, code);
  }
  std::vector<std::string> names;
  for (int i = 0; i < rank; ++i) {
    char name[NC_MAX_NAME + 1];
    if (int code = nc_inq_dimname(found.group, dimensions[i], name); code != NC_NOERR) {
      return ReadError(variable, code);
    }
    names.emplace_back(name);
  }
  return names;
}

absl::StatusOr<std::vector<double>> NetcdfFile::ReadDoubles(const std::string& variable) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, Shape(variable));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t total, CountThatFits(variable, shape, 8));
  std::vector<double> values(total);
  if (total == 0) return values;
  const NetcdfLock lock;
  THUNDERHEAD_ASSIGN_OR_RETURN(const Variable found, NumbersId(variable, shape.size()));
  if (const int code = nc_get_var_double(found.group, found.id, values.data()); code != NC_NOERR) {
    return ReadError(variable, code);
  }
  const absl::StatusOr<Packing> packing = PackingOf(found.group, found.id);
  if (!packing.ok()) return base::Annotate(packing.status(), absl::StrCat(path_, ": ", variable));
  for (double& value : values) value = Unpacked(value, *packing);
  return values;
}

absl::StatusOr<std::vector<std::size_t>> NetcdfFile::Shape(const std::string& variable) const {
  const NetcdfLock lock;
  Variable found;
  int rank = 0;
  int dimensions[NC_MAX_VAR_DIMS];
  if (Find(variable, found) != NC_NOERR) {
    return absl::NotFoundError(absl::StrCat(path_, ": has no variable ", variable));
  }
  if (int code = nc_inq_var(found.group, found.id, nullptr, nullptr, &rank, dimensions, nullptr);
      code != NC_NOERR) {
    return ReadError(variable, code);
  }
  std::vector<std::size_t> shape(rank);
  for (int i = 0; i < rank; ++i) {
    if (int code = nc_inq_dimlen(found.group, dimensions[i], &shape[i]); code != NC_NOERR) {
      return ReadError(variable, code);
    }
  }
  return shape;
}

std::optional<std::string> NetcdfFile::TextAttribute(const std::string& variable,
                                                     const std::string& attribute) const {
  const NetcdfLock lock;
  const std::optional<Variable> holder = FindHolder(variable, attribute);
  if (!holder.has_value()) return {};
  const auto [group, id] = *holder;
  nc_type type;
  std::size_t length = 0;
  if (nc_inq_att(group, id, attribute.c_str(), &type, &length) != NC_NOERR) return {};
  if (type == NC_STRING && length == 1) {
    char* text = nullptr;
    if (nc_get_att_string(group, id, attribute.c_str(), &text) != NC_NOERR) return {};
    std::string value = text != nullptr ? text : "";
    nc_free_string(1, &text);
    return value;
  }
  if (type != NC_CHAR || length > kLongestText) return {};
  std::string value(length, '\0');
  if (nc_get_att_text(group, id, attribute.c_str(), value.data()) != NC_NOERR) return {};
  value.resize(std::min(value.find('\0'), length));
  return value;
}

std::optional<double> NetcdfFile::NumberAttribute(const std::string& variable,
                                                  const std::string& attribute) const {
  const std::vector<double> numbers = NumbersAttribute(variable, attribute);
  if (numbers.size() != 1 || std::isnan(numbers.front())) return std::nullopt;
  return numbers.front();
}

std::vector<double> NetcdfFile::NumbersAttribute(const std::string& variable,
                                                 const std::string& attribute) const {
  const NetcdfLock lock;
  const std::optional<Variable> holder = FindHolder(variable, attribute);
  if (!holder.has_value()) return {};
  return NumbersOf(holder->group, holder->id, attribute.c_str());
}

std::vector<std::string> NetcdfFile::AttributesOf(const std::string& variable) const {
  const NetcdfLock lock;
  Variable found;
  int count = 0;
  std::vector<std::string> names;
  if (Find(variable, found) != NC_NOERR) return names;
  nc_inq_varnatts(found.group, found.id, &count);
  for (int i = 0; i < count; ++i) {
    char name[NC_MAX_NAME + 1];
    if (nc_inq_attname(found.group, found.id, i, name) == NC_NOERR) names.emplace_back(name);
  }
  return names;
}

std::string NetcdfFile::TextOrEmpty(const std::string& variable,
                                    const std::string& attribute) const {
  if (std::optional<std::string> text = TextAttribute(variable, attribute); text.has_value()) {
    return *std::move(text);
  }
  const NetcdfLock lock;
  const std::optional<Variable> holder = FindHolder(variable, attribute);
  const bool absent =
      !holder.has_value() ||
      nc_inq_att(holder->group, holder->id, attribute.c_str(), nullptr, nullptr) != NC_NOERR;
  return absent ? "" : "(not text)";
}

absl::StatusOr<std::vector<std::string>> NetcdfFile::ReadRows(const std::string& variable) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<std::size_t> shape, Shape(variable));
  const NetcdfLock lock;
  Variable found;
  nc_type type = NC_NAT;
  Find(variable, found);
  nc_inq_vartype(found.group, found.id, &type);
  if (shape.size() == 1) shape.insert(shape.begin(), 1);
  if (shape.size() != 2 || type != NC_CHAR) {
    return absl::InvalidArgumentError(absl::StrCat(
        path_, ": ", variable, " is not a character variable of one or two dimensions"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t total, CountThatFits(variable, shape, 1));
  std::vector<char> text(total);
  if (text.empty()) return std::vector<std::string>(shape[0]);
  if (int code = nc_get_var_text(found.group, found.id, text.data()); code != NC_NOERR) {
    return ReadError(variable, code);
  }
  std::vector<std::string> rows;
  for (std::size_t row = 0; row < shape[0]; ++row) {
    const std::string padded(text.data() + row * shape[1], shape[1]);
    rows.emplace_back(padded.c_str());
  }
  return rows;
}

absl::StatusOr<std::size_t> NetcdfFile::RecordLength(const std::string& variable) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<std::size_t> shape, Shape(variable));
  if (!shape.empty()) shape[0] = 1;
  return CountThatFits(variable, shape, sizeof(float));
}

absl::Status NetcdfFile::ReadRecord(const std::string& variable, std::size_t record,
                                    std::vector<float>& values, HugeValue huge) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<std::size_t> count, Shape(variable));
  if (count.empty() || record >= count[0]) {
    return absl::DataLossError(absl::StrCat(path_, ": ", variable, " has no record ", record,
                                            "; the file is shorter than it was: was it replaced?"));
  }
  std::vector<std::size_t> start(count.size(), 0);
  start[0] = record;
  count[0] = 1;
  return ReadFloats(variable, start, count, values, huge);
}

absl::StatusOr<std::vector<float>> NetcdfFile::ReadPart(
    const std::string& variable, const std::vector<std::size_t>& start,
    const std::vector<std::size_t>& count) const {
  std::vector<float> values;
  THUNDERHEAD_RETURN_IF_ERROR(ReadFloats(variable, start, count, values, HugeValue::kRefused));
  return values;
}

absl::Status NetcdfFile::ReadFloats(const std::string& variable,
                                    const std::vector<std::size_t>& start,
                                    const std::vector<std::size_t>& count,
                                    std::vector<float>& values, HugeValue huge) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t total, CountThatFits(variable, count, 4));
  values.resize(total);
  Packing packing;
  std::vector<double> packed;
  {
    const NetcdfLock lock;
    THUNDERHEAD_ASSIGN_OR_RETURN(const Variable found, NumbersId(variable, count.size()));
    const auto [group, id] = found;
    absl::StatusOr<Packing> read = PackingOf(group, id);
    if (!read.ok()) return base::Annotate(read.status(), absl::StrCat(path_, ": ", variable));
    packing = *std::move(read);
    // The chunk cache is off. Every chunk is read once, and the cache would keep a second copy of
    // each variable.
    nc_set_var_chunk_cache(group, id, 0, 0, 0.0F);
    int code = NC_NOERR;
    if (packing.PlainFloat()) {
      code = nc_get_vara_float(group, id, start.data(), count.data(), values.data());
    } else {
      packed.resize(total);
      code = nc_get_vara_double(group, id, start.data(), count.data(), packed.data());
    }
    if (code != NC_NOERR) return ReadError(variable, code);
  }
  const std::optional<double> impossible = packing.PlainFloat()
                                               ? CleanPlainFloats(packing, values)
                                               : Unpack(packed, packing, absl::MakeSpan(values));
  if (!impossible.has_value() || huge == HugeValue::kMissing) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      path_, ": ", variable, " holds the value ", *impossible,
      ", which no quantity has; if it marks cells without data, write it into the attribute "
      "_FillValue or missing_value; otherwise write the file again with correct values"));
}

absl::StatusOr<NetcdfFile::Variable> NetcdfFile::NumbersId(const std::string& variable,
                                                           std::size_t rank) const {
  Variable found;
  nc_type type = NC_NAT;
  int dimensions = 0;
  if (const int code = Find(variable, found); code != NC_NOERR) return ReadError(variable, code);
  if (const int code =
          nc_inq_var(found.group, found.id, nullptr, &type, &dimensions, nullptr, nullptr);
      code != NC_NOERR) {
    return ReadError(variable, code);
  }
  switch (type) {
    case NC_BYTE:
    case NC_UBYTE:
    case NC_SHORT:
    case NC_USHORT:
    case NC_INT:
    case NC_UINT:
    case NC_INT64:
    case NC_UINT64:
    case NC_FLOAT:
    case NC_DOUBLE:
      break;
    case NC_CHAR:
      return ReadError(variable, NC_ECHAR);
    default:
      // NetCDF-C reports NC_STRING for strings, and for number types that it does not know, such as
      // long double. Reading such a variable would write pointers into the array of numbers.
      return absl::InvalidArgumentError(
          absl::StrCat(path_, ": ", variable,
                       " is of a type other than integers of up to 64 bits, float and double; "
                       "write it as one of those"));
  }
  if (static_cast<std::size_t>(dimensions) != rank) {
    return absl::InvalidArgumentError(absl::StrCat(path_, ": ", variable, " has ", dimensions,
                                                   " dimensions where ", rank, " are needed"));
  }
  return found;
}

absl::StatusOr<std::size_t> NetcdfFile::CountThatFits(const std::string& variable,
                                                      const std::vector<std::size_t>& lengths,
                                                      std::size_t bytes_each) const {
  return base::CountThatFits(absl::StrCat(path_, ": ", variable), lengths, bytes_each);
}

absl::Status NetcdfFile::ReadError(const std::string& variable, int code) const {
  Variable found;
  const bool exists = Find(variable, found) == NC_NOERR;
  const std::string filter = exists ? LackingFilter(found.group, found.id) : "";
  if (!filter.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        path_, ": ", variable, " is compressed by the filter ", filter,
        ", which is not available here; where its plug-in is installed, write the file again with "
        "a filter that every program has, for example with nccopy -F '*,none' -d 4"));
  }
  if (code == NC_ECHAR) {
    return absl::InvalidArgumentError(
        absl::StrCat(path_, ": ", variable, " holds text where numbers are needed"));
  }
  return absl::DataLossError(
      absl::StrCat(path_, ": ", variable, " cannot be read (", nc_strerror(code),
                   "); the file is cut short, damaged or still being written: wait for the model "
                   "to finish, or copy the file again"));
}

}  // namespace thunderhead::netcdf
