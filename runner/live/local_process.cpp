#include "runner/live/local_process.hpp"

#include <fcntl.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>

#include "common/process/file_descriptor.hpp"

namespace lab::runner {
namespace {

/// Whether exec failed, which happens again at every start; other errors may pass.
bool cannotExecute(const std::error_code& code) {
  return code == std::errc::no_such_file_or_directory || code == std::errc::permission_denied ||
         code == std::errc::executable_format_error;
}

}  // namespace

LocalProcess::LocalProcess(const std::vector<std::string>& arguments,
                           const std::filesystem::path& output, Death death) {
  const FileDescriptor file(open(output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  if (file.get() < 0) {
    throw std::system_error(errno, std::generic_category(), "cannot write " + output.string());
  }
  try {
    child_.emplace(ChildSettings{.arguments = arguments,
                                 .output = file.get(),
                                 .errors = file.get(),
                                 .death_signal = death == Death::kTerm ? SIGTERM : SIGKILL});
  } catch (const std::system_error& error) {
    if (!cannotExecute(error.code())) throw;
    ending_ = "exit code 127";  // the shell's code for this
  }
}

LocalProcess::~LocalProcess() {
  if (!running()) return;
  terminate();
  waitOrKill(2000);
}

bool LocalProcess::running() {
  if (!child_ || !ending_.empty()) return false;
  if (child_->running()) return true;
  ending_ = child_->ending();
  return false;
}

void LocalProcess::terminate() {
  if (child_) child_->signal(SIGTERM);
}

void LocalProcess::kill() {
  if (child_) child_->signal(SIGKILL);
}

bool LocalProcess::waitOrKill(int timeout_ms) {
  if (!child_) return false;
  const bool killed = !child_->waitFor(std::chrono::milliseconds(timeout_ms));
  if (killed) {
    child_->signal(SIGKILL);
    child_->wait();
  }
  static_cast<void>(running());
  return killed;
}

}  // namespace lab::runner
