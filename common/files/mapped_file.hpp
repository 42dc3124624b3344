/// Files in the address space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "common/files/truncation_guard.hpp"
#include "common/process/file_descriptor.hpp"

namespace lab {

/// A file mapped for reading. Reading it with copies takes as long as decoding what is in it. If
/// another program makes the file shorter, the missing bytes read as zeros.
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

  /// A part of the file.
  /// @throws std::runtime_error if the file does not have it any more
  [[nodiscard]] std::span<const std::uint8_t> part(std::uint64_t offset, std::size_t size) const;

  /// To be called after reading bytes().
  /// @throws std::runtime_error if the file has become shorter
  void requireWhole() const;

 private:
  [[noreturn]] void failAsShorter(std::uint64_t offset, std::size_t size) const;

  std::string name_;  ///< for messages
  FileDescriptor file_;
  void* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t released_ = 0;
  std::optional<TruncationGuard> guard_;
};

}  // namespace lab
