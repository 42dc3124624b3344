#include "runner/campaign/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <regex>
#include <string>
#include <system_error>

#include "common/process/file_descriptor.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& file, const fs::path& beside, int error) {
  std::error_code ignored;
  fs::remove(beside, ignored);
  const std::string what = fmt::format("cannot write {}: {}", file.string(), std::strerror(error));
  if (error == ENOSPC || error == EDQUOT) throw DiskFull(what);
  throw std::runtime_error(what);
}

void writeAll(int descriptor, std::string_view text, const fs::path& file, const fs::path& beside) {
  while (!text.empty()) {
    const ssize_t written = write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(file, beside, errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// Whether a process of this host can still write. A killed process whose parent has not waited for
/// it cannot, but kill() finds it.
bool canWrite(pid_t process) {
  if (kill(process, 0) != 0 && errno == ESRCH) return false;
  std::string line;
  std::getline(std::ifstream(fmt::format("/proc/{}/stat", process)), line);
  // PID (NAME) STATE …, and the name may contain parentheses (proc_pid_stat(5)).
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos || name_end + 2 >= line.size()) return true;
  return line[name_end + 2] != 'Z' && line[name_end + 2] != 'X';
}

std::string hostName() {
  char host[64] = {};
  gethostname(host, sizeof host - 1);
  return host;
}

}  // namespace

void replaceFile(const fs::path& file, std::string_view text, Sync sync) {
  // Several processes, on several hosts, may write the same result.
  static std::atomic<int> number = 0;
  const fs::path beside =
      file.parent_path() /
      fmt::format(".{}.{}-{}-{}.part", file.filename().string(), hostName(), getpid(), ++number);
  FileDescriptor out(
      open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (out.get() < 0) fail(file, beside, errno);
  writeAll(out.get(), text, file, beside);
  if (sync == Sync::kYes && fsync(out.get()) != 0) fail(file, beside, errno);
  // A network file system reports a full disk here.
  if (close(out.release()) != 0) fail(file, beside, errno);
  if (std::rename(beside.c_str(), file.c_str()) != 0) fail(file, beside, errno);
}

void removeAbandonedFiles(const fs::path& folder) {
  const std::regex form(R"(\..*\.)" + hostName() + R"(-(\d{1,9})-\d+\.part)");
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::smatch found;
    if (!std::regex_match(name, found, form)) continue;
    std::error_code ignored;
    if (!canWrite(std::stoi(found[1].str()))) fs::remove(entry->path(), ignored);
  }
}

bool tellsOfFullDisk(std::string_view text) {
  return text.find(std::strerror(ENOSPC)) != std::string_view::npos ||
         text.find(std::strerror(EDQUOT)) != std::string_view::npos ||
         text.find("disk full") != std::string_view::npos ||
         text.find("disk is full") != std::string_view::npos;
}

}  // namespace lab::runner::campaign
