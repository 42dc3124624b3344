#include "runner/campaign/row_pool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/process/pidfd.hpp"
#include "common/text/printable.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr int kExitFailed = 1;
constexpr int kExitDiskFull = 4;
constexpr FileKind kMessages{"messages", file_kinds::kMega};
constexpr std::int64_t kKilo = 1024;

/// The child's part. Does not return.
[[noreturn]] void runChild(const RowPool::Work& work, std::size_t row, const fs::path& messages,
                           pid_t parent) {
  // A killed pool takes its children along: a run in flight is all that is lost.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kExitFailed);
  // Ctrl-C reaches the whole group; the pool decides.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_DFL);
  const int errors = open(messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (errors >= 0) dup2(errors, STDERR_FILENO);
  int code = 0;
  std::string what;
  try {
    work(row);
  } catch (const DiskFull& error) {
    code = kExitDiskFull;
    what = error.what();
  } catch (const std::exception& error) {
    code = tellsOfFullDisk(error.what()) ? kExitDiskFull : kExitFailed;
    what = error.what();
  }
  std::fflush(nullptr);
  if (!what.empty()) {
    what = "\n" + what;
    static_cast<void>(!write(STDERR_FILENO, what.data(), what.size()));
  }
  _exit(code);
}

}  // namespace

std::string lastLine(const fs::path& messages) {
  std::string text = readWholeFile(messages, kMessages).value_or("");
  while (text.ends_with('\n')) text.pop_back();
  return printable(text.substr(text.find_last_of('\n') + 1));
}

RowPool::~RowPool() { kill(); }

std::vector<RowEnd> RowPool::wait(std::chrono::milliseconds timeout) {
  start();
  std::vector<pollfd> entries;
  for (const Child& child : running_) entries.push_back({child.ended.get(), POLLIN, 0});
  std::vector<RowEnd> ends;
  if (poll(entries.data(), entries.size(), static_cast<int>(timeout.count())) <= 0) return ends;
  std::vector<Child> kept;
  for (std::size_t i = 0; i < running_.size(); ++i) {
    if (entries[i].revents == 0) {
      kept.push_back(std::move(running_[i]));
    } else {
      ends.push_back(reap(running_[i]));
    }
  }
  running_ = std::move(kept);
  start();
  return ends;
}

void RowPool::start() {
  while (!waiting_.empty() && running_.size() < jobs_ && hasRoom()) {
    Child child;
    child.row = waiting_.front();
    child.messages = scratch_ / fmt::format("messages-{}", child.row);
    child.begin = std::chrono::steady_clock::now();
    std::fflush(nullptr);  // or both processes would write what waits
    const pid_t parent = getpid();
    child.pid = fork();
    if (child.pid == 0) runChild(work_, child.row, child.messages, parent);
    if (child.pid < 0) {
      if (!running_.empty()) return;  // too many processes for now
      throw std::system_error(errno, std::generic_category(), "cannot start a run");
    }
    child.ended = FileDescriptor(openPidfd(child.pid));
    waiting_.pop_front();
    running_.push_back(std::move(child));
  }
}

bool RowPool::hasRoom() const {
  if (running_.empty()) return true;
  const std::int64_t available = availableMemory_bytes();
  // Those that run may still grow to the largest size.
  return available == 0 || largest_bytes_ == 0 || available > 2 * largest_bytes_;
}

RowEnd RowPool::reap(const Child& child) {
  int status = 0;
  rusage usage{};
  while (wait4(child.pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  RowEnd end;
  end.row = child.row;
  end.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - child.begin).count();
  end.peak_bytes = usage.ru_maxrss * kKilo;
  largest_bytes_ = std::max(largest_bytes_, end.peak_bytes);
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    end.kind =
        signal == SIGKILL || signal == SIGTERM ? RowEnd::Kind::kKilled : RowEnd::Kind::kFailed;
    end.reason = fmt::format("killed by signal {} ({})", signal, strsignal(signal));
    const std::string last = lastLine(child.messages);
    if (!last.empty()) end.reason += ": " + last;
  } else if (WEXITSTATUS(status) != 0) {
    end.kind =
        WEXITSTATUS(status) == kExitDiskFull ? RowEnd::Kind::kDiskFull : RowEnd::Kind::kFailed;
    end.reason = lastLine(child.messages);
    if (end.reason.empty()) end.reason = fmt::format("exit code {}", WEXITSTATUS(status));
  }
  std::error_code ignored;
  fs::remove(child.messages, ignored);
  return end;
}

void RowPool::kill() {
  for (const Child& child : running_) ::kill(child.pid, SIGKILL);
  for (const Child& child : running_) static_cast<void>(reap(child));
  running_.clear();
}

std::int64_t availableMemory_bytes() {
  std::ifstream file("/proc/meminfo");
  std::string key;
  std::int64_t kilobytes = 0;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("MemAvailable:")) continue;
    return std::sscanf(line.c_str(), "MemAvailable: %ld", &kilobytes) == 1 ? kilobytes * kKilo : 0;
  }
  return 0;
}

}  // namespace lab::runner::campaign
