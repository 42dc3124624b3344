/// A fake video device, controlled by a test, behind the system-call interface.
#pragma once

#include <linux/videodev2.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "tracker_svc/cameras/v4l2_calls.hpp"

namespace lab {

class ScriptedCamera final : public cameras::V4l2Calls {
 public:
  struct Size {
    std::uint32_t width;
    std::uint32_t height;
    std::vector<std::uint32_t> rates;  ///< [1/s]
  };
  struct Format {
    std::uint32_t fourcc;
    std::uint32_t bytes;  ///< per pixel
    std::vector<Size> sizes;
  };
  struct Control {
    int minimum;
    int maximum;
    int value;
    bool stuck = false;  ///< ignores new values
  };

  // Properties, which the test may change.
  std::string path = "/dev/video0";
  int open_error = 0;
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<Format> formats;
  std::map<std::uint32_t, Control> controls;
  int format_error = 0;
  int stream_error = 0;
  bool keeps_its_size = false;  ///< S_FMT returns another size than requested
  std::uint32_t quantization = V4L2_QUANTIZATION_FULL_RANGE;
  std::int64_t clock = 5'000'000;  ///< [us] CLOCK_MONOTONIC

  // Recorded calls.
  int opened = 0;
  int closed = 0;
  int mapped = 0;
  bool streaming = false;
  v4l2_pix_format now{};
  std::uint32_t fps = 30;

  ScriptedCamera() { now.width = 640, now.height = 480, now.pixelformat = V4L2_PIX_FMT_YUYV; }

  /// Exposes a frame of bytes `value`. It is lost if no buffer is queued, as in a driver.
  void expose(std::uint32_t sequence, std::uint8_t value,
              std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC |
                                    V4L2_BUF_FLAG_TSTAMP_SRC_SOE,
              std::int64_t stamp = -1, std::uint32_t missing_bytes = 0) {
    if (queued_.empty()) return;
    v4l2_buffer buffer{};
    buffer.index = queued_.front();
    queued_.pop_front();
    std::memset(memory_[buffer.index].data(), value, memory_[buffer.index].size());
    buffer.sequence = sequence;
    buffer.flags = flags;
    buffer.bytesused = now.sizeimage - missing_bytes;
    const std::int64_t time = stamp < 0 ? clock : stamp;
    buffer.timestamp.tv_sec = time / 1'000'000;
    buffer.timestamp.tv_usec = time % 1'000'000;
    done_.push_back(buffer);
    tell();
  }
  void unplug() {
    plugged_ = false;
    tell();
  }
  void plugIn() { plugged_ = true; }
  /// The next frames fail with an I/O error.
  void failFrames(int count) {
    failing_ = count;
    tell();
  }

  [[nodiscard]] int open(const std::string& the_path) override {
    if (open_error != 0) return -open_error;
    if (the_path != path || !plugged_) return -ENOENT;
    ++opened;
    descriptor_ = eventfd(0, EFD_NONBLOCK);
    return descriptor_;
  }
  void close(int device) override {
    ++closed;
    ::close(device);
    descriptor_ = -1;
    queued_.clear();
    done_.clear();
  }
  [[nodiscard]] std::uint8_t* map(int, std::size_t, std::int64_t offset) override {
    ++mapped;
    return memory_.at(static_cast<std::size_t>(offset)).data();
  }
  void unmap(std::uint8_t*, std::size_t) override { --mapped; }
  [[nodiscard]] std::int64_t monotonic() const override { return clock; }

