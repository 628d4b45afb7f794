// Reads mutated storm files in confined processes, one each, as the server reads files that it does
// not trust. There are mutated files of three formats and sparse files of enormous dimensions.
// There are also netCDF-4 files whose variables have types, storage layouts and filters that
// netCDF-C never writes. Every file must give a storm or one clear error that names the file. Only
// netCDF-C and HDF5 may crash or take too long, which ends just their process. If our own code
// does, the test fails.
//   hostile_files [NUMBER] [SEED] [FILE, the only one to be read; exits with its outcome]
#include <dlfcn.h>
#include <execinfo.h>
#include <netcdf.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "absl/strings/match.h"
#include "base/guarded.h"
#include "base/status.h"
#include "netcdf/netcdf_file.h"
#include "sandbox/confinement.h"
#include "spdlog/spdlog.h"
#include "storm_files/storm_format.h"
#include "storm_store/storm_catalogue.h"
#include "tests/fuzz/dice.h"
#include "tests/fuzz/foreign_storage.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace thunderhead;
using testing::Dice;
using testing::SyntheticWrf;
using testing::WrfCell;
using testing::WrfFormat;

constexpr std::uint64_t kMemory = std::uint64_t{512} << 20;

// Numbers that break arithmetic.
constexpr std::array kOddNumbers = {0.0,  -1.0,  1e-30, 1e30,  1e300, -1e300, 9.96921e36,
                                    1e-5, 100.0, 1e5,   0.499, 0.501, 2.2e-38};

// Returns the description of a WRF file with random changes.
SyntheticWrf OddWrf(Dice& dice, WrfFormat format) {
  SyntheticWrf file;
  file.format = format;
  file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) { return 1e-4 * cell.level; };
  file.mixing_ratios["QRAIN"] = [](const WrfCell&) { return 1e-4; };
  constexpr std::array kVariables = {"PH",     "PHB",   "P",     "PB", "T",  "QVAPOR",
                                     "QCLOUD", "QRAIN", "Times", "DX", "DY", "HGT"};
  constexpr std::array kUnits = {"", "1", "kg kg-1", "g/kg", "m2 s-2", "Pa", "\xff\xfe", "K"};
  constexpr std::array kTimes = {"2013-05-20_20:00:00", "0000-01-01_00:00:00",
                                 "9999-12-31_23:59:59", "2013-02-30_20:00:00",
                                 "-001-01-01_00:00:00", "\xff\xff\xff\xff-\xff"};
  for (std::size_t changes = dice.Below(4); changes > 0; --changes) {
    const std::string variable = dice.Of(kVariables);
    const double number = dice.Of(kOddNumbers);
    switch (dice.Below(14)) {
      case 0:
        file.nx = 1 + static_cast<int>(dice.Below(9));
        break;
      case 1:
        file.ny = 1 + static_cast<int>(dice.Below(9));
        break;
      case 2:
        file.levels = 1 + static_cast<int>(dice.Below(20));
        break;
      case 3:
        file.dx_m = number;
        break;
      case 4:
        file.times = {std::string(dice.Of(kTimes)).append(19, '\0')};
        break;
      case 5:
        file.omitted.insert(variable);
        break;
      case 6:
        file.units[variable] = dice.Of(kUnits);
        break;
      case 7:
        file.stored_values.push_back({variable, {0, 0, 0, 0}, number});
        break;
      case 8:
        file.pressure_Pa = number;
        break;
      case 9:
        file.interface_height_m = [number](const WrfCell& cell) { return number * cell.level; };
        break;
      case 10:
        file.packed.insert(dice.OneIn(2) ? "QCLOUD" : "PB");
        break;
      case 11:
        file.one_level_short.insert(variable);
        break;
      case 12:
        file.mixing_ratios["QNRAIN"] = [number](const WrfCell&) { return number; };
        break;
      default:
        file.potential_temperature_K = number;
    }
  }
  if (file.omitted.contains("Times")) file.times.resize(1);
  return file;
}

