#include "sim_svc/bodies/emulator_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "sim_svc/bodies/chip_link.hpp"

namespace lab::sim {
namespace {

std::string errorText(const std::string& what) { return what + ": " + std::strerror(errno); }

/// Runs in the child. Only uses calls that are allowed between fork and exec.
[[noreturn]] void becomeEmulator(const char* program, int socket, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent has already ended
  // Ctrl-C in the terminal must only reach the lab, which then ends its emulator.
  setpgid(0, 0);
  if (socket == chip::kArenaSocket) {
    fcntl(socket, F_SETFD, 0);
  } else {
    dup2(socket, chip::kArenaSocket);
  }
  // Close all other descriptors, such as the bus and the serial lines.
  close_range(chip::kArenaSocket + 1, ~0U, 0);
  static_assert(chip::kArenaSocket == 3);
  execl(program, program, "--arena-socket", "3", static_cast<char*>(nullptr));
  _exit(127);
}

}  // namespace

EmulatorProcess::EmulatorProcess(const std::filesystem::path& program)
    : answer_(chip::kLargestPacket) {
  if (access(program.c_str(), X_OK) != 0) throw std::runtime_error(errorText(program.string()));
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    throw std::runtime_error(errorText("no socket for " + program.string()));
  }
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) becomeEmulator(program.c_str(), ends[1], parent);
  close(ends[1]);
  socket_ = ends[0];
  if (pid_ < 0) {
    const std::string text = errorText("no process for " + program.string());
    close(socket_);
    throw std::runtime_error(text);
  }
}

EmulatorProcess::~EmulatorProcess() {
  close(socket_);
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
}

std::span<const std::uint8_t> EmulatorProcess::exchange(std::span<const std::uint8_t> packet,
                                                        int timeout_ms) {
  // Errors are ignored, because an emulator that has ended may have left a reason to be read below.
  static_cast<void>(send(socket_, packet.data(), packet.size(), MSG_NOSIGNAL));
  using Clock = std::chrono::steady_clock;
  const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds(timeout_ms);
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd ready{socket_, POLLIN, 0};
    const int count = left > 0 ? poll(&ready, 1, static_cast<int>(left)) : 0;
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      throw std::runtime_error("no answer within " + std::to_string(timeout_ms / 1000) + " s");
    }
    ssize_t size = recv(socket_, answer_.data(), answer_.size(), 0);
    if (size < 0) size = recv(socket_, answer_.data(), answer_.size(), MSG_DONTWAIT);
    if (size > 0) return std::span(answer_).first(static_cast<std::size_t>(size));
    throw std::runtime_error(howItEnded());
  }
}

std::string EmulatorProcess::howItEnded() {
  int status = 0;
  // A process closes its socket shortly before it can be waited for.
  for (int attempt = 0; attempt < 100; ++attempt) {
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      if (WIFSIGNALED(status)) return "ended by signal " + std::to_string(WTERMSIG(status));
      return "ended with code " + std::to_string(WEXITSTATUS(status));
    }
    usleep(1000);
  }
  return "closed its socket";
}

}  // namespace lab::sim
