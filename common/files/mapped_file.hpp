/// Files in the address space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace lab {

/// A file mapped for reading. Reading it with copies takes as long as decoding what is in it.
class MappedFile {
 public:
  /// @param what the file is, for messages: "log"
  /// @throws std::runtime_error if it is no regular file, or cannot be read
  MappedFile(const std::filesystem::path& path, const std::string& what);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::span<const std::uint8_t> bytes() const {
    return {static_cast<const std::uint8_t*>(data_), size_};
  }

  /// Gives back the memory of what lies before `at`, which has been read: a file may be larger than
  /// the memory that its reader may take.
  void release(const std::uint8_t* at);

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t released_ = 0;
};

}  // namespace lab
