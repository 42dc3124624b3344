#include "common/files/disk_vector.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFirst = std::size_t{64} << 10U;
constexpr std::size_t kMega = std::size_t{1} << 20U;

/// /tmp may be in memory; /var/tmp is on a disk (Filesystem Hierarchy Standard).
fs::path folderOfLargeFiles() {
  const char* set = std::getenv("TMPDIR");
  return set != nullptr && *set != '\0' ? fs::path(set) : fs::path("/var/tmp");
}

[[noreturn]] void refuse(std::size_t bytes, int error) {
  throw std::runtime_error(fmt::format(
      "{}: cannot keep {} MB of data there: {}; make room, or set TMPDIR to a folder with room",
      folderOfLargeFiles().string(), (bytes + kMega - 1) / kMega, std::strerror(error)));
}

std::size_t wholePages(std::size_t bytes) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return (bytes + page - 1) / page * page;
}

/// @param file negative: in memory
void* map(std::size_t bytes, int file) {
  return mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
              file >= 0 ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS, file, 0);
}

/// ThreadSanitizer does not know mremap(): it takes the memory that one thread has given back for
/// that of the next, and reports races.
void* enlarge(void* data, std::size_t capacity, std::size_t bytes, [[maybe_unused]] int file) {
#ifdef __SANITIZE_THREAD__
  void* const grown = map(bytes, file);
  if (grown == MAP_FAILED) return grown;
  if (file < 0) std::memcpy(grown, data, capacity);
  munmap(data, capacity);
  return grown;
#else
  return mremap(data, capacity, bytes, MREMAP_MAYMOVE);
#endif
}

}  // namespace

DiskBytes::DiskBytes(DiskBytes&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      capacity_(std::exchange(other.capacity_, 0)),
      file_(std::move(other.file_)) {}

DiskBytes& DiskBytes::operator=(DiskBytes&& other) noexcept {
  if (this == &other) return *this;
  if (capacity_ > 0) munmap(data_, capacity_);
  data_ = std::exchange(other.data_, nullptr);
  capacity_ = std::exchange(other.capacity_, 0);
  file_ = std::move(other.file_);
  return *this;
}

DiskBytes::~DiskBytes() {
  if (capacity_ > 0) munmap(data_, capacity_);
}

void DiskBytes::grow(std::size_t bytes) {
  if (bytes <= capacity_) return;
  // Each step by a half: appending stays linear, and little room is wasted.
  bytes = wholePages(std::max({bytes, kFirst, capacity_ + capacity_ / 2}));
  if (bytes > kMostInMemory && !inFile()) return moveToFile(bytes);
  if (inFile()) growFile(bytes);
  void* const grown =
      capacity_ == 0 ? map(bytes, -1) : enlarge(data_, capacity_, bytes, file_.get());
  if (grown == MAP_FAILED) throw std::bad_alloc();
  data_ = grown;
  capacity_ = bytes;
}

/// A write into a page for which the disk has no room would end the process, so the room is asked
/// for in advance.
void DiskBytes::growFile(std::size_t bytes) {
  const int error = posix_fallocate(file_.get(), static_cast<off_t>(capacity_),
                                    static_cast<off_t>(bytes - capacity_));
  if (error != 0) refuse(bytes, error);
}

void DiskBytes::moveToFile(std::size_t bytes) {
  std::string name = (folderOfLargeFiles() / "active-lab-XXXXXX").string();
  FileDescriptor file(mkostemp(name.data(), O_CLOEXEC));
  if (file.get() < 0) refuse(bytes, errno);
  unlink(name.c_str());
  const int error = posix_fallocate(file.get(), 0, static_cast<off_t>(bytes));
  if (error != 0) refuse(bytes, error);
  void* const mapped = map(bytes, file.get());
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  if (capacity_ > 0) {
    std::memcpy(mapped, data_, capacity_);
    munmap(data_, capacity_);
  }
  data_ = mapped;
  capacity_ = bytes;
  file_ = std::move(file);
}

void DiskBytes::releaseMemory() const {
  if (inFile()) madvise(data_, capacity_, MADV_DONTNEED);
}

}  // namespace lab
