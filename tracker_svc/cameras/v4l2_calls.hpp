/// The system calls for a video device, as an interface for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace lab::cameras {

/// Results are those of the system calls; errors are negative errno values.
class V4l2Calls {
 public:
  V4l2Calls() = default;
  V4l2Calls(const V4l2Calls&) = delete;
  V4l2Calls& operator=(const V4l2Calls&) = delete;
  virtual ~V4l2Calls() = default;

  /// Opens a device in non-blocking mode. @return a descriptor that is readable when a frame waits
  [[nodiscard]] virtual int open(const std::string& path) = 0;
  virtual void close(int device) = 0;
  [[nodiscard]] virtual int ioctl(int device, unsigned long request, void* argument) = 0;
  /// @return null if it cannot be mapped
  [[nodiscard]] virtual std::uint8_t* map(int device, std::size_t bytes, std::int64_t offset) = 0;
  virtual void unmap(std::uint8_t* memory, std::size_t bytes) = 0;
  /// [us] of CLOCK_MONOTONIC, the clock of frame time stamps.
  [[nodiscard]] virtual std::int64_t monotonic() const = 0;
};

/// The real system calls.
[[nodiscard]] V4l2Calls& systemV4l2Calls();

}  // namespace lab::cameras
