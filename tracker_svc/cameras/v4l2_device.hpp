/// A streaming Linux video device (Video4Linux 2).
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/camera/cameras.hpp"
#include "tracker_svc/cameras/raw_pixels.hpp"
#include "tracker_svc/cameras/v4l2_calls.hpp"

namespace lab::cameras {

/// Open, configured and streaming from construction to destruction.
class V4l2Device {
 public:
  /// Selects the least processed format that offers the wanted size and rate, switches off all
  /// automatic adjustments, sets exposure, gain and rate, and reads them back.
  /// @param calls must outlive it
  /// @throws CameraError, one line, if it does not exist, permission is missing, it is no camera,
  ///   it is in use, or it lacks the size
  V4l2Device(V4l2Calls& calls, std::string path, const CameraFormat& wanted);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  /// A captured frame in driver memory. It must be returned.
  struct Raw {
    std::uint32_t buffer = 0;
    std::uint32_t sequence = 0;
    std::span<const std::uint8_t> bytes;  ///< empty if the frame is damaged
    std::int64_t age = 0;  ///< [us] since the middle of the exposure, as far as known
    bool stamped = false;  ///< whether the age comes from the device's time stamp
  };

  enum class State { kFrame, kNothing, kGone };

  /// Removes the oldest waiting frame from the driver's queue, without blocking.
  [[nodiscard]] State dequeue(Raw& frame);
  void giveBack(const Raw& frame);

  [[nodiscard]] int descriptor() const { return device_; }
  [[nodiscard]] const RawLayout& layout() const { return layout_; }
  [[nodiscard]] const CameraFormat& format() const { return format_; }

 private:
  struct Buffer {
    std::uint8_t* memory = nullptr;
    std::size_t bytes = 0;
  };

  int call(unsigned long request, void* argument) const {
    return calls_.ioctl(device_, request, argument);
  }
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void failToSet(int error, const std::string& what) const;
  void checkIsCamera() const;
  void chooseFormat(const CameraFormat& wanted);
  void setFormat(std::uint32_t fourcc, int width, int height);
  void setRate(double fps);
  void lock(const CameraFormat& wanted);
  void startStreaming();
  void stop();

  [[nodiscard]] std::vector<std::uint32_t> offeredFormats() const;
  [[nodiscard]] bool hasSize(std::uint32_t fourcc, int width, int height) const;
  [[nodiscard]] double fastestRate(std::uint32_t fourcc, int width, int height) const;
  [[nodiscard]] std::string offers() const;

  V4l2Calls& calls_;
  std::string path_;
  int device_ = -1;
  RawLayout layout_;
  CameraFormat format_;
  std::vector<Buffer> buffers_;
  int errors_in_a_row_ = 0;
};

}  // namespace lab::cameras
