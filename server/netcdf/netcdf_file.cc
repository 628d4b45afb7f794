#include "netcdf/netcdf_file.h"

#include <fcntl.h>
#include <netcdf.h>
#include <netcdf_mem.h>
#include <sys/file.h>
#include <unistd.h>

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
#include "base/file_descriptor.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "netcdf/classic_file_size.h"
#include "netcdf/classic_header.h"
#include "netcdf/hdf5_layout.h"
#include "netcdf/netcdf_lock.h"

namespace thunderhead::netcdf {
namespace {

constexpr int kNoHandle = -1;

// Models write fill values from 1e30 (a common choice) to 9.969e36 (netCDF's own). No quantity in a
// storm is that large.
constexpr double kLargestValue = 1e30;

// Maximum length in bytes of a text attribute. No attribute that a reader needs is longer.
constexpr std::size_t kLongestText = 1 << 20;

// Returns whether a program that is writing the file has locked it. HDF5 locks a file that it
// writes with flock(2). Opening a locked file for reading fails with NC_EHDFERR, which netCDF-C
// also returns for any damage.
bool IsHeldByWriter(int file) {
  if (flock(file, LOCK_SH | LOCK_NB) != 0) return errno == EWOULDBLOCK;
  flock(file, LOCK_UN);
  return false;
}

bool IsHeldByWriter(const std::string& path) {
  const base::FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  return file.IsOpen() && IsHeldByWriter(file.Get());
}

absl::Status HeldByWriter(const std::string& path) {
  return absl::UnavailableError(absl::StrCat(
      path, ": another program is writing it; try again when the model has closed it"));
}

absl::Status OpenError(const std::string& path, int code) {
  const std::string what = absl::StrCat(path, ": ");
  switch (code) {
    case ENOENT:
      return absl::NotFoundError(absl::StrCat(what, "there is no such file; check the path"));
    case EACCES:
      return absl::PermissionDeniedError(
          absl::StrCat(what, "may not be read; give this user permission to read it"));
    case EAGAIN:
      return HeldByWriter(path);
    case NC_ENOTNC:
      return absl::InvalidArgumentError(
          absl::StrCat(what, "is not a netCDF file; give the model's output file (wrfout_...)"));
    default:
      return absl::DataLossError(
          absl::StrCat(what, "cannot be opened as netCDF (", nc_strerror(code),
                       "); it is cut short, damaged or still being written: wait for the model "
                       "to finish, or copy the file again"));
  }
}

// The packing attributes of a variable. The fill values are packed values, like the stored values.
struct Packing {
  nc_type type = NC_FLOAT;
  double scale = 1.0;
  double offset = 0.0;
  double fill = std::numeric_limits<double>::quiet_NaN();
  double missing = std::numeric_limits<double>::quiet_NaN();

