#include "common/files/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <stdexcept>

namespace lab {

MappedFile::MappedFile(const std::filesystem::path& path, const std::string& what) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) throw std::runtime_error("cannot open the " + what + " " + path.string());
  struct stat status {};
  const bool known = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  size_ = known ? static_cast<std::size_t>(status.st_size) : 0;
  if (size_ > 0) data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
  ::close(file);
  if (!known || data_ == MAP_FAILED) {
    throw std::runtime_error("cannot read the " + what + " " + path.string());
  }
  if (size_ > 0) ::madvise(data_, size_, MADV_SEQUENTIAL);
}

MappedFile::~MappedFile() {
  if (size_ > 0) ::munmap(data_, size_);
}

void MappedFile::release(const std::uint8_t* at) {
  constexpr std::size_t kStep = 1U << 26U;
  const auto read = static_cast<std::size_t>(at - static_cast<const std::uint8_t*>(data_));
  if (read < released_ + kStep) return;
  const std::size_t end = read / kStep * kStep;
  ::madvise(static_cast<std::uint8_t*>(data_) + released_, end - released_, MADV_DONTNEED);
  released_ = end;
}

}  // namespace lab
