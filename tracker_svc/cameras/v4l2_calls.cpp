#include "tracker_svc/cameras/v4l2_calls.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

#include "common/camera/camera_place.hpp"

namespace lab::cameras {
namespace {

class SystemCalls final : public V4l2Calls {
 public:
  [[nodiscard]] int open(const std::string& path) override {
    // Opening another device can already have an effect.
    if (const int error = videoDeviceError(path); error != 0) return -error;
    const int device = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return device < 0 ? -errno : device;
  }
  void close(int device) override { ::close(device); }
  [[nodiscard]] int ioctl(int device, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(device, request, argument);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? -errno : result;
  }
  [[nodiscard]] std::uint8_t* map(int device, std::size_t bytes, std::int64_t offset) override {
    void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, device, offset);
    return memory == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(memory);
  }
  void unmap(std::uint8_t* memory, std::size_t bytes) override { munmap(memory, bytes); }
  [[nodiscard]] std::int64_t monotonic() const override {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000;
  }
};

}  // namespace

V4l2Calls& systemV4l2Calls() {
  static SystemCalls calls;
  return calls;
}

}  // namespace lab::cameras
