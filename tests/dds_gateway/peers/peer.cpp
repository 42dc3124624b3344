#include "tests/dds_gateway/peers/peer.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <stdexcept>

#include "tests/support/wait_until.hpp"

namespace lab::dds {

bool eventually(const std::function<bool()>& done) { return waitUntil(done, kPatience); }

Peer::Peer(const std::vector<std::string>& command) {
  std::array<int, 2> in{};
  std::array<int, 2> out{};
  if (pipe2(in.data(), O_CLOEXEC) != 0 || pipe2(out.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int failed = posix_spawn(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(in[0]);
  close(out[1]);
  to_ = in[1];
  from_ = out[0];
  fcntl(from_, F_SETFL, O_NONBLOCK);
  if (failed != 0) throw std::runtime_error(command[0] + ": could not be started");
  if (!says("ready")) throw std::runtime_error(command[0] + ": is not ready");
}

Peer::~Peer() {
  close(to_);
  if (pid_ > 0) {
    if (frozen_) thaw();
    int status = 0;
    if (!eventually([&] { return waitpid(pid_, &status, WNOHANG) == pid_; })) {
      kill(pid_, SIGKILL);
      waitpid(pid_, &status, 0);
    }
  }
  close(from_);
}

void Peer::say(const std::string& line) const {
  const std::string text = line + "\n";
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = write(to_, text.data() + sent, text.size() - sent);
    if (count <= 0) throw std::runtime_error("the peer is gone");
    sent += static_cast<std::size_t>(count);
  }
}

const std::vector<std::string>& Peer::heard() {
  std::array<char, 65536> buffer{};
  for (ssize_t count = 0; (count = read(from_, buffer.data(), buffer.size())) > 0;) {
    rest_.append(buffer.data(), static_cast<std::size_t>(count));
  }
  for (std::size_t end = 0; (end = rest_.find('\n')) != std::string::npos;) {
    lines_.push_back(rest_.substr(0, end));
    rest_.erase(0, end + 1);
  }
  return lines_;
}

bool Peer::says(const std::string& line) {
  return eventually([&] { return std::ranges::find(heard(), line) != lines_.end(); });
}

std::vector<std::string> Peer::got(const std::string& topic) {
  const std::string prefix = "got " + topic + " ";
  std::vector<std::string> payloads;
  for (const std::string& line : heard()) {
    if (line.starts_with(prefix)) payloads.push_back(line.substr(prefix.size()));
  }
  return payloads;
}

void Peer::freeze() {
  kill(pid_, SIGSTOP);
  frozen_ = true;
}

void Peer::thaw() {
  kill(pid_, SIGCONT);
  frozen_ = false;
}

}  // namespace lab::dds
