#include "common/files/file_text.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "common/files/experiment_error.hpp"
#include "common/process/file_descriptor.hpp"

namespace lab {
namespace {

constexpr std::size_t kChunk = 1U << 16U;  // [byte]

std::string cannotRead(int error) { return std::string("cannot be read: ") + std::strerror(error); }

std::string insteadOf(const char* found, const FileKind& kind) {
  return fmt::format("found {}, expected {}: copy the content into a regular file and name that",
                     found, kind.name);
}

/// The reason why a file of this mode is not read, empty if it is.
std::string modeProblem(mode_t mode, const FileKind& kind) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return fmt::format("is a folder, expected a file: {}", kind.name);
  return insteadOf(S_ISFIFO(mode) ? "a pipe" : S_ISSOCK(mode) ? "a socket" : "a device", kind);
}

/// Files that the kernel makes while they are read have no size and may have no end.
bool isKernelFile(int descriptor) {
  constexpr std::array<long, 4> kMagic{PROC_SUPER_MAGIC, SYSFS_MAGIC, DEBUGFS_MAGIC, TRACEFS_MAGIC};
  struct statfs system {};
  return fstatfs(descriptor, &system) == 0 &&
         std::ranges::find(kMagic, static_cast<long>(system.f_type)) != kMagic.end();
}

std::string sizeProblem(std::uintmax_t bytes, const FileKind& kind) {
  if (bytes <= kind.most_bytes) return {};
  return fmt::format("found {} bytes, expected {} of at most {}: is it the right file?", bytes,
                     kind.name, kind.most_bytes);
}

FileContent contentOf(int descriptor, std::size_t size, const FileKind& kind) {
  std::string text;
  text.reserve(size);
  std::array<char, kChunk> chunk{};
  while (true) {
    const ssize_t count = read(descriptor, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return {{}, cannotRead(errno)};
    if (count == 0) return {std::move(text), {}};
    text.append(chunk.data(), static_cast<std::size_t>(count));
    if (std::string problem = sizeProblem(text.size(), kind); !problem.empty()) {
      return {{}, std::move(problem)};  // it grows while it is read
    }
  }
}

struct OpenFile {
  FileDescriptor file;
  std::size_t size = 0;
  std::string problem;
};

OpenFile openRegularFile(const std::filesystem::path& path, const FileKind& kind) {
  const auto refused = [](std::string problem) {
    return OpenFile{FileDescriptor(), 0, std::move(problem)};
  };
  struct stat facts {};
  // Opening a device can already have an effect, so its mode is read before.
  if (stat(path.c_str(), &facts) != 0) return refused(cannotRead(errno));
  std::string problem = modeProblem(facts.st_mode, kind);
  if (!problem.empty()) return refused(std::move(problem));
  FileDescriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.get() < 0) return refused(cannotRead(errno));
  // Another program may have replaced the file in between.
  if (fstat(file.get(), &facts) != 0) return refused(cannotRead(errno));
  problem = modeProblem(facts.st_mode, kind);
  if (problem.empty() && isKernelFile(file.get())) {
    problem = insteadOf("a file of the kernel (/proc, /sys)", kind);
  }
  if (problem.empty()) problem = sizeProblem(static_cast<std::uintmax_t>(facts.st_size), kind);
  if (!problem.empty()) return refused(std::move(problem));
  return {std::move(file), static_cast<std::size_t>(facts.st_size), {}};
}

}  // namespace

std::string regularFileProblem(const std::filesystem::path& file, const FileKind& kind) {
  return openRegularFile(file, kind).problem;
}

FileContent readRegularFile(const std::filesystem::path& file, const FileKind& kind) {
  OpenFile opened = openRegularFile(file, kind);
  if (!opened.problem.empty()) return {{}, std::move(opened.problem)};
  return contentOf(opened.file.get(), opened.size, kind);
}

std::optional<std::string> readWholeFile(const std::filesystem::path& file, const FileKind& kind) {
  return readRegularFile(file, kind).text;
}

std::string readFileText(const std::filesystem::path& file, const FileKind& kind) {
  FileContent content = readRegularFile(file, kind);
  if (!content.text) throw ExperimentError({file.string() + ": " + content.problem});
  return *std::move(content.text);
}

}  // namespace lab
