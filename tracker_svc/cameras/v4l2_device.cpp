#include "tracker_svc/cameras/v4l2_device.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

#include "common/serial/serial_line.hpp"
#include "tracker_svc/cameras/v4l2_controls.hpp"

namespace lab::cameras {
namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr std::size_t kMostListed = 24;
constexpr int kMostErrors = 10;  // consecutive failed frames after which the camera counts as gone
constexpr std::int64_t kOldest_us = 1'000'000;  // older time stamps are not plausible

double rateOf(const v4l2_fract& interval) {
  return interval.numerator > 0
             ? static_cast<double>(interval.denominator) / static_cast<double>(interval.numerator)
             : 0;
}

std::string sizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// " at 30 /s", empty if the rate is not known.
std::string rateText(double fps) {
  return fps > 0 ? " at " + std::to_string(std::lround(fps)) + " /s" : "";
}

bool isLimited(const v4l2_pix_format& pixels) {
  const bool grey = pixels.pixelformat == V4L2_PIX_FMT_GREY;
  if (grey || pixels.pixelformat == V4L2_PIX_FMT_MJPEG) return false;
  if (pixels.quantization != V4L2_QUANTIZATION_DEFAULT) {
    return pixels.quantization == V4L2_QUANTIZATION_LIM_RANGE;
  }
  return pixels.colorspace != V4L2_COLORSPACE_JPEG;  // the kernel's default for YCbCr
}

}  // namespace

V4l2Device::V4l2Device(V4l2Calls& calls, std::string path, const CameraFormat& wanted)
    : calls_(calls), path_(std::move(path)) {
  const int opened = calls_.open(path_);
  if (opened == -ENOTTY) fail("is no camera");
  if (opened < 0) failToSet(-opened, "cannot be opened");
  device_ = opened;
  try {
    checkIsCamera();
    chooseFormat(wanted);
    setRate(wanted.fps);
    lockControls(calls_, device_, wanted, format_);
    startStreaming();
  } catch (...) {
    stop();
    throw;
  }
}

V4l2Device::~V4l2Device() { stop(); }

void V4l2Device::fail(const std::string& what) const { throw CameraError(path_ + ": " + what); }

void V4l2Device::failToSet(int error, const std::string& what) const {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      fail("no camera there; plug it in, or see what there is: ls /dev/v4l/by-id");
    case EACCES:
    case EPERM:
      fail(
          "no permission; join the group of the device and log in again: sudo usermod -aG video "
          "$USER");
    case EBUSY: {
      const std::string holder = lineHolder(path_);
      fail("in use by " + (holder.empty() ? std::string("another program") : holder) +
           "; end that");
    }
    case ENOSPC:
      fail(
          "its USB bus lacks the bandwidth; use another port, smaller pictures, "
          "or a lower rate");
    case ENOTTY:
    case EINVAL:
      fail(what + ": it is no camera, or not one that streams");
    default:
      fail(what + ": " + std::strerror(error));
  }
}

void V4l2Device::checkIsCamera() const {
  v4l2_capability has{};
  if (call(VIDIOC_QUERYCAP, &has) < 0) fail("is no camera");
  const std::uint32_t can =
      (has.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? has.device_caps : has.capabilities;
  const std::string card(reinterpret_cast<const char*>(has.card),
                         strnlen(reinterpret_cast<const char*>(has.card), sizeof has.card));
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0) {
    fail("delivers no pictures (" + card +
         "; a camera often has a second device for other data): "
         "try the device before it");
  }
  if ((can & V4L2_CAP_STREAMING) == 0) fail("cannot stream (" + card + ")");
}

std::vector<std::uint32_t> V4l2Device::offeredFormats() const {
  std::vector<std::uint32_t> found;
  v4l2_fmtdesc entry{};
  entry.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; entry.index < 256 && call(VIDIOC_ENUM_FMT, &entry) >= 0; ++entry.index) {
    found.push_back(entry.pixelformat);
  }
  return found;
}

