#include "runner/hosts/agent_lock.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <utility>

#include "runner/command_line/exit_code.hpp"
#include "runner/runs/lab_registry.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr int kPollPeriod_ms = 50;
constexpr int kSignalPeriod_ms = 1000;
constexpr int kTermTimeout_ms = 10000;  // the other agent ends its services one after the other

}  // namespace

AgentLock::AgentLock(const std::string& name) : file_(ownRegistry() / ("agent-" + name + ".lock")) {
  open();
  for (int waited = 0; !holds(); waited += kPollPeriod_ms) {
    const pid_t other = holder();
    if (other > 1 && waited % kSignalPeriod_ms == 0) {
      kill(other, waited < kTermTimeout_ms ? SIGTERM : SIGKILL);
    }
    if (waited > 2 * kTermTimeout_ms) {
      close(descriptor_);
      throw UserError("another agent of this run does not end (SIGKILL was sent)");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(kPollPeriod_ms));
    open();
  }
  const std::string own = std::to_string(getpid());
  if (ftruncate(descriptor_, 0) != 0 ||
      pwrite(descriptor_, own.data(), own.size(), 0) != static_cast<ssize_t>(own.size())) {
    close(descriptor_);
    throw UserError("cannot write " + file_.string() + ": is the disk full?");
  }
}

AgentLock::~AgentLock() {
  std::error_code error;
  fs::remove(file_, error);
  close(descriptor_);
}

void AgentLock::open() {
  close(std::exchange(descriptor_,
                      ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600)));
  if (descriptor_ < 0) throw UserError("cannot write " + file_.string());
}

/// True if this process holds the lock and the locked file is still the one at the path: the
/// previous holder deletes the file when it ends, and a lock on a deleted file excludes nobody.
bool AgentLock::holds() const {
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) return false;
  struct stat locked {};
  struct stat current {};
  return fstat(descriptor_, &locked) == 0 && stat(file_.c_str(), &current) == 0 &&
         locked.st_dev == current.st_dev && locked.st_ino == current.st_ino;
}

pid_t AgentLock::holder() const {
  std::array<char, 16> text{};
  if (pread(descriptor_, text.data(), text.size() - 1, 0) <= 0) return 0;
  return std::atoi(text.data());
}

}  // namespace lab::runner
