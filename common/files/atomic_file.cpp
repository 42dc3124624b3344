#include "common/files/atomic_file.hpp"

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
#include <utility>

#include "common/files/output_links.hpp"
#include "common/process/file_descriptor.hpp"

namespace lab {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& file, const fs::path& beside, int error) {
  std::error_code ignored;
  fs::remove(beside, ignored);
  if (error == ENOSPC || error == EDQUOT) {
    throw DiskFull(fmt::format("cannot write {}: the disk is full", file.string()));
  }
  throw std::runtime_error(fmt::format("cannot write {}: {}", file.string(), std::strerror(error)));
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
  std::error_code unknown;
  const fs::file_status found = fs::symlink_status(file, unknown);
  if (fs::exists(found) && !fs::is_regular_file(found) && !fs::is_symlink(found)) {
    throw std::runtime_error(fmt::format(
        "cannot write {}: found a folder, a device or a pipe, expected a file or a new name",
        file.string()));
  }
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

void replaceFile(const fs::path& file, std::span<const std::uint8_t> bytes) {
  replaceFile(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
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

AtomicFile::AtomicFile(fs::path path) : AtomicFile(path, path.string() + ".part") {}

AtomicFile::AtomicFile(fs::path path, fs::path part)
    : path_(std::move(path)), part_(std::move(part)) {
  removeLink(part_);
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  fs::remove(part_, ignored);
}

void AtomicFile::finish() { fs::rename(part_, path_); }

}  // namespace lab
