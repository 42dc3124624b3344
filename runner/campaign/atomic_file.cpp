#include "runner/campaign/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
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

}  // namespace

void replaceFile(const fs::path& file, std::string_view text, Sync sync) {
  // Several processes, on several hosts, may write the same result.
  static std::atomic<int> number = 0;
  char host[64] = {};
  gethostname(host, sizeof host - 1);
  const fs::path beside =
      file.parent_path() /
      fmt::format(".{}.{}-{}-{}.part", file.filename().string(), host, getpid(), ++number);
  FileDescriptor out(open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (out.get() < 0) fail(file, beside, errno);
  writeAll(out.get(), text, file, beside);
  if (sync == Sync::kYes && fsync(out.get()) != 0) fail(file, beside, errno);
  // A network file system reports a full disk here.
  if (close(out.release()) != 0) fail(file, beside, errno);
  if (std::rename(beside.c_str(), file.c_str()) != 0) fail(file, beside, errno);
}

bool tellsOfFullDisk(std::string_view text) {
  return text.find(std::strerror(ENOSPC)) != std::string_view::npos ||
         text.find(std::strerror(EDQUOT)) != std::string_view::npos ||
         text.find("disk full") != std::string_view::npos ||
         text.find("disk is full") != std::string_view::npos;
}

}  // namespace lab::runner::campaign