  [[nodiscard]] int ioctl(int, unsigned long request, void* argument) override {
    if (!plugged_) return -ENODEV;
    switch (request) {
      case VIDIOC_QUERYCAP:
        return queryCapabilities(*static_cast<v4l2_capability*>(argument));
      case VIDIOC_ENUM_FMT:
        return enumFormats(*static_cast<v4l2_fmtdesc*>(argument));
      case VIDIOC_ENUM_FRAMESIZES:
        return enumSizes(*static_cast<v4l2_frmsizeenum*>(argument));
      case VIDIOC_ENUM_FRAMEINTERVALS:
        return enumRates(*static_cast<v4l2_frmivalenum*>(argument));
      case VIDIOC_G_FMT:
        static_cast<v4l2_format*>(argument)->fmt.pix = now;
        return 0;
      case VIDIOC_S_FMT:
        return setFormat(static_cast<v4l2_format*>(argument)->fmt.pix);
      case VIDIOC_G_PARM:
        return getRate(*static_cast<v4l2_streamparm*>(argument));
      case VIDIOC_S_PARM:
        return setRate(*static_cast<v4l2_streamparm*>(argument));
      case VIDIOC_QUERYCTRL:
        return queryControl(*static_cast<v4l2_queryctrl*>(argument));
      case VIDIOC_G_CTRL:
      case VIDIOC_S_CTRL:
        return useControl(request, *static_cast<v4l2_control*>(argument));
      case VIDIOC_REQBUFS:
        return makeBuffers(*static_cast<v4l2_requestbuffers*>(argument));
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(argument);
        buffer.length = static_cast<std::uint32_t>(memory_.at(buffer.index).size());
        buffer.m.offset = buffer.index;
        return 0;
      }
      case VIDIOC_QBUF:
        queued_.push_back(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_DQBUF:
        return takeFrame(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
        if (stream_error != 0) return -stream_error;
        streaming = true;
        return 0;
      case VIDIOC_STREAMOFF:
        streaming = false;
        return 0;
      default:
        return -ENOTTY;
    }
  }

 private:
  void tell() {
    const std::uint64_t one = 1;
    if (descriptor_ >= 0) static_cast<void>(!write(descriptor_, &one, sizeof one));
  }

  int queryCapabilities(v4l2_capability& answer) const {
    if (capabilities == 0) return -ENOTTY;
    std::strcpy(reinterpret_cast<char*>(answer.card), "Scripted Camera");
    answer.capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    answer.device_caps = capabilities;
    return 0;
  }
  int enumFormats(v4l2_fmtdesc& entry) const {
    if (entry.index >= formats.size()) return -EINVAL;
    entry.pixelformat = formats[entry.index].fourcc;
    return 0;
  }
  [[nodiscard]] const Format* find(std::uint32_t fourcc) const {
    for (const Format& one : formats) {
      if (one.fourcc == fourcc) return &one;
    }
    return nullptr;
  }
  int enumSizes(v4l2_frmsizeenum& entry) const {
    const Format* format = find(entry.pixel_format);
    if (format == nullptr || entry.index >= format->sizes.size()) return -EINVAL;
    entry.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    entry.discrete = {format->sizes[entry.index].width, format->sizes[entry.index].height};
    return 0;
  }
  int enumRates(v4l2_frmivalenum& entry) const {
    const Format* format = find(entry.pixel_format);
    if (format == nullptr) return -EINVAL;
    for (const Size& size : format->sizes) {
      if (size.width != entry.width || size.height != entry.height) continue;
      if (entry.index >= size.rates.size()) return -EINVAL;
      entry.type = V4L2_FRMIVAL_TYPE_DISCRETE;
      entry.discrete = {1, size.rates[entry.index]};
      return 0;
    }
    return -EINVAL;
  }
  int setFormat(v4l2_pix_format& pixels) {
    if (format_error != 0) return -format_error;
    const Format* format = find(pixels.pixelformat);
    if (format == nullptr) return -EINVAL;
    if (keeps_its_size) pixels.width = 640, pixels.height = 480;
    pixels.bytesperline = pixels.width * format->bytes;
    pixels.sizeimage = pixels.bytesperline * pixels.height;
    pixels.colorspace = V4L2_COLORSPACE_SRGB;
    pixels.quantization = quantization;
    now = pixels;
    return 0;
  }
  int getRate(v4l2_streamparm& rate) const {
    rate.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
    rate.parm.capture.timeperframe = {1, fps};
    return 0;
  }
  int setRate(const v4l2_streamparm& rate) {
    const v4l2_fract& interval = rate.parm.capture.timeperframe;
    fps = interval.denominator / interval.numerator;
    return 0;
  }
  int queryControl(v4l2_queryctrl& query) const {
    const auto entry = controls.find(query.id);
    if (entry == controls.end()) return -EINVAL;
    query.minimum = entry->second.minimum;
    query.maximum = entry->second.maximum;
    return 0;
  }
  int useControl(unsigned long request, v4l2_control& control) {
    const auto entry = controls.find(control.id);
    if (entry == controls.end()) return -EINVAL;
    if (request == VIDIOC_S_CTRL) {
      if (entry->second.stuck) return -EIO;
      if (control.value > entry->second.maximum) return -ERANGE;
      entry->second.value = control.value;
    }
    control.value = entry->second.value;
    return 0;
  }
  int makeBuffers(v4l2_requestbuffers& request) {
    memory_.assign(request.count, std::vector<std::uint8_t>(now.sizeimage));
    queued_.clear();
    done_.clear();
    return 0;
  }
  int takeFrame(v4l2_buffer& buffer) {
    if (failing_ > 0) {
      --failing_;
      return -EIO;
    }
    if (done_.empty()) {
      std::uint64_t count = 0;
      static_cast<void>(!read(descriptor_, &count, sizeof count));
      return -EAGAIN;
    }
    buffer = done_.front();
    done_.pop_front();
    return 0;
  }

  bool plugged_ = true;
  int descriptor_ = -1;
  int failing_ = 0;
  std::vector<std::vector<std::uint8_t>> memory_;
  std::deque<std::uint32_t> queued_;
  std::deque<v4l2_buffer> done_;
};

}  // namespace lab
