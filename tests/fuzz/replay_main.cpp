// Runs a fuzzer without libFuzzer: over every file of its corpus, then over mutations of these
// files, which are the same every time. A child process runs them, so that the parent can save the
// input that ended it.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kLongest = 1 << 16;

Bytes readFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr unsigned kTimeout = 60;  // [s] for one input; ten times the usual one with sanitizers

/// The input that is running, in memory that the parent shares.
struct Current {
  std::size_t size;
  std::uint8_t bytes[kLongest];
};

Current& sharedInput() {
  void* memory =
      mmap(nullptr, sizeof(Current), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    std::perror("mmap");
    std::exit(2);
  }
  return *static_cast<Current*>(memory);
}

void run(const Bytes& input, Current& current) {
  current.size = std::min(input.size(), kLongest);
  std::copy_n(input.begin(), current.size, current.bytes);
  alarm(kTimeout);
  // A copy of exactly this size: the sanitizers then notice one byte read too many.
  const Bytes exact(input.begin(), input.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

class Mutator {
 public:
  explicit Mutator(const std::vector<Bytes>& corpus) : corpus_(corpus) {}

  Bytes next() {
    Bytes bytes = corpus_[below(corpus_.size())];
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(bytes);
    if (bytes.size() > kLongest) bytes.resize(kLongest);
    return bytes;
  }

 private:
  // Not a distribution of the library: their numbers differ between libraries.
  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : random_() % limit; }

  void change(Bytes& bytes) {
    static constexpr std::uint8_t kSpecial[] = {0, 1, 0x7F, 0x80, 0xFE, 0xFF, '0', '9', '-', '"'};
    const std::size_t at = below(bytes.size());
    const std::size_t length = 1 + below(std::min<std::size_t>(16, bytes.size() - at));
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = bytes.empty() ? begin : begin + static_cast<std::ptrdiff_t>(length);
    switch (below(6)) {
      case 0:
        if (!bytes.empty()) *begin = static_cast<std::uint8_t>(*begin ^ (1U << below(8)));
        break;
      case 1:
        std::fill(begin, end, kSpecial[below(std::size(kSpecial))]);
        break;
      case 2:
        bytes.erase(begin, end);
        break;
      case 3: {
        const Bytes again(begin, end);
        bytes.insert(begin, again.begin(), again.end());
        break;
      }
      case 4:
        for (auto byte = begin; byte != end; ++byte) *byte = static_cast<std::uint8_t>(below(256));
        break;
      default: {  // the rest of another file
        const Bytes& other = corpus_[below(corpus_.size())];
        bytes.resize(at);
        bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(below(other.size())),
                     other.end());
      }
    }
  }

  const std::vector<Bytes>& corpus_;
  std::mt19937_64 random_{1};
};

void runAll(const std::vector<fs::path>& files, long mutated, Current& current) {
  std::vector<Bytes> inputs;
  for (const fs::path& file : files) {
    std::printf("%s\n", file.filename().c_str());
    std::fflush(stdout);
    inputs.push_back(readFile(file));
    run(inputs.back(), current);
  }
  std::printf("%ld mutated inputs\n", mutated);
  std::fflush(stdout);
  Mutator mutator(inputs);
  for (long i = 0; i < mutated; ++i) run(mutator.next(), current);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "Usage: %s CORPUS_OR_FILE [MUTATED_INPUTS]\n", argv[0]);
    return 2;
  }
  const fs::path corpus = argv[1];
  std::vector<fs::path> files;
  if (fs::is_directory(corpus)) {
    for (const auto& entry : fs::directory_iterator(corpus)) files.push_back(entry.path());
    std::ranges::sort(files);
  } else if (fs::is_regular_file(corpus)) {
    files.push_back(corpus);
  }
  if (files.empty()) {
    std::fprintf(stderr, "%s: found no file, expected a corpus\n", argv[1]);
    return 2;
  }
  Current& current = sharedInput();
  const pid_t child = fork();
  if (child == 0) {
    runAll(files, argc > 2 ? std::atol(argv[2]) : 0, current);
    std::exit(0);
  }
  int status = -1;
  if (child < 0 || waitpid(child, &status, 0) != child) std::perror("fork");
  if (status == 0) return 0;
  const std::string name = fs::path(argv[0]).filename().string() + ".input";
  std::ofstream(name, std::ios::binary)
      .write(reinterpret_cast<const char*>(current.bytes),
             static_cast<std::streamsize>(current.size));
  std::fprintf(stderr, "%s: %s %d; the input is in %s\n", argv[0],
               WIFSIGNALED(status) ? "ended by signal" : "exit status",
               WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status),
               fs::absolute(name).c_str());
  return 1;
}
