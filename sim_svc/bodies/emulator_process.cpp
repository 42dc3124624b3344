#include "sim_svc/bodies/emulator_process.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

#include "sim_svc/bodies/chip_link.hpp"

namespace lab::sim {
namespace {

std::string errorText(const std::string& what) { return what + ": " + std::strerror(errno); }

}  // namespace

EmulatorProcess::EmulatorProcess(const std::filesystem::path& program)
    : answer_(chip::kLargestPacket) {
  if (access(program.c_str(), X_OK) != 0) throw std::runtime_error(errorText(program.string()));
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    throw std::runtime_error(errorText("no socket for " + program.string()));
  }
  socket_ = FileDescriptor(ends[0]);
  const FileDescriptor other_end(ends[1]);
  try {
    child_.emplace(ChildSettings{
        .arguments = {program.string(), "--arena-socket", std::to_string(chip::kArenaSocket)},
        .input = ChildSettings::kInherited,
        .output = ChildSettings::kInherited,
        .errors = ChildSettings::kInherited,
        .handed_on = {{other_end.get(), chip::kArenaSocket}}});
  } catch (const std::system_error& error) {
    throw std::runtime_error("no process for " + program.string() + ": " + error.code().message());
  }
}

std::span<const std::uint8_t> EmulatorProcess::exchange(std::span<const std::uint8_t> packet,
                                                        int timeout_ms) {
  // Errors are ignored, because an emulator that has ended may have left a reason to be read below.
  static_cast<void>(send(socket_.get(), packet.data(), packet.size(), MSG_NOSIGNAL));
  using Clock = std::chrono::steady_clock;
  const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds(timeout_ms);
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd ready{socket_.get(), POLLIN, 0};
    const int count = left > 0 ? poll(&ready, 1, static_cast<int>(left)) : 0;
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      throw std::runtime_error("no answer within " + std::to_string(timeout_ms / 1000) + " s");
    }
    ssize_t size = recv(socket_.get(), answer_.data(), answer_.size(), 0);
    if (size < 0) size = recv(socket_.get(), answer_.data(), answer_.size(), MSG_DONTWAIT);
    if (size > 0) return std::span(answer_).first(static_cast<std::size_t>(size));
    throw std::runtime_error(howItEnded());
  }
}

std::string EmulatorProcess::howItEnded() {
  // A process closes its socket shortly before it can be waited for.
  if (!child_->waitFor(std::chrono::milliseconds(100))) return "closed its socket";
  const int signal = child_->endingSignal();
  return signal != 0 ? "ended by signal " + std::to_string(signal)
                     : "ended with code " + std::to_string(child_->code());
}

}  // namespace lab::sim
