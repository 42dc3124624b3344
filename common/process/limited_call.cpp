#include "common/process/limited_call.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <stdexcept>
#include <system_error>

#include "common/process/file_descriptor.hpp"
#include "common/process/pipe.hpp"

namespace lab {
namespace {

constexpr char kReturned = 'r', kThrown = 't';  // first byte of the answer

[[noreturn]] void failWithErrno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void limit(decltype(RLIMIT_CPU) resource, rlim_t soft, rlim_t hard) {
  rlimit now{};
  getrlimit(resource, &now);
  const rlimit bound{std::min(soft, now.rlim_max), std::min(hard, now.rlim_max)};
  if (setrlimit(resource, &bound) != 0) failWithErrno("cannot limit the reader");
}

void setLimits(const CallLimits& limits) {
  const auto seconds = static_cast<rlim_t>(limits.processor.count());
  limit(RLIMIT_CPU, seconds, seconds + 1);
  limit(RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes);
  limit(RLIMIT_CORE, 0, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // Sanitizers reserve terabytes.
  limit(RLIMIT_DATA, limits.memory_bytes, limits.memory_bytes);
#endif
}

void writeAll(int descriptor, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(descriptor, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;
    written += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void runHere(const CallLimits& limits, const std::function<std::string()>& work,
                          int answer, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  for (int number = 1; number < NSIG; ++number) std::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // What libraries print about damaged memory is no line for the user.
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nothing >= 0) dup2(nothing, STDERR_FILENO);
  std::string text;
  try {
    setLimits(limits);
    text = kReturned + work();
  } catch (const std::bad_alloc&) {
    text =
        kThrown + fmt::format("needs more than {} MB of memory", limits.memory_bytes / 1'000'000);
  } catch (const std::exception& error) {
    text = kThrown + std::string(error.what());
  }
  writeAll(answer, text);
  _exit(0);
}

/// Signals that ask this process to end wait in a descriptor.
class HeldSignals {
 public:
  HeldSignals() {
    sigset_t held;
    sigemptyset(&held);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&held, number);
    sigprocmask(SIG_BLOCK, &held, &before_);
    descriptor_ = FileDescriptor(signalfd(-1, &held, SFD_CLOEXEC | SFD_NONBLOCK));
  }
  ~HeldSignals() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_.get(); }

  /// The number of one that came, 0: none.
  [[nodiscard]] int take() const {
    signalfd_siginfo info{};
    return read(descriptor_.get(), &info, sizeof info) == sizeof info
               ? static_cast<int>(info.ssi_signo)
               : 0;
  }

 private:
  sigset_t before_{};
  FileDescriptor descriptor_;
};

/// Reads until the other side ends.
/// @returns the signal that ended the waiting, 0: none
int readAnswer(int from, const HeldSignals& signals, std::string& answer) {
  std::array<char, 4096> chunk{};
  while (true) {
    std::array<pollfd, 2> entries{{{from, POLLIN, 0}, {signals.descriptor(), POLLIN, 0}}};
    if (poll(entries.data(), entries.size(), -1) < 0) continue;
    if (entries[1].revents != 0) {
      if (const int number = signals.take(); number != 0) return number;
    }
    if (entries[0].revents == 0) continue;
    const ssize_t count = read(from, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return 0;
    answer.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

std::string endingText(int status, const CallLimits& limits) {
  if (!WIFSIGNALED(status)) return "the reader ended without a result";
  const int number = WTERMSIG(status);
  if (number == SIGXCPU) {
    return fmt::format("found no end after {} s of computing", limits.processor.count());
  }
  if (number == SIGXFSZ) {
    return fmt::format("holds more than {} MB", limits.file_bytes / 1'000'000);
  }
  return fmt::format("the reader was killed by signal {} ({})", number, strsignal(number));
}

}  // namespace

std::string callLimited(const CallLimits& limits, const std::function<std::string()>& work) {
  const HeldSignals signals;
  Pipe pipe = makePipe();
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) failWithErrno("cannot start the reader");
  if (child == 0) runHere(limits, work, pipe.in.get(), parent);
  pipe.in = FileDescriptor();
  std::string answer;
  const int asked_to_end = readAnswer(pipe.out.get(), signals, answer);
  if (asked_to_end != 0) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (asked_to_end != 0) {
    throw std::runtime_error(fmt::format("interrupted ({})", strsignal(asked_to_end)));
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty()) {
    throw std::runtime_error(endingText(status, limits));
  }
  if (answer.front() == kThrown) throw std::runtime_error(answer.substr(1));
  return answer.substr(1);
}

void refuseFurtherFiles() {
  const int lowest_free = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (lowest_free < 0) {
    if (errno == EMFILE) return;
    failWithErrno("cannot limit the reader");
  }
  close(lowest_free);
#ifdef __SANITIZE_ADDRESS__
  constexpr int kSpare = 2;  // the sanitizers' check of types opens a pipe
#else
  constexpr int kSpare = 0;
#endif
  const auto bound = static_cast<rlim_t>(lowest_free + kSpare);
  limit(RLIMIT_NOFILE, bound, bound);
}

}  // namespace lab