bool V4l2Device::hasSize(std::uint32_t fourcc, int width, int height) const {
  v4l2_frmsizeenum size{};
  size.pixel_format = fourcc;
  const auto wide = static_cast<std::uint32_t>(width);
  const auto high = static_cast<std::uint32_t>(height);
  for (; size.index < 256 && call(VIDIOC_ENUM_FRAMESIZES, &size) >= 0; ++size.index) {
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      if (size.discrete.width == wide && size.discrete.height == high) return true;
    } else {
      const v4l2_frmsize_stepwise& steps = size.stepwise;
      const auto fits = [](std::uint32_t value, std::uint32_t low, std::uint32_t most,
                           std::uint32_t step) {
        return value >= low && value <= most && (step <= 1 || (value - low) % step == 0);
      };
      return fits(wide, steps.min_width, steps.max_width, steps.step_width) &&
             fits(high, steps.min_height, steps.max_height, steps.step_height);
    }
  }
  return size.index == 0;  // the device lists no sizes: setting one will show
}

double V4l2Device::fastestRate(std::uint32_t fourcc, int width, int height) const {
  v4l2_frmivalenum interval{};
  interval.pixel_format = fourcc;
  interval.width = static_cast<std::uint32_t>(width);
  interval.height = static_cast<std::uint32_t>(height);
  double fastest = 0;
  for (; interval.index < 256 && call(VIDIOC_ENUM_FRAMEINTERVALS, &interval) >= 0;
       ++interval.index) {
    const bool listed = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    fastest = std::max(fastest, rateOf(listed ? interval.discrete : interval.stepwise.min));
    if (!listed) break;
  }
  return fastest;
}

std::string V4l2Device::offers() const {
  std::set<std::string> seen;
  std::string text;
  for (const std::uint32_t fourcc : offeredFormats()) {
    v4l2_frmsizeenum size{};
    size.pixel_format = fourcc;
    for (; size.index < 256 && call(VIDIOC_ENUM_FRAMESIZES, &size) >= 0; ++size.index) {
      std::string one;
      if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
        const auto width = static_cast<int>(size.discrete.width);
        const auto height = static_cast<int>(size.discrete.height);
        one = sizeText(width, height) + rateText(fastestRate(fourcc, width, height));
      } else {
        one = sizeText(static_cast<int>(size.stepwise.min_width),
                       static_cast<int>(size.stepwise.min_height)) +
              " to " +
              sizeText(static_cast<int>(size.stepwise.max_width),
                       static_cast<int>(size.stepwise.max_height));
      }
      one = fourccName(fourcc) + " " + one;
      if (seen.size() < kMostListed && seen.insert(one).second) {
        text += (text.empty() ? "" : ", ") + one;
      }
      if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) break;
    }
  }
  return text.empty() ? "it does not list its formats" : "it offers " + text;
}

void V4l2Device::chooseFormat(const CameraFormat& wanted) {
  v4l2_format now{};
  now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  const int failed = call(VIDIOC_G_FMT, &now);
  if (failed < 0) failToSet(-failed, "reports no format");
  const int width = wanted.width > 0 ? wanted.width : static_cast<int>(now.fmt.pix.width);
  const int height = wanted.height > 0 ? wanted.height : static_cast<int>(now.fmt.pix.height);
  const std::vector<std::uint32_t> offered = offeredFormats();
  std::uint32_t best = 0;
  double best_rate = -1;
  for (const std::uint32_t fourcc : knownFormats()) {
    const bool there = std::find(offered.begin(), offered.end(), fourcc) != offered.end();
    if (!there || !hasSize(fourcc, width, height)) continue;
    // A rate that is not listed (0) may be any. Tolerance of half a percent: 29.97 counts as 30.
    const double rate = fastestRate(fourcc, width, height);
    const bool enough = rate == 0 || rate * 1.005 >= wanted.fps;
    if (best == 0 || (enough && best_rate * 1.005 < wanted.fps) ||
        (!enough && rate > best_rate && best_rate * 1.005 < wanted.fps)) {
      best = fourcc;
      best_rate = enough ? std::max(rate, wanted.fps) : rate;
    }
  }
  if (best == 0) fail("has no " + sizeText(width, height) + " pixels; " + offers());
  setFormat(best, width, height);
}

