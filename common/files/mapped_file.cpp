#include "common/files/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace lab {

namespace {

/// The size of a regular file [bytes]; nothing: it is none, or unknown.
std::optional<std::size_t> sizeOf(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return static_cast<std::size_t>(status.st_size);
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path, const std::string& what)
    : name_(what + " " + path.string()),
      file_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (file_.get() < 0) throw std::runtime_error("cannot open the " + name_);
  const auto size = sizeOf(file_.get());
  if (size == 0U) return;
  void* const data =
      size ? ::mmap(nullptr, *size, PROT_READ, MAP_PRIVATE, file_.get(), 0) : MAP_FAILED;
  if (data == MAP_FAILED) throw std::runtime_error("cannot read the " + name_);
  data_ = data;
  size_ = *size;
  guard_.emplace(data_, size_);
  ::madvise(data_, size_, MADV_SEQUENTIAL);
}

MappedFile::~MappedFile() {
  guard_.reset();
  if (size_ > 0) ::munmap(data_, size_);
}

std::span<const std::uint8_t> MappedFile::part(std::uint64_t offset, std::size_t size) const {
  const bool mapped = offset <= size_ && size <= size_ - offset;
  if (!mapped || sizeOf(file_.get()).value_or(0) < offset + size) failAsShorter(offset, size);
  return bytes().subspan(static_cast<std::size_t>(offset), size);
}

void MappedFile::requireWhole() const {
  const bool shorter = sizeOf(file_.get()).value_or(0) < size_;
  if (shorter || (guard_ && guard_->foundTruncation())) failAsShorter(0, size_);
}

void MappedFile::failAsShorter(std::uint64_t offset, std::size_t size) const {
  const std::uint64_t now = sizeOf(file_.get()).value_or(0);
  throw std::runtime_error("cannot go on reading the " + name_ + ": found " +
                           std::to_string(now - std::min(now, offset)) + " bytes at byte " +
                           std::to_string(offset) + ", expected " + std::to_string(size) +
                           "; was it made shorter?");
}

void MappedFile::release(const std::uint8_t* at) {
  constexpr std::size_t kStep = 1U << 26U;
  const auto read = static_cast<std::size_t>(at - static_cast<const std::uint8_t*>(data_));
  if (read < released_) released_ = read / kStep * kStep;  // the reader went back
  if (read < released_ + kStep) return;
  const std::size_t end = read / kStep * kStep;
  ::madvise(static_cast<std::uint8_t*>(data_) + released_, end - released_, MADV_DONTNEED);
  released_ = end;
}

}  // namespace lab
