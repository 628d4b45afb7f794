// Runs a fuzz target without libFuzzer: every kept input, then a number of mutations of them, which
// depend only on the seed. With --seconds it runs further mutations until that time is over. A
// target that defines LLVMFuzzerCustomMutator makes two thirds of the mutations itself.
//   fuzz_NAME FOLDER|FILE... [--runs N] [--seed N] [--seconds N] [--memory MIB] [--slowest SECONDS]
//
// With --memory, an input that needs more memory than that counts as a finding, and so does one
// that takes more processor time than --slowest (ten minutes by default).
// Processor time is measured, because other processes may keep this one waiting for minutes.
// An input that ends the process is left in the file finding-NAME. The time limit also holds for
// the exit of the target, in which it frees what it kept.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" [[gnu::weak]] std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                                             std::size_t most, unsigned int seed);
// The sanitizers' library chose the reserved name.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" [[gnu::weak]] void __sanitizer_set_death_callback(void (*callback)());

namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

// The input that runs, and the file to keep it in, for the handlers of fatal signals.
std::string running;
std::string finding;
bool all_ran = false;

void Say(std::string_view text) {
  static_cast<void>(!write(STDERR_FILENO, text.data(), text.size()));
}

void KeepFinding() {
  if (all_ran) return Say("all inputs ran, and the target does not end\n");
  const int file = open(finding.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
  if (file < 0) return;
  static_cast<void>(!write(file, running.data(), running.size()));
  close(file);
  Say("the input is in ");
  Say(finding);
  Say("\n");
}

void OnSignal(int signal) {
  KeepFinding();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void Run(std::string input) {
  running = std::move(input);
  // Copies the input without spare capacity, so that a sanitizer detects reads beyond its end.
  const std::vector<std::uint8_t> bytes(running.begin(), running.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

std::string Contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Mutator {
 public:
  Mutator(std::vector<std::string> inputs, std::uint64_t seed)
      : inputs_(std::move(inputs)), random_(seed) {}

  std::string Next() {
    std::string input = inputs_[Below(inputs_.size())];
    if (LLVMFuzzerCustomMutator != nullptr && Below(3) != 0) return ByTarget(std::move(input));
    for (std::size_t edits = 1 + Below(8); edits > 0; --edits) Edit(input);
    return input;
  }

 private:
  std::size_t Below(std::size_t end) { return random_() % std::max<std::size_t>(end, 1); }

  std::string ByTarget(std::string input) {
    const std::size_t size = input.size();
    input.resize(std::max(size, kLongest));
    input.resize(LLVMFuzzerCustomMutator(reinterpret_cast<std::uint8_t*>(input.data()), size,
                                         input.size(), static_cast<unsigned>(random_())));
    return input;
  }

  void Edit(std::string& input) {
    constexpr std::array<std::uint64_t, 10> kValues = {
        0, 1, 0x7f, 0x80, 0xff, 0x7fff, 0xffff, 0x7fffffff, 0xffffffff, 0x7fffffffffffffff};
    const std::size_t at = Below(input.size() + 1);
    const std::size_t count = std::min<std::size_t>(1 + Below(16), input.size() - at);
    switch (Below(7)) {
      case 0:
        if (at < input.size()) input[at] = static_cast<char>(input[at] ^ (1 << Below(8)));
        break;
      case 1:
        if (at < input.size()) input[at] = static_cast<char>(random_());
        break;
      case 2:
        input.erase(at, count);
        break;
      case 3:
        input.insert(at, input.substr(Below(input.size()), count));
        break;
      case 4: {
        const std::string& other = inputs_[Below(inputs_.size())];
        input.insert(at, other.substr(Below(other.size()), 1 + Below(32)));
        break;
      }
      case 5: {
        std::uint64_t value = kValues[Below(kValues.size())];
        const std::size_t bytes = std::size_t{1} << Below(4);
        const bool big = Below(2) == 0;
        for (std::size_t i = 0; i < bytes && at + i < input.size(); ++i) {
          input[at + (big ? bytes - 1 - i : i) % (input.size() - at)] =
              static_cast<char>(value & 0xff);
          value >>= 8U;
        }
        break;
      }
      default:
        input.resize(at);
    }
    if (input.size() > kLongest) input.resize(kLongest);
  }

  static constexpr std::size_t kLongest = 64 << 10;

  const std::vector<std::string> inputs_;
  std::mt19937_64 random_;
};

void TakeInputs(const fs::path& path, std::vector<std::string>& inputs) {
  std::vector<fs::path> files;
  if (fs::is_directory(path)) {
    for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  } else {
    files.push_back(path);
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) inputs.push_back(Contents(file));
}

void LimitMemory(std::uint64_t bytes) {
  // AddressSanitizer reserves terabytes of addresses.
  if (bytes == 0 || __sanitizer_set_death_callback != nullptr) return;
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_AS, &limit);
}

// Ends the process by SIGPROF after this much processor time from now.
void LimitProcessorTime(unsigned seconds) {
  const itimerval timer{{0, 0}, {static_cast<time_t>(seconds), 0}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

// Returns the largest amount of memory that the process has had, in MiB.
double PeakMemory_MiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 0.0;
  std::uint64_t runs = 0;
  std::uint64_t seed = 1;
  std::uint64_t memory_MiB = 0;
  unsigned slowest_s = 600;
  std::vector<std::string> inputs;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument(argv[i]);
    const char* const value = i + 1 < argc ? argv[i + 1] : "0";
    if (argument == "--seconds") {
      seconds = std::atof(value);
      ++i;
    } else if (argument == "--runs") {
      runs = std::strtoull(value, nullptr, 10);
      ++i;
    } else if (argument == "--seed") {
      seed = std::strtoull(value, nullptr, 10);
      ++i;
    } else if (argument == "--memory") {
      memory_MiB = std::strtoull(value, nullptr, 10);
      ++i;
    } else if (argument == "--slowest") {
      slowest_s = static_cast<unsigned>(std::strtoul(value, nullptr, 10));
      ++i;
    } else {
      TakeInputs(argv[i], inputs);
    }
  }
  if (inputs.empty()) {
    std::fprintf(stderr, "%s: no inputs; name a folder of tests/fuzz/corpus\n", argv[0]);
    return 1;
  }
  finding = "finding-" + fs::path(argv[0]).filename().string();
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGPROF}) {
    if (__sanitizer_set_death_callback == nullptr || signal == SIGPROF) {
      std::signal(signal, OnSignal);
    }
  }
  if (__sanitizer_set_death_callback != nullptr) __sanitizer_set_death_callback(KeepFinding);
  LimitMemory(memory_MiB << 20U);
  for (const std::string& input : inputs) {
    LimitProcessorTime(slowest_s);
    Run(input);
  }
  Mutator mutator(inputs, seed);
  const auto start = steady_clock::now();
  const auto passed = [start] {
    return std::chrono::duration<double>(steady_clock::now() - start).count();
  };
  std::uint64_t mutations = 0;
  double longest_s = 0.0;
  while (mutations < runs || passed() < seconds) {
    const double before_s = passed();
    LimitProcessorTime(slowest_s);
    Run(mutator.Next());
    longest_s = std::max(longest_s, passed() - before_s);
    ++mutations;
    constexpr std::uint64_t kReport = 10'000;
    if (mutations % kReport == 0) {
      std::fprintf(stderr, "%llu mutations in %.1f s\n", static_cast<unsigned long long>(mutations),
                   passed());
    }
  }
  all_ran = true;
  LimitProcessorTime(slowest_s);
  std::printf("%zu inputs, %llu mutations in %.1f s, the slowest in %.2f s, peak memory %.0f MiB\n",
              inputs.size(), static_cast<unsigned long long>(mutations), passed(), longest_s,
              PeakMemory_MiB());
  std::fflush(stdout);
  return 0;
}
