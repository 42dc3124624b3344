#include "dashboard/library/lab_command.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace lab::dashboard {
namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
namespace {

constexpr std::size_t kMaxOutput = 16 * 1024;  // bytes
constexpr const char* kOutput = "output.txt";
constexpr int kRunning = std::numeric_limits<int>::min();  // in place of an exit code
constexpr std::chrono::milliseconds kPollPeriod{100};      // for the flag `stop`

int codeOf(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/// Starts a program in a new session, with empty input and its output going to `output`. It
/// inherits no other descriptors: an inherited listening socket would keep the server's port
/// occupied.
pid_t startSession(const std::vector<std::string>& arguments, int output) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  sigset_t all;
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<char*> raw;
  // exec takes char* and does not write through it.
  for (const std::string& argument : arguments) raw.push_back(const_cast<char*>(argument.c_str()));
  raw.push_back(nullptr);
  pid_t pid = -1;
  const int error =
      posix_spawn(&pid, arguments.front().c_str(), &actions, &attributes, raw.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error("cannot start " + arguments.front() + ": " +
                             std::generic_category().message(error));
  }
  return pid;
}

}  // namespace

std::string tailOf(std::string text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  text.erase(0, text.size() - bytes);
  const std::size_t line = text.find('\n');
  if (line + 1 < text.size() && line != std::string::npos) return text.substr(line + 1);
  const auto within = [](char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; };
  text.erase(text.begin(), std::ranges::find_if_not(text, within));
  return text;
}

CommandResult runCommand(const std::vector<std::string>& arguments,
                         std::chrono::milliseconds timeout, const std::atomic<bool>& stop) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("cannot create a pipe");
  pid_t pid = -1;
  try {
    pid = startSession(arguments, ends[1]);
  } catch (...) {
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  close(ends[1]);
  CommandResult result;
  const auto deadline = Clock::now() + timeout;
  std::array<char, 4096> buffer{};
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd entry{ends[0], POLLIN, 0};
    const bool over = left <= 0ms || stop;
    const int ready =
        over ? 0 : poll(&entry, 1, static_cast<int>(std::min(left, kPollPeriod).count()));
    if ((ready < 0 && errno == EINTR) || (ready == 0 && !over)) continue;
    if (ready == 0) {
      result.was_killed = true;
      kill(-pid, SIGKILL);  // the whole process group
    }
    if (ready <= 0) break;
    const ssize_t count = read(ends[0], buffer.data(), buffer.size());
    if (count <= 0) break;
    result.output.append(buffer.data(), static_cast<std::size_t>(count));
    if (result.output.size() > 4 * kMaxOutput) {
      result.output = tailOf(std::move(result.output), kMaxOutput);
    }
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  result.code = codeOf(status);
  result.output = tailOf(std::move(result.output), kMaxOutput);
  return result;
}

fs::path DetachedCommand::makeFolder() {
  std::string name = (fs::temp_directory_path() / "active-lab-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("cannot create a folder in " + fs::temp_directory_path().string());
  }
  return name;
}

DetachedCommand::DetachedCommand(fs::path folder, const std::vector<std::string>& arguments)
    : folder_(std::move(folder)), code_(std::make_shared<std::atomic<int>>(kRunning)) {
  const int file = open((folder_ / kOutput).c_str(),
                        O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) throw std::runtime_error("cannot write in " + folder_.string());
  pid_t pid = -1;
  try {
    pid = startSession(arguments, file);
  } catch (...) {
    close(file);
    fs::remove_all(folder_);
    throw;
  }
  close(file);
  // Without waitpid() the ended process would remain as a zombie. The thread may outlive this
  // object.
  std::thread([pid, code = code_] {
    int status = 0;
    pid_t found = -1;
    do {
      found = waitpid(pid, &status, 0);
    } while (found < 0 && errno == EINTR);
    *code = found == pid ? codeOf(status) : -1;
  }).detach();
}

DetachedCommand::~DetachedCommand() {
  std::error_code ignored;
  if (code()) fs::remove_all(folder_, ignored);
}

std::optional<int> DetachedCommand::code() const {
  const int code = *code_;
  return code == kRunning ? std::nullopt : std::optional(code);
}

std::string DetachedCommand::output() const {
  std::ifstream file(folder_ / kOutput, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::size_t>(std::max<std::streamoff>(0, file.tellg()));
  const std::size_t wanted = std::min(size, 2 * kMaxOutput);
  file.seekg(static_cast<std::streamoff>(size - wanted));
  std::string text(wanted, '\0');
  file.read(text.data(), static_cast<std::streamsize>(wanted));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  return tailOf(std::move(text), kMaxOutput);
}

}  // namespace lab::dashboard
