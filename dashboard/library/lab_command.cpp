#include "dashboard/library/lab_command.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/files/scratch_folder.hpp"
#include "common/process/child_process.hpp"
#include "common/process/file_descriptor.hpp"
#include "common/process/pipe.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
namespace {

constexpr std::size_t kMaxOutput = 16 * 1024;  // bytes
constexpr const char* kOutput = "output.txt";
constexpr int kRunning = std::numeric_limits<int>::min();  // in place of an exit code
constexpr std::chrono::milliseconds kPollPeriod{100};      // for the flag `stop`

/// In a new session, with empty input and its output going to `output`. It may outlive this
/// program.
ChildSettings inSession(const std::vector<std::string>& arguments, int output) {
  return {.arguments = arguments,
          .output = output,
          .errors = output,
          .group = ChildSettings::Group::kSession,
          .death_signal = 0};
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
  Pipe pipe = makePipe();
  ChildProcess child(inSession(arguments, pipe.in.get()));
  pipe.in = FileDescriptor();
  CommandResult result;
  const auto deadline = Clock::now() + timeout;
  std::array<char, 4096> buffer{};
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd entry{pipe.out.get(), POLLIN, 0};
    const bool over = left <= 0ms || stop;
    const int ready =
        over ? 0 : poll(&entry, 1, static_cast<int>(std::min(left, kPollPeriod).count()));
    if ((ready < 0 && errno == EINTR) || (ready == 0 && !over)) continue;
    if (ready == 0) {
      result.was_killed = true;
      child.signalGroup(SIGKILL);
    }
    if (ready <= 0) break;
    const ssize_t count = read(pipe.out.get(), buffer.data(), buffer.size());
    if (count <= 0) break;
    result.output.append(buffer.data(), static_cast<std::size_t>(count));
    if (result.output.size() > 4 * kMaxOutput) {
      result.output = tailOf(std::move(result.output), kMaxOutput);
    }
  }
  pipe.out = FileDescriptor();
  child.wait();
  result.code = child.code();
  result.output = tailOf(std::move(result.output), kMaxOutput);
  return result;
}

fs::path DetachedCommand::makeFolder() {
  fs::path made = makeUniqueFolder(fs::temp_directory_path(), "active-lab");
  if (!made.empty()) return made;
  throw std::runtime_error("cannot create a folder in " + fs::temp_directory_path().string());
}

DetachedCommand::DetachedCommand(fs::path folder, const std::vector<std::string>& arguments)
    : folder_(std::move(folder)), code_(std::make_shared<std::atomic<int>>(kRunning)) {
  const FileDescriptor file(open((folder_ / kOutput).c_str(),
                                 O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (file.get() < 0) throw std::runtime_error("cannot write in " + folder_.string());
  std::unique_ptr<ChildProcess> child;
  try {
    child = std::make_unique<ChildProcess>(inSession(arguments, file.get()));
  } catch (...) {
    fs::remove_all(folder_);
    throw;
  }
  // Without a wait the ended process would remain as a zombie. The thread may outlive this object.
  std::thread([child = std::move(child), code = code_] {
    child->wait();
    *code = child->code();
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