void V4l2Device::setFormat(std::uint32_t fourcc, int width, int height) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_pix_format& pixels = format.fmt.pix;
  pixels.width = static_cast<std::uint32_t>(width);
  pixels.height = static_cast<std::uint32_t>(height);
  pixels.pixelformat = fourcc;
  pixels.field = V4L2_FIELD_NONE;
  const int failed = call(VIDIOC_S_FMT, &format);
  if (failed < 0) failToSet(-failed, fourccName(fourcc) + " cannot be set");
  layout_ = {pixels.pixelformat, static_cast<int>(pixels.width), static_cast<int>(pixels.height),
             static_cast<int>(pixels.bytesperline), isLimited(pixels)};
  if (layout_.fourcc != fourcc || layout_.width != width || layout_.height != height) {
    fail("gave " + fourccName(layout_.fourcc) + " " + sizeText(layout_.width, layout_.height) +
         " instead of " + fourccName(fourcc) + " " + sizeText(width, height) + "; " + offers());
  }
  if (pixels.field != V4L2_FIELD_NONE && pixels.field != V4L2_FIELD_ANY) {
    fail("delivers interlaced pictures; the tracker needs progressive ones");
  }
  if (layout_.stride == 0) layout_.stride = width;  // some drivers report 0 for compressed formats
  format_.width = width;
  format_.height = height;
  format_.pixels = fourccName(fourcc);
  format_.compressed = fourcc == V4L2_PIX_FMT_MJPEG || fourcc == V4L2_PIX_FMT_JPEG;
}

void V4l2Device::setRate(double fps) {
  v4l2_streamparm rate{};
  rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (call(VIDIOC_G_PARM, &rate) < 0) return;  // the rate cannot be set and is not known
  if (fps > 0 && (rate.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0) {
    rate.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(fps * 1000))};
    static_cast<void>(call(VIDIOC_S_PARM, &rate));
    if (call(VIDIOC_G_PARM, &rate) < 0) return;
  }
  format_.fps = rateOf(rate.parm.capture.timeperframe);
}

void V4l2Device::startStreaming() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  int failed = call(VIDIOC_REQBUFS, &request);
  if (failed < 0) failToSet(-failed, "provides no buffers");
  if (request.count < 2) fail("provides fewer than two buffers");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer{};
    buffer.type = request.type;
    buffer.memory = request.memory;
    buffer.index = i;
    failed = call(VIDIOC_QUERYBUF, &buffer);
    if (failed < 0) failToSet(-failed, "does not return a buffer");
    std::uint8_t* memory = calls_.map(device_, buffer.length, buffer.m.offset);
    if (memory == nullptr) fail("its buffers cannot be mapped");
    buffers_.push_back({memory, buffer.length});
    failed = call(VIDIOC_QBUF, &buffer);
    if (failed < 0) failToSet(-failed, "rejects a buffer");
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  failed = call(VIDIOC_STREAMON, &type);
  if (failed < 0) failToSet(-failed, "does not start");
}

void V4l2Device::stop() {
  if (device_ < 0) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  static_cast<void>(call(VIDIOC_STREAMOFF, &type));
  for (const Buffer& buffer : buffers_) calls_.unmap(buffer.memory, buffer.bytes);
  buffers_.clear();
  calls_.close(std::exchange(device_, -1));
}

V4l2Device::State V4l2Device::dequeue(Raw& frame) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  const int failed = call(VIDIOC_DQBUF, &buffer);
  if (failed == -EAGAIN) return State::kNothing;
  if (failed < 0) {
    // A single I/O error may be one lost frame; several in a row mean a disconnected camera.
    const bool passing = failed == -EIO && ++errors_in_a_row_ < kMostErrors;
    return passing ? State::kNothing : State::kGone;
  }
  if (buffer.index >= buffers_.size()) return State::kGone;
  const Buffer& memory = buffers_[buffer.index];
  frame.buffer = buffer.index;
  frame.sequence = buffer.sequence;
  const std::size_t used = std::min<std::size_t>(buffer.bytesused, memory.bytes);
  const bool damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || used == 0;
  frame.bytes = {memory.memory, damaged ? 0 : used};
  errors_in_a_row_ = 0;
  const std::int64_t stamp =
      std::int64_t{buffer.timestamp.tv_sec} * 1'000'000 + buffer.timestamp.tv_usec;
  const std::int64_t since = calls_.monotonic() - stamp;
  const bool monotonic =
      (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  frame.stamped = monotonic && since >= 0 && since <= kOldest_us;
  const bool at_start = frame.stamped && (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) ==
                                             V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const auto half = static_cast<std::int64_t>(std::llround(format_.exposure * 5e5));
  frame.age = (frame.stamped ? since : 0) + (at_start ? -half : half);
  return State::kFrame;
}

void V4l2Device::giveBack(const Raw& frame) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = frame.buffer;
  static_cast<void>(call(VIDIOC_QBUF, &buffer));  // if it fails, the next dequeue() reports it
}

}  // namespace lab::cameras