// Returns the description of a CF file with random changes.
testing::SyntheticCf OddCf(Dice& dice) {
  const double value = dice.OneIn(2) ? 1e-3 : dice.Of(kOddNumbers);
  testing::SyntheticCf file =
      testing::ExtinctionFile(1 + dice.Below(6), 1 + dice.Below(6), 1 + dice.Below(40), 100.0,
                              100.0, 50.0, [value](auto, auto, auto) { return value; });
  constexpr std::array kTexts = {"m",
                                 "km",
                                 "degrees_east",
                                 "degrees_north",
                                 "seconds since 2013-05-20",
                                 "days since 99999999-01-01",
                                 "1",
                                 "",
                                 "\xff",
                                 "down",
                                 "x",
                                 "z",
                                 "T",
                                 "Pa"};
  constexpr std::array kNames = {"units",         "axis",   "positive",
                                 "standard_name", "bounds", "_FillValue"};
  for (std::size_t changes = dice.Below(3); changes > 0; --changes) {
    testing::CfCoordinate& coordinate = file.coordinates[dice.Below(3)];
    switch (dice.Below(5)) {
      case 0:
        coordinate.attributes[dice.Of(kNames)] = dice.Of(kTexts);
        break;
      case 1:
        coordinate.values[dice.Below(coordinate.values.size())] = dice.Of(kOddNumbers);
        break;
      case 2:
        coordinate.written = false;
        break;
      case 3:
        for (std::size_t i = 0; i <= coordinate.values.size(); ++i) {
          coordinate.faces.push_back(static_cast<double>(i * i) * dice.Of(kOddNumbers));
        }
        break;
      default:
        file.variables[0].attributes["units"] = dice.Of(kTexts);
    }
    if (coordinate.attributes.contains("_FillValue")) coordinate.attributes.erase("_FillValue");
  }
  return file;
}

// Returns the description of a file on an unstructured grid with random changes. Half of the files
// have the names of MPAS, and the others those of ICON.
testing::SyntheticCf OddCells(Dice& dice) {
  const bool mpas = dice.OneIn(2);
  const std::size_t cells = 3 + dice.Below(40);
  const std::size_t row = 1 + dice.Below(8);
  const double step = dice.OneIn(8) ? dice.Of(kOddNumbers) : 1e-3;
  const double value = dice.OneIn(2) ? 1e-3 : dice.Of(kOddNumbers);
  const std::string on = mpas ? "nCells" : "ncells";
  const std::string z = mpas ? "nVertLevels" : "height";
  const std::string faces = mpas ? "nVertLevelsP1" : "height_2";
  const std::size_t layers = 1 + dice.Below(10);
  testing::SyntheticCf file;
  file.coordinates = {{on, std::vector<double>(cells), {}, {}, false},
                      {z, std::vector<double>(layers), {}, {}, false},
                      {faces, std::vector<double>(layers + 1), {}, {}, false}};
  const auto at = [&dice, on, step](std::size_t of, std::size_t by) {
    const double odd = dice.OneIn(12) ? dice.Of(kOddNumbers) : 0.0;
    const bool is_odd = odd != 0.0;
    const std::size_t which = dice.Below(40);
    return [=](const std::map<std::string, std::size_t>& index) {
      const std::size_t cell = index.at(on);
      return is_odd && cell == which ? odd : step * static_cast<double>(cell / of % by);
    };
  };
  file.variables = {
      {mpas ? "lonCell" : "clon", {on}, {{"units", "radian"}}, at(1, row)},
      {mpas ? "latCell" : "clat", {on}, {{"units", "radian"}}, at(row, 1000)},
      {mpas ? "zgrid" : "z_ifc",
       {faces, on},
       {{"units", "m"}},
       [=](const auto& index) { return 100.0 * static_cast<double>(index.at(faces)); }},
      {"qc", {z, on}, {{"units", "kg m-3"}}, [value](const auto&) { return value; }}};
  if (dice.OneIn(12)) file.variables.erase(file.variables.begin() + dice.Below(3));
  if (dice.OneIn(8)) file.attributes["on_a_sphere"] = "NO";
  return file;
}

