#include "common/process/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "common/process/file_descriptor.hpp"
#include "common/process/pidfd.hpp"
#include "common/process/pipe.hpp"

namespace lab {
namespace {

using std::chrono::milliseconds;

/// Descriptors are moved above this number before they get their numbers in the child, so that none
/// is overwritten before it is used.
constexpr int kAbove = 16;

/// What the child needs between fork and exec, where it must not allocate.
struct Launch {
  char* const* arguments;
  char* const* environment;
  const char* folder;  ///< empty: that of this process
  std::array<int, 3> streams;
  std::pair<int, int>* handed_on;
  std::size_t num_handed_on;
  const int* ignored;
  std::size_t num_ignored;
  ChildSettings::Group group;
  int death_signal;
  pid_t parent;
  int failed;  ///< gets errno
};

[[noreturn]] void giveUp(int failed) {
  const int error = errno;
  static_cast<void>(!write(failed, &error, sizeof error));
  _exit(127);
}

void resetSignals(const Launch& launch) {
  if (launch.group != ChildSettings::Group::kShared) {
    for (int number = 1; number < NSIG; ++number) std::signal(number, SIG_DFL);
  }
  for (std::size_t i = 0; i < launch.num_ignored; ++i) std::signal(launch.ignored[i], SIG_IGN);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Gives the descriptors their numbers and lets exec close all others.
/// @param failed moved out of the way
bool arrangeDescriptors(Launch& launch) {
  const auto away = [](int& number) {
    if (number < 0) return true;
    const int moved = fcntl(number, F_DUPFD_CLOEXEC, kAbove);
    if (moved >= 0) number = moved;
    return moved >= 0;
  };
  if (!away(launch.failed) || !std::ranges::all_of(launch.streams, away)) return false;
  for (std::size_t i = 0; i < launch.num_handed_on; ++i) {
    if (!away(launch.handed_on[i].first)) return false;
  }
  closeFrom(3, Close::kAtExec);
  for (int stream = 0; stream < 3; ++stream) {
    int from = launch.streams[static_cast<std::size_t>(stream)];
    if (from == ChildSettings::kInherited) continue;
    if (from == ChildSettings::kNothing) from = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (from < 0) return false;
    // open() may have returned the number itself, if this process has closed that stream.
    if (from == stream ? fcntl(from, F_SETFD, 0) < 0 : dup2(from, stream) < 0) return false;
  }
  for (std::size_t i = 0; i < launch.num_handed_on; ++i) {
    if (dup2(launch.handed_on[i].first, launch.handed_on[i].second) < 0) return false;
  }
  return true;
}

/// The child between fork and exec: system calls only.
[[noreturn]] void become(Launch launch) {
  if (launch.death_signal != 0) {
    prctl(PR_SET_PDEATHSIG, launch.death_signal);
    if (getppid() != launch.parent) _exit(127);  // it died before the line above
  }
  if (launch.group == ChildSettings::Group::kSeparate) setpgid(0, 0);
  if (launch.group == ChildSettings::Group::kSession) setsid();
  resetSignals(launch);
  if (!arrangeDescriptors(launch)) giveUp(launch.failed);
  if (*launch.folder != '\0' && chdir(launch.folder) != 0) giveUp(launch.failed);
  execvpe(launch.arguments[0], launch.arguments, launch.environment);
  giveUp(launch.failed);
}

/// exec takes char* and does not write through it.
std::vector<char*> pointersTo(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

int waitStatus(pid_t pid, int options, int& status) {
  int result = 0;
  do {
    result = waitpid(pid, &status, options);
  } while (result < 0 && errno == EINTR);
  return result;
}

}  // namespace

ChildProcess::ChildProcess(const ChildSettings& settings)
    : may_outlive_(settings.death_signal == 0) {
  const std::string what = "cannot start " + settings.arguments.front();
  const std::vector<char*> arguments = pointersTo(settings.arguments);
  std::vector<char*> environment;
  if (settings.environment) environment = pointersTo(*settings.environment);
  std::vector<std::pair<int, int>> handed_on = settings.handed_on;
  Pipe failed = makePipe();
  const Launch launch{.arguments = arguments.data(),
                      .environment = settings.environment ? environment.data() : environ,
                      .folder = settings.folder.c_str(),
                      .streams = {settings.input, settings.output, settings.errors},
                      .handed_on = handed_on.data(),
                      .num_handed_on = handed_on.size(),
                      .ignored = settings.ignored_signals.data(),
                      .num_ignored = settings.ignored_signals.size(),
                      .group = settings.group,
                      .death_signal = settings.death_signal,
                      .parent = getpid(),
                      .failed = failed.in.get()};
  pid_ = fork();
  if (pid_ == 0) become(launch);
  int error = pid_ < 0 ? errno : 0;
  failed.in = FileDescriptor();
  if (pid_ > 0) {
    // The pipe ends without a word when exec closes it.
    while (read(failed.out.get(), &error, sizeof error) < 0 && errno == EINTR) {
    }
    ended_ = FileDescriptor(openPidfd(pid_));
    if (error == 0 && ended_.get() < 0) {
      error = errno;
      kill(pid_, SIGKILL);
    }
    int status = 0;
    if (error != 0) waitStatus(pid_, 0, status);
  }
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

ChildProcess::~ChildProcess() {
  if (may_outlive_ || !running()) return;
  signal(SIGKILL);
  wait();
}

bool ChildProcess::running() {
  const std::lock_guard lock(mutex_);
  if (reaped_) return false;
  int status = 0;
  const int result = waitStatus(pid_, WNOHANG, status);
  if (result == 0) return true;
  reaped_ = true;
  if (result == pid_) status_ = status;
  return false;
}

bool ChildProcess::waitFor(milliseconds timeout) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point deadline = Clock::now() + timeout;
  while (running()) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now());
    if (left <= milliseconds(0)) return false;
    pollfd entry{ended_.get(), POLLIN, 0};
    poll(&entry, 1, static_cast<int>(std::min(left, milliseconds(60'000)).count()));
  }
  return true;
}

void ChildProcess::wait() {
  while (!waitFor(milliseconds(60'000))) {
  }
}

void ChildProcess::send(pid_t receiver, int number) {
  const std::lock_guard lock(mutex_);
  if (!reaped_) kill(receiver, number);
}

void ChildProcess::signal(int number) { send(pid_, number); }

void ChildProcess::signalGroup(int number) { send(-pid_, number); }

int ChildProcess::endingSignal() const {
  const std::lock_guard lock(mutex_);
  return status_ && WIFSIGNALED(*status_) ? WTERMSIG(*status_) : 0;
}

int ChildProcess::code() const {
  const std::lock_guard lock(mutex_);
  if (!status_) return -1;
  return WIFSIGNALED(*status_) ? 128 + WTERMSIG(*status_) : WEXITSTATUS(*status_);
}

std::string ChildProcess::ending() const {
  const std::lock_guard lock(mutex_);
  if (!reaped_) return {};
  if (!status_) return "lost";
  if (WIFSIGNALED(*status_)) return "killed by signal " + std::to_string(WTERMSIG(*status_));
  return "exit code " + std::to_string(WEXITSTATUS(*status_));
}

}  // namespace lab
