#include "tracker_svc/cameras/child_process.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "common/camera/cameras.hpp"

namespace lab::cameras {
namespace {

constexpr int kPipeBytes = 1 << 20;  // the limit for unprivileged users

struct Pipe {
  Pipe() {
    std::array<int, 2> ends{-1, -1};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw CameraError(std::string("no pipe: ") + std::strerror(errno));
    }
    out = FileDescriptor(ends[0]);
    in = FileDescriptor(ends[1]);
  }
  FileDescriptor out;
  FileDescriptor in;
};

/// The child between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(char* const* arguments, pid_t parent, int output, int errors, int failed) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent died before prctl()
  setpgid(0, 0);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
  // liblcm's sockets are open across exec. `failed` must stay open until then.
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  execvp(arguments[0], arguments);
  const int error = errno;
  static_cast<void>(!write(failed, &error, sizeof error));
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::string& for_what,
                           const std::string& package)
    : errors_(memfd_create("active-lab-errors", MFD_CLOEXEC)) {
  Pipe output;
  Pipe failed;
  fcntl(output.out.get(), F_SETPIPE_SZ, kPipeBytes);
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    become(arguments.data(), parent, output.in.get(), errors_.get(), failed.in.get());
  }
  if (pid_ < 0) throw CameraError(command[0] + ": cannot start a process: " + std::strerror(errno));
  output.in = FileDescriptor();
  failed.in = FileDescriptor();
  int error = 0;
  if (::read(failed.out.get(), &error, sizeof error) == sizeof error) {
    finish();
    throw CameraError(error == ENOENT ? for_what + " the program " + command[0] +
                                            ", which is not installed: sudo apt install " + package
                                      : for_what + " " + command[0] +
                                            ", which does not start: " + std::strerror(error));
  }
  output_ = std::move(output.out);
}

ChildProcess::~ChildProcess() {
  kill();
  output_ = FileDescriptor();
  finish();
}

std::size_t ChildProcess::read(std::span<std::uint8_t> bytes) {
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ssize_t count = ::read(output_.get(), bytes.data() + got, bytes.size() - got);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    got += static_cast<std::size_t>(count);
  }
  return got;
}

std::string ChildProcess::readAll() {
  std::string all;
  std::vector<std::uint8_t> piece(1 << 16);
  for (std::size_t count = piece.size(); count == piece.size();) {
    count = read(piece);
    all.append(piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return all;
}

int ChildProcess::finish() {
  siginfo_t ended{};
  while (status_ < 0 && waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOWAIT) < 0 &&
         errno == EINTR) {
  }
  const std::lock_guard lock(mutex_);
  int status = 0;
  if (status_ < 0 && waitpid(pid_, &status, 0) == pid_) {
    status_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }
  return status_;
}

void ChildProcess::kill() {
  const std::lock_guard lock(mutex_);
  if (status_ < 0 && pid_ > 0) ::kill(-pid_, SIGKILL);
}

std::string ChildProcess::errors() const {
  constexpr off_t kTail = 4096;
  const off_t length = lseek(errors_.get(), 0, SEEK_END);
  std::string text(static_cast<std::size_t>(std::clamp<off_t>(length, 0, kTail)), 0);
  const off_t from = length - static_cast<off_t>(text.size());
  const ssize_t count = pread(errors_.get(), text.data(), text.size(), std::max<off_t>(from, 0));
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return text;
}

std::string ChildProcess::lastErrorLine() const {
  std::string text = errors();
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t line = text.find_last_of("\r\n");
  return line == std::string::npos ? text : text.substr(line + 1);
}

}  // namespace lab::cameras