// Changes random bytes, mostly in the header.
void Damage(Dice& dice, std::string& bytes) {
  constexpr std::array<unsigned char, 6> kBytes = {0, 1, 0x7f, 0x80, 0xfe, 0xff};
  for (std::size_t edits = 1 + dice.Below(3); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at =
        dice.Below(dice.OneIn(2) ? bytes.size() : std::min<std::size_t>(bytes.size(), 2048));
    switch (dice.Below(5)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << dice.Below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(dice.Of(kBytes));
        break;
      case 2:
        for (std::size_t i = at; i < std::min(at + 8, bytes.size()); ++i)
          bytes[i] = static_cast<char>(dice.Of(kBytes));
        break;
      case 3:
        bytes.erase(at, dice.Below(64));
        break;
      default:
        if (dice.OneIn(4)) bytes.resize(at);
    }
  }
}

absl::Status ReadStorm(const std::string& path) {
  const storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
  THUNDERHEAD_ASSIGN_OR_RETURN(storm_files::StormFile file,
                               storm_store::DescribeFile(path, formats));
  // A file that has only a part of a time has no reader. It is described again as if it were the
  // only file of its time.
  if (!file.part.of.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(file, formats.DescribeTogether({path}));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const storm_files::VerticalGrid grid,
                               file.reader->ReadVerticalGrid(0));
  return file.reader->Read(file.times.size() - 1, grid, {}).status();
}

enum Outcome {
  kRead = 0,
  kClearError = 10,
  kLibraryCrashed = 11,  // in netCDF-C or HDF5, which the confinement is for
  kLibraryHung = 12,     // a timeout in one of them
  // The following outcomes are failures.
  kUnclearError = 13,
  kNotConfined = 14,
  kWeCrashed = 15,
  kWeHung = 16,
};

const char* NameOf(int outcome) {
  switch (outcome) {
    case kRead:
      return "read";
    case kClearError:
      return "one clear error";
    case kLibraryCrashed:
      return "netCDF-C or HDF5 crashed";
    case kLibraryHung:
      return "netCDF-C or HDF5 hung";
    case kUnclearError:
      return "UNCLEAR ERROR";
    case kNotConfined:
      return "NOT CONFINED";
    case kWeCrashed:
      return "WE CRASHED";
    case kWeHung:
      return "WE HUNG";
    default:
      return "ENDED BY A SIGNAL";
  }
}

// Returns true if the innermost frame on the stack outside the C and C++ libraries is in netCDF-C
// or HDF5.
bool IsInLibrary() {
  std::array<void*, 64> stack{};
  const int depth = backtrace(stack.data(), static_cast<int>(stack.size()));
  // The first two frames belong to this function and the handler.
  for (int i = 2; i < depth; ++i) {
    Dl_info info{};
    const bool known = dladdr(stack[static_cast<std::size_t>(i)], &info) != 0;
    const absl::string_view object = known && info.dli_fname != nullptr ? info.dli_fname : "";
    if (absl::StrContains(object, "libnetcdf") || absl::StrContains(object, "libhdf5")) return true;
    if (!absl::StrContains(object, "/lib")) return false;
  }
  return false;
}

void EndBySignal(int signal) {
  const bool hung = signal == SIGXCPU;
  if (IsInLibrary()) _exit(hung ? kLibraryHung : kLibraryCrashed);
  _exit(hung ? kWeHung : kWeCrashed);
}

