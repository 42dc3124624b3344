#include "tests/support/mutated_log.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <new>
#include <string_view>
#include <thread>

#include "common/bus/log_file.hpp"
#include "common/math/random.hpp"

namespace lab {
namespace {

constexpr std::size_t kHeader = 16;  // fingerprint and utime of a message
constexpr std::size_t kUtime = 8;
constexpr std::size_t kSender = 20;

constexpr std::array kExtremes{0.0,
                               -0.0,
                               1.0,
                               -1.0,
                               5e-324,
                               1e-308,
                               1e-9,
                               1e-3,
                               0.1,
                               1e3,
                               1e6,
                               1e9,
                               1e18,
                               1e300,
                               -1e300,
                               std::numeric_limits<double>::max(),
                               std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()};
constexpr std::array<std::int64_t, 10> kWholes{0,
                                               1,
                                               -1,
                                               255,
                                               std::int64_t{1} << 31,
                                               std::int64_t{1} << 53,
                                               4'102'444'799'999'999,
                                               std::numeric_limits<std::int32_t>::max(),
                                               std::numeric_limits<std::int64_t>::max(),
                                               std::numeric_limits<std::int64_t>::min()};

std::size_t below(Random& random, std::size_t count) {
  return count == 0 ? 0 : static_cast<std::size_t>(random.next() % count);
}

void put(std::vector<std::uint8_t>& data, std::size_t at, std::uint64_t bits, std::size_t size) {
  if (at + size > data.size()) return;
  for (std::size_t i = 0; i < size; ++i) {
    data[at + i] = static_cast<std::uint8_t>(bits >> (8 * (size - 1 - i)));
  }
}

void overwrite(std::vector<std::uint8_t>& data, Random& random) {
  if (data.size() <= kHeader) return;
  const std::size_t at = 8 + below(random, data.size() - 8);
  if (random.uniform() < 0.5) {
    put(data, at, std::bit_cast<std::uint64_t>(kExtremes[below(random, kExtremes.size())]), 8);
  } else {
    const auto bits = static_cast<std::uint64_t>(kWholes[below(random, kWholes.size())]);
    put(data, at, bits, random.uniform() < 0.5 ? 8 : 4);
  }
}

void damage(RecordedMessage& message, Random& random) {
  std::vector<std::uint8_t>& data = message.data;
  if (data.empty()) return;
  switch (below(random, 12)) {
    case 0:
    case 1:
    case 2:
      data[below(random, data.size())] ^= static_cast<std::uint8_t>(1U << below(random, 8));
      break;
    case 3:
      data.resize(below(random, data.size() + 1));
      break;
    case 4:
      put(data, kUtime, static_cast<std::uint64_t>(kWholes[below(random, kWholes.size())]), 8);
      break;
    case 5:
      if (data.size() > kSender) data[kSender] = static_cast<std::uint8_t>(random.next());
      break;
    default:
      overwrite(data, random);
      break;
  }
}

void damage(std::vector<RecordedMessage>& messages, Random& random) {
  const std::size_t i = below(random, messages.size());
  RecordedMessage& one = messages[i];
  switch (below(random, 9)) {
    case 0:
      if (!one.data.empty()) {
        one.data[below(random, one.data.size())] ^=
            static_cast<std::uint8_t>(1U << below(random, 8));
      }
      break;
    case 1:
    case 2:
      overwrite(one.data, random);
      break;
    case 3: {  // many messages of one kind, as a broken sender would send them
      const std::uint64_t fault = random.next();
      for (RecordedMessage& other : messages) {
        if (other.channel != one.channel) continue;
        Random same(fault);
        overwrite(other.data, same);
      }
      break;
    }
    case 4:
      messages.insert(
          messages.begin() + static_cast<std::ptrdiff_t>(below(random, messages.size())),
          RecordedMessage(one));
      break;
    case 5: {
      const std::size_t count = std::min(below(random, 200), messages.size() - i - 1);
      const auto from = messages.begin() + static_cast<std::ptrdiff_t>(i);
      messages.erase(from, from + static_cast<std::ptrdiff_t>(count));
      break;
    }
    case 6:
      one.data.resize(below(random, one.data.size() + 1));
      break;
    case 7:
      put(one.data, 8, static_cast<std::uint64_t>(kWholes[below(random, kWholes.size())]), 8);
      if (random.uniform() < 0.5) one.utime = kWholes[below(random, kWholes.size())];
      break;
    default: {  // one sender among many forged ones
      if (one.data.size() <= kSender) break;
      std::vector<RecordedMessage> forged(300, one);
      for (std::size_t copy = 0; copy < forged.size(); ++copy) {
        forged[copy].data[kSender] = static_cast<std::uint8_t>('a' + copy % 26);
        put(forged[copy].data, kSender + 4, random.next(), 2);
      }
      messages.insert(messages.begin() + static_cast<std::ptrdiff_t>(i),
                      std::make_move_iterator(forged.rbegin()),
                      std::make_move_iterator(forged.rend()));
      break;
    }
  }
}

std::uint64_t number(const char* name, std::uint64_t usual) {
  const char* text = std::getenv(name);
  if (text == nullptr) return usual;
  std::uint64_t value = usual;
  const std::string_view view(text);
  std::from_chars(view.data(), view.data() + view.size(), value);
  return value;
}

std::array<char, 64> mutant_text{};
std::size_t mutant_size = 0;

extern "C" void nameMutant(int signal) {
  const auto written = ::write(STDERR_FILENO, mutant_text.data(), mutant_size);
  static_cast<void>(written);
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

/// A number of every child process, in memory that they share.
class ChildCounts {
 public:
  explicit ChildCounts(unsigned children)
      : size_(children * sizeof(std::uint64_t)),
        memory_(::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
  }
  ~ChildCounts() { ::munmap(memory_, size_); }
  ChildCounts(const ChildCounts&) = delete;
  ChildCounts& operator=(const ChildCounts&) = delete;

  [[nodiscard]] std::uint64_t& of(unsigned child) const {
    return static_cast<std::uint64_t*>(memory_)[child];
  }
  [[nodiscard]] std::uint64_t sum() const {
    std::uint64_t sum = 0;
    for (unsigned i = 0; i < size_ / sizeof sum; ++i) sum += of(i);
    return sum;
  }

 private:
  std::size_t size_;
  void* memory_;
};

}  // namespace

std::vector<RecordedMessage> recordedMessages(const std::filesystem::path& log) {
  std::vector<RecordedMessage> messages;
  static_cast<void>(readLog({log}, [&messages](const Packet& packet) {
    messages.push_back({std::string(packet.channel),
                        {packet.data.begin(), packet.data.end()},
                        packet.received_utime});
  }));
  return messages;
}

std::vector<RecordedMessage> mutated(std::vector<RecordedMessage> messages, std::uint64_t seed) {
  Random random(seed, 1);
  const std::size_t faults = 1 + below(random, 8);
  for (std::size_t i = 0; i < faults && !messages.empty(); ++i) damage(messages, random);
  return messages;
}

RecordedMessage mutant(RecordedMessage message, std::uint64_t seed) {
  Random random(seed, 4);
  const std::size_t faults = 1 + below(random, 4);
  for (std::size_t i = 0; i < faults; ++i) damage(message, random);
  return message;
}

void setUtime(RecordedMessage& message, std::int64_t utime) {
  put(message.data, kUtime, static_cast<std::uint64_t>(utime), 8);
}

void overwriteNumbers(std::vector<std::uint8_t>& data, std::uint64_t seed) {
  Random random(seed, 2);
  overwrite(data, random);
}

std::string logBytes(const std::vector<RecordedMessage>& messages, std::uint64_t seed) {
  Random random(seed, 3);
  std::vector<std::uint8_t> bytes;
  const auto append = [&bytes](std::uint64_t value, std::size_t size) {
    bytes.resize(bytes.size() + size);
    put(bytes, bytes.size() - size, value, size);
  };
  std::uint64_t count = 0;
  for (const RecordedMessage& message : messages) {
    append(0xEDA1DA01, 4);
    append(count++, 8);
    append(static_cast<std::uint64_t>(message.utime), 8);
    append(message.channel.size(), 4);
    append(message.data.size(), 4);
    bytes.insert(bytes.end(), message.channel.begin(), message.channel.end());
    bytes.insert(bytes.end(), message.data.begin(), message.data.end());
  }
  const double kind = random.uniform();
  for (std::size_t i = 0; kind < 0.3 && i < 1 + below(random, 200) && !bytes.empty(); ++i) {
    bytes[below(random, bytes.size())] ^= static_cast<std::uint8_t>(1U << below(random, 8));
  }
  if (kind > 0.9) bytes.resize(below(random, bytes.size() + 1));
  return {bytes.begin(), bytes.end()};
}

MutantWatch::MutantWatch(std::uint64_t seed) {
  const std::string text = "\nmutant " + std::to_string(seed) + "\n";
  mutant_size = std::min(text.size(), mutant_text.size());
  std::copy_n(text.begin(), mutant_size, mutant_text.begin());
  for (const int signal : {SIGSEGV, SIGFPE, SIGABRT, SIGALRM, SIGBUS}) {
    std::signal(signal, nameMutant);
  }
  ::alarm(60);
}

MutantWatch::~MutantWatch() {
  ::alarm(0);
  for (const int signal : {SIGSEGV, SIGFPE, SIGABRT, SIGALRM, SIGBUS}) {
    std::signal(signal, SIG_DFL);
  }
}

MutantRange mutants(std::uint64_t usual) {
  return {number("LAB_MUTANT", 1), number("LAB_MUTANTS", usual)};
}

std::uint64_t forEachMutant(const MutantRange& range,
                            const std::function<bool(std::uint64_t seed)>& mutant) {
  constexpr std::uint64_t kFewForChildren = 1000;
  const std::uint64_t end = range.first + range.count;
  std::uint64_t counting = 0;
  const auto tryEvery = [&](std::uint64_t first, std::uint64_t step) {
    for (std::uint64_t seed = first; seed < end; seed += step) {
      const MutantWatch watch(seed);
      counting += mutant(seed) ? 1U : 0U;
    }
  };
  const auto began = std::chrono::steady_clock::now();
  if (range.count < kFewForChildren) {
    tryEvery(range.first, 1);
    return counting;
  }
  const unsigned children = std::max(1U, std::thread::hardware_concurrency());
  const ChildCounts counts(children);
  std::vector<pid_t> ids;
  std::fflush(nullptr);
  for (unsigned i = 0; i < children; ++i) {
    const pid_t id = ::fork();
    if (id == 0) {
      tryEvery(range.first + i, children);
      counts.of(i) = counting;
      std::fflush(nullptr);
      ::_exit(testing::Test::HasFailure() ? 1 : 0);
    }
    EXPECT_GT(id, 0) << "fork";
    if (id > 0) ids.push_back(id);
  }
  for (const pid_t id : ids) {
    int status = -1;
    EXPECT_EQ(::waitpid(id, &status, 0), id);
    EXPECT_EQ(status, 0) << "a child found a fault, see above";
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("%llu mutants in %.0f s, %.0f per second, %u processes\n",
              static_cast<unsigned long long>(range.count), took.count(),
              static_cast<double>(range.count) / took.count(), children);
  return counts.sum();
}

}  // namespace lab
