#include "runner/live/child_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace lab::runner {
namespace {

/// Runs in the child between fork and exec, so only system calls are allowed.
[[noreturn]] void becomeProgram(char* const* arguments, int output, ChildProcess::Streams streams,
                                pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);  // the runner died before the line above
  signal(SIGPIPE, SIG_DFL);           // the runner ignores it
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  dup2(streams.input >= 0 ? streams.input : open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(streams.output >= 0 ? streams.output : output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execv(arguments[0], arguments);
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(std::string name, const std::vector<std::string>& arguments,
                           const std::filesystem::path& output, Streams streams)
    : name_(std::move(name)) {
  std::vector<char*> raw;
  // exec takes char* and does not write through it.
  for (const std::string& argument : arguments) raw.push_back(const_cast<char*>(argument.c_str()));
  raw.push_back(nullptr);
  const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) {
    throw std::system_error(errno, std::generic_category(), "cannot write " + output.string());
  }
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) becomeProgram(raw.data(), file, streams, parent);
  close(file);
  if (pid_ < 0) {
    throw std::system_error(errno, std::generic_category(), "cannot start " + arguments.front());
  }
  running_ = true;
}

ChildProcess::~ChildProcess() {
  if (!running()) return;
  terminate();
  waitOrKill(2000);
}

bool ChildProcess::running() {
  if (!running_) return false;
  int status = 0;
  const pid_t result = waitpid(pid_, &status, WNOHANG);
  if (result == 0) return true;
  running_ = false;
  if (result < 0) {
    ending_ = "lost";
  } else if (WIFSIGNALED(status)) {
    ending_ = "killed by signal " + std::to_string(WTERMSIG(status));
  } else {
    ending_ = "exit code " + std::to_string(WEXITSTATUS(status));
  }
  return false;
}

void ChildProcess::terminate() {
  if (running()) kill(pid_, SIGTERM);
}

bool ChildProcess::waitOrKill(int patience_ms) {
  constexpr int kPoll_ms = 5;
  bool killed = false;
  for (int waited = 0; running(); waited += kPoll_ms) {
    if (waited >= patience_ms && !killed) killed = kill(pid_, SIGKILL) == 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(kPoll_ms));
  }
  return killed;
}

}  // namespace lab::runner