// Installs handlers of fatal signals, which report whose code was at fault. They run on a separate
// stack, because the signal may be a stack overflow.
void NoteSignals() {
  static std::array<char, std::size_t{1} << 16> stack;
  const stack_t other{.ss_sp = stack.data(), .ss_flags = 0, .ss_size = stack.size()};
  sigaltstack(&other, nullptr);
  IsInLibrary();  // loads what backtrace needs
  struct sigaction action {};
  action.sa_handler = EndBySignal;
  action.sa_flags = SA_ONSTACK;
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGSYS}) {
    sigaction(signal, &action, nullptr);
  }
}

// Returns the exit code of reading the file in a separate process, or the negative number of its
// signal.
int OutcomeOf(const std::string& path, const std::string& bytes) {
  const pid_t child = fork();
  if (child == 0) {
    spdlog::set_level(spdlog::level::off);
    NoteSignals();
    base::ReadFromMemory(path, std::as_bytes(std::span(bytes)));
    const std::string_view start =
        std::string_view(bytes).substr(0, storm_files::UnknownFile::kStart_bytes);
    const bool prepared =
        storm_files::StormFormats::BuiltIn().PrepareBeforeConfinement({start}).ok();
    if (!prepared || !sandbox::Confine({kMemory, 10}).ok()) _exit(kNotConfined);
    const absl::Status status = base::Guarded([&] { return ReadStorm(path); });
    const std::string message(status.message());
    if (status.ok()) _exit(kRead);
    if (std::getenv("HOSTILE_VERBOSE") != nullptr) std::fprintf(stderr, "%s\n", message.c_str());
    const bool clear = absl::StrContains(message, path) || absl::IsResourceExhausted(status);
    _exit(clear && message.find('\0') == std::string::npos ? kClearError : kUnclearError);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

// Returns true if the file could be written: netCDF-C refuses some values, and the test support
// then ends its process.
template <typename Write>
bool Writes(const Write& write) {
  const pid_t child = fork();
  if (child == 0) {
    std::freopen("/dev/null", "w", stderr);
    write();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0;
}

std::string BytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Writes a netCDF-4 file of a few kilobytes that announces a grid of 10^5 cells along each axis.
void WriteSparse(const std::string& path, bool cf) {
  constexpr std::size_t kLength = 99'999;  // and one more interface
  int id = 0;
  const auto must = [](int code) {
    if (code != NC_NOERR) std::abort();
  };
  must(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &id));
  std::array<int, 4> on{};
  const std::array names = {"Time", cf ? "z" : "bottom_top", cf ? "y" : "south_north",
                            cf ? "x" : "west_east"};
  for (std::size_t i = 0; i < 4; ++i) must(nc_def_dim(id, names[i], i == 0 ? 1 : kLength, &on[i]));
  int above = 0;
  if (!cf) must(nc_def_dim(id, "bottom_top_stag", kLength + 1, &above));
  const std::array<std::size_t, 4> chunks = {1, 1, 1000, 1000};
  for (const char* name : {"QCLOUD", "P", "PB", "T", "PH", "PHB", "extinction"}) {
    if (cf != (name[0] == 'e')) continue;
    std::array<int, 4> dimensions = on;
    if (!cf && name[0] == 'P' && name[1] == 'H') dimensions[1] = above;
    int variable = 0;
    must(nc_def_var(id, name, NC_FLOAT, 4, dimensions.data(), &variable));
    must(nc_def_var_chunking(id, variable, NC_CHUNKED, chunks.data()));
    if (cf) must(nc_put_att_text(id, variable, "units", 3, "m-1"));
  }
  if (!cf) {
    const double spacing_m = 1000.0;
    for (const char* name : {"DX", "DY"})
      must(nc_put_att_double(id, NC_GLOBAL, name, NC_DOUBLE, 1, &spacing_m));
    int length = 0;
    int times = 0;
    must(nc_def_dim(id, "DateStrLen", 19, &length));
    const int both[] = {on[0], length};
    must(nc_def_var(id, "Times", NC_CHAR, 2, both, &times));
    must(nc_put_var_text(id, times, "2013-05-20_20:00:00"));
  } else {
    for (std::size_t i = 1; i < 4; ++i) {
      int variable = 0;
      must(nc_def_var(id, names[i], NC_DOUBLE, 1, &on[i], &variable));
      must(nc_put_att_text(id, variable, "units", 1, "m"));
      std::vector<double> values(kLength);
      for (std::size_t j = 0; j < kLength; ++j) values[j] = 100.0 * static_cast<double>(j);
      must(nc_put_var_double(id, variable, values.data()));
    }
  }
  must(nc_close(id));
}

// A kind of file that is mutated.
struct Kind {
  const char* name;
  bool cf = false;
  bool cells = false;  // of an unstructured grid
  bool classic = false;
  bool foreign = false;  // stored in ways of HDF5 that netCDF-C never writes
};

constexpr std::array kKinds = {Kind{.name = "WRF netCDF-4"},
                               Kind{.name = "WRF classic", .classic = true},
                               Kind{.name = "CF netCDF-4", .cf = true},
                               Kind{.name = "CF cells", .cf = true, .cells = true},
                               Kind{.name = "WRF foreign storage", .foreign = true},
                               Kind{.name = "CF foreign storage", .cf = true, .foreign = true}};

}  // namespace

int main(int argc, char** argv) {
  const std::size_t number = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 300;
  Dice dice(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("wrfout_d01");
  std::map<std::string, std::map<int, std::size_t>> outcomes;
  bool failed = false;
  if (argc > 3) return OutcomeOf(argv[3], BytesOf(argv[3]));
  const auto count = [&](const std::string& name, std::size_t kind, const std::string& bytes) {
    const int outcome = OutcomeOf(path, bytes);
    ++outcomes[name][outcome];
    if (outcome == kRead || outcome == kClearError) return;
    std::ofstream("hostile-" + std::to_string(outcome) + "-" + std::to_string(kind),
                  std::ios::binary)
        << bytes;
  };
  for (const bool cf : {false, true}) {
    WriteSparse(path, cf);
    const int outcome = OutcomeOf(path, BytesOf(path));
    ++outcomes[cf ? "sparse CF" : "sparse WRF"][outcome];
    failed = failed || outcome != kClearError;
  }
  static std::array<std::string, kKinds.size()> sound;
  for (std::size_t i = 0; i < number; ++i) {
    const std::size_t at = i % kKinds.size();
    const Kind& kind = kKinds[at];
    // A new description is written only occasionally, because writing costs more than reading.
    if (sound[at].empty() || dice.OneIn(kind.foreign ? 2 : 8)) {
      constexpr std::array kClassic = {WrfFormat::kClassic, WrfFormat::kOffset64, WrfFormat::kCdf5};
      const WrfFormat format = kind.classic ? dice.Of(kClassic) : WrfFormat::kNetcdf4;
      const SyntheticWrf wrf = OddWrf(dice, format);
      const testing::SyntheticCf cf = kind.cells ? OddCells(dice) : OddCf(dice);
      Dice changes(dice.Below(std::size_t{1} << 62));
      const bool written = Writes([&] {
        if (kind.cf) testing::WriteCf(cf, path);
        if (!kind.cf) testing::WriteWrf(wrf, path);
        if (kind.foreign) testing::ChangeStorage(changes, path);
      });
      if (!written) {
        --i;
        continue;
      }
      sound[at] = BytesOf(path);
      count(std::string(kind.name) + ", as written", at, sound[at]);
    }
    std::string bytes = sound[at];
    Damage(dice, bytes);
    count(std::string(kind.name) + ", damaged", at, bytes);
  }
  for (const auto& [name, counts] : outcomes) {
    std::printf("%-32s", name.c_str());
    for (const auto& [outcome, times] : counts) {
      std::printf("  %s %zu", NameOf(outcome), times);
      failed = failed || outcome < 0 || outcome > kLibraryHung;
    }
    std::printf("\n");
  }
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  std::printf("largest reader %ld MiB\n", usage.ru_maxrss >> 10);
  return failed ? 1 : 0;
}