  bool PlainFloat() const { return type == NC_FLOAT && scale == 1.0 && offset == 0.0; }
};

double NumberOr(int handle, int variable, const char* name, double otherwise) {
  nc_type type;
  std::size_t length = 0;
  double value = otherwise;
  if (nc_inq_att(handle, variable, name, &type, &length) != NC_NOERR || length != 1 ||
      type == NC_CHAR || type == NC_STRING ||
      nc_get_att_double(handle, variable, name, &value) != NC_NOERR) {
    return otherwise;
  }
  return value;
}

double DefaultFill(nc_type type) {
  switch (type) {
    case NC_SHORT:
      return NC_FILL_SHORT;
    case NC_INT:
      return NC_FILL_INT;
    case NC_USHORT:
      return NC_FILL_USHORT;
    case NC_UINT:
      return NC_FILL_UINT;
    default:  // bytes have no default; the defaults of floating-point types exceed kLargestValue
      return std::numeric_limits<double>::quiet_NaN();
  }
}

Packing PackingOf(int handle, int variable) {
  Packing packing;
  nc_inq_vartype(handle, variable, &packing.type);
  packing.scale = NumberOr(handle, variable, "scale_factor", 1.0);
  packing.offset = NumberOr(handle, variable, "add_offset", 0.0);
  packing.fill = NumberOr(handle, variable, "_FillValue", DefaultFill(packing.type));
  packing.missing =
      NumberOr(handle, variable, "missing_value", std::numeric_limits<double>::quiet_NaN());
  return packing;
}

// Returns the unpacked value, or NaN if it is missing. The comparisons are written so that NaN
// fails them. `Real` is the type in which the values were read.
template <typename Real>
float Clean(Real packed, const Packing& packing) {
  constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
  if (packed == static_cast<Real>(packing.fill) || packed == static_cast<Real>(packing.missing)) {
    return kNotANumber;
  }
  const auto value = static_cast<Real>(packed * packing.scale + packing.offset);
  const Real size = std::abs(value);
  if (!(size < static_cast<Real>(kLargestValue))) return kNotANumber;
  return size < static_cast<Real>(std::numeric_limits<float>::min()) ? 0.0F
                                                                     : static_cast<float>(value);
}

void CleanPlainFloats(const Packing& packing, std::vector<float>& values) {
  const auto fill = static_cast<float>(packing.fill);
  const auto missing = static_cast<float>(packing.missing);
  for (float& value : values) {
    const float size = std::abs(value);
    const bool present =
        size < static_cast<float>(kLargestValue) && value != fill && value != missing;
    const float flushed = size < std::numeric_limits<float>::min() ? 0.0F : value;
    value = present ? flushed : std::numeric_limits<float>::quiet_NaN();
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

absl::Status NetcdfFile::CheckStart(const std::string& path, int file) {
  if (IsHeldByWriter(file)) return HeldByWriter(path);
  std::array<char, 8> start{};
  const auto read_at = [&](std::uint64_t offset) {
    return pread(file, start.data(), start.size(), static_cast<off_t>(offset));
  };
  ssize_t count = read_at(0);
  if (count == 0) return OpenError(path, NC_EHDFERR);
  if (std::string_view(start.data(), 3) == "CDF") return absl::OkStatus();
  for (std::uint64_t offset = kFirstHdf5Offset; count == std::ssize(start); offset *= 2) {
    if (IsHdf5Signature(std::as_bytes(std::span(start)))) return absl::OkStatus();
    count = read_at(offset);
  }
  return OpenError(path, NC_ENOTNC);
}

absl::StatusOr<NetcdfFile> NetcdfFile::Open(const std::string& path) {
  if (base::ReadsOnlyFromMemory()) {
    const std::optional<std::span<const std::byte>> bytes = base::RegisteredBytes(path);
    if (!bytes.has_value()) return OpenError(path, EACCES);
    if (bytes->empty()) return OpenError(path, NC_EHDFERR);
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
  // An empty file has just been created by its writer. HDF5 would report it as "unknown format".
  if (std::filesystem::file_size(path, error) == 0) return OpenError(path, NC_EHDFERR);
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

NetcdfFile::NetcdfFile(std::string path, int handle) : path_(std::move(path)), handle_(handle) {}

NetcdfFile::NetcdfFile(NetcdfFile&& other) noexcept
    : path_(std::move(other.path_)), handle_(std::exchange(other.handle_, kNoHandle)) {}

NetcdfFile& NetcdfFile::operator=(NetcdfFile&& other) noexcept {
  if (this != &other) {
    Close();
    path_ = std::move(other.path_);
    handle_ = std::exchange(other.handle_, kNoHandle);
  }
  return *this;
}

NetcdfFile::~NetcdfFile() { Close(); }

void NetcdfFile::Close() {
  if (handle_ == kNoHandle) return;
  const NetcdfLock lock;
  nc_close(std::exchange(handle_, kNoHandle));
}

bool NetcdfFile::HasVariable(const std::string& variable) const {
  const NetcdfLock lock;
  int id = 0;
  return nc_inq_varid(handle_, variable.c_str(), &id) == NC_NOERR;
}

std::optional<std::size_t> NetcdfFile::DimensionLength(const std::string& dimension) const {
  const NetcdfLock lock;
  int id = 0;
  std::size_t length = 0;
  if (nc_inq_dimid(handle_, dimension.c_str(), &id) != NC_NOERR ||
      nc_inq_dimlen(handle_, id, &length) != NC_NOERR) {
    return std::nullopt;
  }
  return length;
}

std::vector<std::string> NetcdfFile::Variables() const {
  const NetcdfLock lock;
  int count = 0;
  std::vector<std::string> names;
  if (nc_inq_nvars(handle_, &count) != NC_NOERR) return names;
  for (int id = 0; id < count; ++id) {
    char name[NC_MAX_NAME + 1];
    if (nc_inq_varname(handle_, id, name) == NC_NOERR) names.emplace_back(name);
  }
  return names;
}

absl::StatusOr<std::vector<std::string>> NetcdfFile::Dimensions(const std::string& variable) const {
  const NetcdfLock lock;
  int id = 0;
  int rank = 0;
  int dimensions[NC_MAX_VAR_DIMS];
  if (nc_inq_varid(handle_, variable.c_str(), &id) != NC_NOERR) {
    return absl::NotFoundError(absl::StrCat(path_, ": has no variable ", variable));
  }
  if (int code = nc_inq_var(handle_, id, nullptr, nullptr, &rank, dimensions, nullptr);
      code != NC_NOERR) {
    return ReadError(variable, code);
  }
  std::vector<std::string> names;
  for (int i = 0; i < rank; ++i) {
    char name[NC_MAX_NAME + 1];
    if (int code = nc_inq_dimname(handle_, dimensions[i], name); code != NC_NOERR) {
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
  THUNDERHEAD_ASSIGN_OR_RETURN(const int id, NumbersId(variable, shape.size()));
  if (const int code = nc_get_var_double(handle_, id, values.data()); code != NC_NOERR) {
    return ReadError(variable, code);
  }
  const Packing packing = PackingOf(handle_, id);
  for (double& value : values) {
    const bool missing = value == packing.fill || value == packing.missing;
    value = value * packing.scale + packing.offset;
    if (missing || !(std::abs(value) < kLargestValue)) {
      value = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return values;
}

absl::StatusOr<std::vector<std::size_t>> NetcdfFile::Shape(const std::string& variable) const {
  const NetcdfLock lock;
  int id = 0;
  int rank = 0;
  int dimensions[NC_MAX_VAR_DIMS];
  if (int code = nc_inq_varid(handle_, variable.c_str(), &id); code != NC_NOERR) {
    return absl::NotFoundError(absl::StrCat(path_, ": has no variable ", variable));
  }
  if (int code = nc_inq_var(handle_, id, nullptr, nullptr, &rank, dimensions, nullptr);
      code != NC_NOERR) {
    return ReadError(variable, code);
  }
  std::vector<std::size_t> shape(rank);
  for (int i = 0; i < rank; ++i) {
    if (int code = nc_inq_dimlen(handle_, dimensions[i], &shape[i]); code != NC_NOERR) {
      return ReadError(variable, code);
    }
  }
  return shape;
}

std::optional<std::string> NetcdfFile::TextAttribute(const std::string& variable,
                                                     const std::string& attribute) const {
  const NetcdfLock lock;
  int id = NC_GLOBAL;
  if (!variable.empty() && nc_inq_varid(handle_, variable.c_str(), &id) != NC_NOERR) return {};
  nc_type type;
  std::size_t length = 0;
  if (nc_inq_att(handle_, id, attribute.c_str(), &type, &length) != NC_NOERR) return {};
  if (type == NC_STRING && length == 1) {
    char* text = nullptr;
    if (nc_get_att_string(handle_, id, attribute.c_str(), &text) != NC_NOERR) return {};
    std::string value = text != nullptr ? text : "";
    nc_free_string(1, &text);
    return value;
  }
  if (type != NC_CHAR || length > kLongestText) return {};
  std::string value(length, '\0');
  if (nc_get_att_text(handle_, id, attribute.c_str(), value.data()) != NC_NOERR) return {};
  value.resize(std::char_traits<char>::find(value.data(), length, '\0') != nullptr
                   ? value.find('\0')
                   : length);
  return value;
}

std::optional<double> NetcdfFile::NumberAttribute(const std::string& variable,
                                                  const std::string& attribute) const {
  const NetcdfLock lock;
  int id = NC_GLOBAL;
  if (!variable.empty() && nc_inq_varid(handle_, variable.c_str(), &id) != NC_NOERR) return {};
  const double value =
      NumberOr(handle_, id, attribute.c_str(), std::numeric_limits<double>::quiet_NaN());
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

std::string NetcdfFile::TextOrEmpty(const std::string& variable,
                                    const std::string& attribute) const {
  if (std::optional<std::string> text = TextAttribute(variable, attribute); text.has_value()) {
    return *std::move(text);
  }
  const NetcdfLock lock;
  int id = NC_GLOBAL;
  if (!variable.empty() && nc_inq_varid(handle_, variable.c_str(), &id) != NC_NOERR) return "";
  const bool absent = nc_inq_att(handle_, id, attribute.c_str(), nullptr, nullptr) != NC_NOERR;
  return absent ? "" : "(not text)";
}

absl::StatusOr<std::vector<std::string>> NetcdfFile::ReadRows(const std::string& variable) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<std::size_t> shape, Shape(variable));
  const NetcdfLock lock;
  int id = 0;
  nc_type type = NC_NAT;
  nc_inq_varid(handle_, variable.c_str(), &id);
  nc_inq_vartype(handle_, id, &type);
  if (shape.size() == 1) shape.insert(shape.begin(), 1);
  if (shape.size() != 2 || type != NC_CHAR) {
    return absl::InvalidArgumentError(absl::StrCat(
        path_, ": ", variable, " is not a character variable of one or two dimensions"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t total, CountThatFits(variable, shape, 1));
  std::vector<char> text(total);
  if (text.empty()) return std::vector<std::string>(shape[0]);
  if (int code = nc_get_var_text(handle_, id, text.data()); code != NC_NOERR) {
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
                                    std::vector<float>& values) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<std::size_t> count, Shape(variable));
  if (count.empty() || record >= count[0]) {
    return absl::DataLossError(absl::StrCat(path_, ": ", variable, " has no record ", record,
                                            "; the file is shorter than it was: was it replaced?"));
  }
  std::vector<std::size_t> start(count.size(), 0);
  start[0] = record;
  count[0] = 1;
  return ReadFloats(variable, start, count, values);
}

absl::StatusOr<std::vector<float>> NetcdfFile::ReadPart(
    const std::string& variable, const std::vector<std::size_t>& start,
    const std::vector<std::size_t>& count) const {
  std::vector<float> values;
  THUNDERHEAD_RETURN_IF_ERROR(ReadFloats(variable, start, count, values));
  return values;
}

absl::Status NetcdfFile::ReadFloats(const std::string& variable,
                                    const std::vector<std::size_t>& start,
                                    const std::vector<std::size_t>& count,
                                    std::vector<float>& values) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t total, CountThatFits(variable, count, 4));
  values.resize(total);
  Packing packing;
  std::vector<double> packed;
  {
    const NetcdfLock lock;
    THUNDERHEAD_ASSIGN_OR_RETURN(const int id, NumbersId(variable, count.size()));
    packing = PackingOf(handle_, id);
    // The chunk cache is off. Every chunk is read once, and the cache would keep a second copy of
    // each variable.
    nc_set_var_chunk_cache(handle_, id, 0, 0, 0.0F);
    int code = NC_NOERR;
    if (packing.PlainFloat()) {
      code = nc_get_vara_float(handle_, id, start.data(), count.data(), values.data());
    } else {
      packed.resize(total);
      code = nc_get_vara_double(handle_, id, start.data(), count.data(), packed.data());
    }
    if (code != NC_NOERR) return ReadError(variable, code);
  }
  if (packing.PlainFloat()) {
    CleanPlainFloats(packing, values);
  } else {
    for (std::size_t i = 0; i < total; ++i) values[i] = Clean(packed[i], packing);
  }
  return absl::OkStatus();
}

absl::StatusOr<int> NetcdfFile::NumbersId(const std::string& variable, std::size_t rank) const {
  int id = 0;
  nc_type type = NC_NAT;
  int dimensions = 0;
  if (const int code = nc_inq_varid(handle_, variable.c_str(), &id); code != NC_NOERR) {
    return ReadError(variable, code);
  }
  if (const int code = nc_inq_var(handle_, id, nullptr, &type, &dimensions, nullptr, nullptr);
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
      // NetCDF-C reports NC_STRING for strings, and for numbers that it does not know, such as long
      // double. It would write pointers into the memory of the numbers.
      return absl::InvalidArgumentError(
          absl::StrCat(path_, ": ", variable,
                       " is of a type other than integers of up to 64 bits, float and double; "
                       "write it as one of those"));
  }
  if (static_cast<std::size_t>(dimensions) != rank) {
    return absl::InvalidArgumentError(absl::StrCat(path_, ": ", variable, " has ", dimensions,
                                                   " dimensions where ", rank, " are needed"));
  }
  return id;
}

absl::StatusOr<std::size_t> NetcdfFile::CountThatFits(const std::string& variable,
                                                      const std::vector<std::size_t>& lengths,
                                                      std::size_t bytes_each) const {
  return base::CountThatFits(absl::StrCat(path_, ": ", variable), lengths, bytes_each);
}

absl::Status NetcdfFile::ReadError(const std::string& variable, int code) const {
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
